"""--environment: light from all around in place of the scene's own, how it stands, and that films know it."""

import struct
import unittest

import exr
from support import DONE, SCENE, TINY, USAGE, CliTest

VIEW = """\
{before}LookAt 0 0 0  {towards}  {up}
Camera "perspective" "float fov" 20
Film "rgb" "integer xresolution" 32 "integer yresolution" 16
Sampler "zsobol" "integer pixelsamples" 4
WorldBegin
LightSource "infinite" "rgb L" [9 9 9]
Translate -50 -50 -50
Shape "sphere"
"""


def view(towards="1 0 0", up="0 1 0", before=""):
    return VIEW.format(towards=towards, up=up, before=before)


def sky(columns=8):
    """A lat-long picture whose red is the number of the column and whose green is that of the row, from the top."""
    rows = columns // 2
    pixels = b"".join(struct.pack("<3f", x, y, 0) for y in reversed(range(rows)) for x in range(columns))
    return b"PF\n%d %d\n-1\n" % (columns, rows) + pixels


class Environment(CliTest):
    def setUp(self):
        super().setUp()
        self.write("sky.pfm", sky())

    def shown(self, scene, *arguments):
        """Means of red and green in the left and the right half of the picture."""
        image = exr.read(self.rendered("--method", "uniform", *arguments, scene=scene))

        def mean(channel, left):
            values = [v for i, v in enumerate(image.pixels[channel]) if (i % image.width < image.width // 2) == left]
            return sum(values) / len(values)

        return mean("R", True), mean("R", False), mean("G", True)

    def test_a_colour_takes_the_place_of_the_scenes_light(self):
        self.assertAlmostEqual(self.shown(view())[0], 9, places=3)
        self.assertAlmostEqual(self.shown(view(), "--environment", "0.5")[0], 0.5, places=4)
        red, _, green = self.shown(view(), "--environment", "0.25,2,1")
        self.assertAlmostEqual(red, 0.25, places=4)
        self.assertAlmostEqual(green, 2, places=3)
        self.assertAlmostEqual(self.shown(view(), "--environment", "0.5", "--environment-scale", "3")[0], 1.5, places=3)
        self.assertAlmostEqual(self.shown(view(), "--environment-scale", "0.5")[0], 4.5, places=3)
        self.assertEqual(self.shown(view(), "--environment", "0", "--environment-rotation", "9")[0], 0)

    def test_other_lights_stay(self):
        scene = TINY + 'LightSource "infinite" "rgb L" [1 1 1]\n'
        lit = exr.read(self.rendered("--environment", "0", scene=scene)).pixels["G"]
        only_lamps = exr.read(self.rendered(scene=TINY)).pixels["G"]
        self.assertGreater(max(only_lamps), 0.05)
        self.assertAlmostEqual(sum(lit) / sum(only_lamps), 1, delta=0.1)

    def test_the_middle_of_a_picture_lies_along_x_with_the_pole_up(self):
        # Columns 3 and 4 meet in the middle of the picture, rows 1 and 2 at the horizon.
        for towards, up, before in (
            ("1 0 0", "0 1 0", ""),
            ("1 0 0", "0 1 0", "Scale -1 1 1\n"),
            ("1 0 0", "0 0 1", ""),
            ("1 0 0", "0.2 -0.1 0.9", ""),
            ("0 0 1", "1 0 0", "Scale -1 1 1\n"),
        ):
            with self.subTest(towards=towards, up=up, before=before):
                left, right, height = self.shown(view(towards, up, before), "--environment", "sky.pfm")
                self.assertLess(left, right - 0.05)
                if "." not in up:
                    self.assertAlmostEqual((left + right) / 2, 3.5, delta=0.02)
                    self.assertAlmostEqual(height, 1.5, delta=0.02)

    def test_above_is_the_top_row(self):
        _, _, height = self.shown(view("1 0.9 0"), "--environment", "sky.pfm")
        self.assertLess(height, 0.8)

    def test_turned_the_picture_moves_to_its_left(self):
        for before in ("", "Scale -1 1 1\n"):
            left, right, _ = self.shown(view(before=before), "--environment", "sky.pfm", "--environment-rotation", "90")
            self.assertAlmostEqual((left + right) / 2, 5.5, delta=0.02)
            left, right, _ = self.shown(view(before=before), "--environment", "sky.pfm", "--environment-rotation=-45")
            self.assertAlmostEqual((left + right) / 2, 2.5, delta=0.02)

    def test_it_stands_where_the_scenes_own_image_did(self):
        own = view().replace('LightSource "infinite" "rgb L" [9 9 9]', 'Rotate 90 0 1 0\nRotate -90 1 0 0\nLightSource "infinite" "string filename" "own.pfm"')
        self.write("own.pfm", sky())
        self.assertEqual(self.shown(own), self.shown(own, "--environment", "sky.pfm"))
        turned = self.shown(own, "--environment-rotation=-90")
        self.assertEqual(turned, self.shown(own, "--environment", "sky.pfm", "--environment-rotation=-90"))
        self.assertNotAlmostEqual(turned[0], self.shown(own)[0], delta=0.5)

    def test_films_know_it(self):
        arguments = ["--checkpoint", "a.film", "--environment", "sky.pfm", "--spp", "2"]
        self.assertEqual(self.render(view(), *arguments).code, DONE)
        self.assertEqual(self.render(view(), *arguments, "--resume").code, DONE)
        unchanged = ["--environment-rotation", "0", "--environment-scale", "1"]
        self.assertEqual(self.render(view(), *arguments, *unchanged, "--resume").code, DONE)
        for other in (["--environment-rotation", "1"], ["--environment-scale", "2"], ["--environment", "1"]):
            self.assert_fails(self.render(view(), *arguments, *other, "--resume"), USAGE, "film of another render")
        own = ["--checkpoint", "a.film", "--spp", "2", "--resume"]
        self.assert_fails(self.render(view(), *own), USAGE, "film of another render")
        self.assertEqual(self.render(view(), "--checkpoint", "b.film", "--spp", "2", *unchanged).code, DONE)
        self.assertEqual(self.render(view(), "--checkpoint", "b.film", "--spp", "2", "--resume").code, DONE)
        self.write("sky.pfm", sky(16))
        self.assert_fails(self.render(view(), *arguments, "--resume"), USAGE, "images")

    def test_errors(self):
        for wrong in ("none.exr", ".", "1,2", "-1", "nan", "inf", "1,2,-3", ""):
            self.assert_fails(self.render(view(), f"--environment={wrong}"), USAGE, "--environment")
        for wrong in ("x", "inf", "", "1,2"):
            self.assert_fails(self.render(view(), f"--environment-rotation={wrong}"), USAGE, "--environment-rotation")
        for wrong in ("0", "-1", "nan", ""):
            self.assert_fails(self.render(view(), f"--environment-scale={wrong}"), USAGE, "--environment-scale")
        for option in ("--environment-rotation=1", "--environment-scale=2"):
            self.assert_fails(self.render(TINY, option), USAGE, option.split("=")[0], "no light from all around")
        self.assert_fails(self.render(view(), "--environment", "1e38", "--environment-scale", "1e3"), USAGE, "--environment-scale")
        self.write("tall.pfm", b"PF\n1 2\n-1\n" + bytes(24))
        self.assert_fails(self.render(view(), "--environment", "tall.pfm"), SCENE, "tall.pfm")
        self.assert_fails(self.render(view(), "--environment", "sky.pfm", output="sky.pfm"), USAGE, "sky.pfm")

    def test_measure_takes_it(self):
        self.write("scene.pbrt", TINY)
        arguments = ["measure", "scene.pbrt", "--pixel", "12,2", "--samples", "4096", "--paths", "16", "--json"]
        self.assertNotEqual(self.run_program(*arguments).stdout, self.run_program(*arguments, "--environment", "sky.pfm").stdout)


if __name__ == "__main__":
    unittest.main()
