"""Numbers at the ends of single precision: refused with their place, or an image without NaN and infinite values."""

import json
import math
import re

import exr
from support import DONE, CliTest, warnings_of

SCENE = """\
LookAt 0 1 6  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "float iso" {iso}
{before}
WorldBegin
LightSource "infinite" "rgb L" [.5 .5 .5]
{world}
Shape "sphere" "float radius" 1
"""
METHODS = ("uniform", "covariance", "hybrid")
LARGEST = 3.4028234663852886e38


def scene(before="", world="", iso="100"):
    return SCENE.format(before=before, world=world, iso=iso)


class Numbers(CliTest):
    def finite_image(self, *arguments):
        image = exr.read(self.folder / "out.exr")
        for name, values in image.pixels.items():
            self.assertTrue(all(map(math.isfinite, values)), (name, arguments))
        return image

    def assert_no_bad_number(self, text, *arguments):
        """Asserts that the scene is refused with a place, or rendered with finite layers."""
        result = self.render(text, "--spp", "4", *arguments)
        if result.code != DONE:
            self.assertRegex(result.stderr, r"^covtrace: scene\.pbrt:\d+:\d+: ")
            self.assertEqual(result.code, 3, result)
            return
        self.finite_image(text, arguments)

    def test_filters(self):
        for text in (
            '"gaussian" "float xradius" 1e-6 "float yradius" 1e-6',
            '"gaussian" "float xradius" 1e6 "float yradius" 1e6',
            '"gaussian" "float sigma" 1e-30',
            '"sinc" "float xradius" 1e38 "float yradius" 1e38',
            '"mitchell" "float B" 1e10',
            '"triangle" "float xradius" 1e-30',
            '"sinc" "float tau" 1e-30',
        ):
            for method in METHODS:
                with self.subTest(filter=text, method=method):
                    self.assert_no_bad_number(scene(before=f"PixelFilter {text}"), "--method", method)

    def test_a_gaussian_of_a_wide_radius_is_as_bright(self):
        """A Gaussian is within six deviations: a radius of 5000 pixels changes nothing but the rest beyond the
        default radius."""
        means = []
        for radius in (3, 5000):
            text = scene(before=f'PixelFilter "gaussian" "float xradius" {radius} "float yradius" {radius}',
                         world='LightSource "point" "point3 from" [0 3 2] "rgb I" [50 50 50]')
            self.rendered("--method", "uniform", "--spp", "256", scene=text)
            pixels = exr.read(self.folder / "out.exr").pixels["G"]
            means.append(sum(pixels) / len(pixels))
        self.assertAlmostEqual(means[1] / means[0], 1, delta=0.01)

    def test_lights(self):
        for world in (
            'LightSource "infinite" "rgb L" [1e38 1e38 1e38]',
            'LightSource "point" "rgb I" [1e38 1e38 1e38] "point3 from" [0 3 0]',
            'MakeNamedMedium "m" "string type" "homogeneous" "rgb Le" [3e38 3e38 3e38]\nMediumInterface "m" ""',
            'LightSource "infinite" "float scale" 1e-15',
        ):
            for method in METHODS:
                for iso in ("100", "1e30", "1e38"):
                    with self.subTest(world=world, method=method, iso=iso):
                        self.assert_no_bad_number(scene(world=world, iso=iso), "--method", method)

    def test_the_image_is_kept_and_says_what_was_replaced(self):
        """After hours of rendering all good pixels stay, and the others are told once."""
        self.write("scene.pbrt", scene(world='LightSource "infinite" "float scale" 1e25'))
        for method in METHODS:
            with self.subTest(method=method):
                result = self.run_program("render", "scene.pbrt", "-o", "out.exr", "--png", "out.png", "--film", "a.film", "--spp", "4",
                                          "--method", method, "--progress", "none", "--stats", "s.json")
                self.assertEqual(result.code, DONE, result)
                image = self.finite_image(method)
                told = [text for _, text in warnings_of(result) if "--exposure" not in text]
                self.assertEqual(len(told), 1, result)
                where = re.match(r"(\d+) pixels? ha\w+ values that single precision cannot hold.*; the first at (\d+),(\d+), in the layers (.*)$", told[0])
                self.assertIsNotNone(where, result)
                self.assertIn("variance", where[4])
                replaced = json.loads((self.folder / "s.json").read_text())["replaced_pixels"]
                self.assertEqual(replaced, {"count": int(where[1]), "first": [int(where[2]), int(where[3])], "layers": where[4]})
                self.assertEqual(image.value("covtrace:replacedPixels"), int(where[1]))
                at_first = int(where[3]) * 24 + int(where[2])
                self.assertIn(LARGEST, [values[at_first] for values in image.pixels.values()])
                self.assertGreater(min(image.pixels["raw.G"]), 1e20)
                # The film keeps its samples: its image is the same.
                merged = self.run_program("merge", "a.film", "-o", "merged.exr")
                self.assertIn(told[0], merged.stderr)

    def test_statistics_of_a_plain_image(self):
        self.rendered("--stats", "s.json", scene=scene())
        self.assertEqual(json.loads((self.folder / "s.json").read_text())["replaced_pixels"], {"count": 0})

    def test_cameras_and_their_metadata(self):
        for camera in (
            '"float fov" 1e-30',
            '"float lensradius" 1e30',
            '"float lensradius" 1 "float focaldistance" 1e-30',
            '"float lensradius" 1 "float focaldistance" 3e38',
            '"float frameaspectratio" 1e-45',
            '"float screenwindow" [-1e-45 1e-45 -1 1]',
            '"float shutterclose" 3e38',
        ):
            with self.subTest(camera=camera):
                text = scene().replace('"float fov" 40', camera)
                self.assert_no_bad_number(text, "--method", "covariance")
                if (self.folder / "out.exr").exists():
                    told = self.run_program("info", "out.exr").stdout
                    self.assertIsNone(re.search(r"[^a-z](nan|inf)\b", told), told)
                    (self.folder / "out.exr").unlink()

    def test_hostile_values_of_everything_else(self):
        sphere = 'Shape "sphere" "float radius" 1'
        cases = [scene().replace(sphere, 'Shape "sphere" "float radius" @')]
        for line in (
            "Translate @ 0 0",
            "Scale @ @ @",
            'Material "dielectric" "float eta" @',
            'Material "coatedconductor" "float interface.eta" @ "float thickness" @',
            'Material "conductor" "float roughness" @ "rgb k" [@ @ @]',
            'Material "coateddiffuse" "float thickness" @ "rgb albedo" [.5 .5 .5]',
            'Texture "t" "spectrum" "scale" "rgb tex" [@ @ @] "float scale" 1e20\nMaterial "diffuse" "texture reflectance" "t"',
            'Texture "t" "spectrum" "marble" "float scale" @\nMaterial "diffuse" "texture reflectance" "t"',
            'MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_s" [@ @ @]\nMediumInterface "m" ""\nMaterial "interface"',
            'LightSource "point" "blackbody I" @',
            'AreaLightSource "diffuse" "float power" @',
        ):
            cases.append(scene(world=line))
        for text in cases:
            for value in ("1e-45", "1e-30", "1e30", "3e38"):
                with self.subTest(text=text, value=value):
                    self.assert_no_bad_number(text.replace("@", value), "--method", "hybrid")


if __name__ == "__main__":
    import unittest

    unittest.main()
