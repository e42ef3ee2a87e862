"""Alpha before media and holdouts: 1 less the transmittance to where the camera sees nothing."""

import json
import math
import unittest

import exr
from support import DONE, CliTest

WIDTH, HEIGHT = 24, 16
VIEW = f"""
LookAt 0 0 -6  0 0 0  0 1 0
Camera "perspective" "float fov" 20
Sampler "independent" "integer pixelsamples" 4
Film "rgb" "integer xresolution" {WIDTH} "integer yresolution" {HEIGHT}
WorldBegin
LightSource "distant" "rgb L" [3 3 3]
"""
SLAB = 'Shape "bilinearmesh" "point3 P" [-5 -5 {0}  5 -5 {0}  -5 5 {0}  5 5 {0}]'


def medium(coefficients, after=""):
    """A slab of a medium, two units thick."""
    return (f'MakeNamedMedium "m" "string type" "homogeneous" {coefficients}{after}\n'
            'AttributeBegin\nMaterial "interface"\nMediumInterface "m" ""\n'
            'Scale 5 5 1\nShape "sphere" "float radius" 1\nAttributeEnd\n')


ABSORBS = '"rgb sigma_a" [.3 .2 .4] "rgb sigma_s" [0 0 0]'
SCATTERS = '"rgb sigma_a" [.1 .1 .1] "rgb sigma_s" [.4 .3 .5]'
MIRRORS = 'Material "conductor" "rgb reflectance" [1 1 1]\n'
BALL = 'AttributeBegin\n{0}Translate 0 0 3\nShape "sphere" "float radius" .5 {1}\nAttributeEnd\n'


class Opacity(CliTest):
    def image(self, content, *arguments):
        return exr.read(self.rendered("--spp", 16, *arguments, scene=VIEW + content)).pixels

    def assert_opacity(self, image, expected, places=2, x=WIDTH // 2, y=HEIGHT // 2):
        self.assertAlmostEqual(image["A"][y * WIDTH + x], expected, places)

    def test_media_take_what_they_do_not_transmit(self):
        """That is the mean of the channels, as in Cycles."""
        for coefficients, extinction in ((ABSORBS, (0.3, 0.2, 0.4)), (SCATTERS, (0.5, 0.4, 0.6))):
            expected = 1 - sum(math.exp(-2 * e) for e in extinction) / 3
            for method in ("uniform", "covariance", "hybrid"):
                with self.subTest(method=method, extinction=extinction):
                    self.assert_opacity(self.image(medium(coefficients), "--method", method), expected)

    def test_surfaces_behind_media_are_opaque(self):
        for coefficients in (ABSORBS, SCATTERS):
            image = self.image(medium(coefficients) + BALL.format("", ""))
            self.assert_opacity(image, 1)
            self.assertLess(image["A"][0], 0.9)

    def test_skies_that_are_seen_leave_no_alpha(self):
        self.assertNotIn("A", self.image(medium(SCATTERS) + 'LightSource "infinite" "rgb L" [.4 .4 .4]\n'))

    def test_media_behind_media_count(self):
        """The camera's ray goes on where the first one scatters it."""
        second = medium(ABSORBS).replace('"m"', '"n"').replace("AttributeBegin\n", "AttributeBegin\nTranslate 0 0 3\n")
        first = (0.5, 0.4, 0.6)
        expected = 1 - sum(math.exp(-2 * (a + b)) for a, b in zip(first, (0.3, 0.2, 0.4))) / 3
        self.assert_opacity(self.image(medium(SCATTERS) + second), expected)

    def test_media_that_the_camera_does_not_see_leave_it_clear(self):
        """They shadow all the same."""
        hidden = medium(ABSORBS, ' "bool hiddenfromcamera" true')
        self.assert_opacity(self.image(hidden), 0, 6)
        lit, shadowed = (self.image(BALL.format("", "") + m) for m in ("", hidden))
        middle = HEIGHT // 2 * WIDTH + WIDTH // 2
        self.assertAlmostEqual(shadowed["G"][middle] / lit["G"][middle], math.exp(-2 * 0.2), delta=0.02)

    def test_holdouts_are_clear_and_hide(self):
        behind = SLAB.format(4)
        for sky in ("", 'LightSource "infinite" "rgb L" [.4 .4 .4]\n'):
            image = self.image(sky + behind + "\n" + BALL.format("", '"bool holdout" true'), "--method", "uniform")
            middle = HEIGHT // 2 * WIDTH + WIDTH // 2
            self.assertEqual([image[c][middle] for c in "RGBA"], [0, 0, 0, 0])
            self.assertEqual(image["A"][0], 1)
            self.assertGreater(image["G"][0], 0)

    def test_holdouts_show_in_mirrors_and_behind_media(self):
        expected = 1 - sum(math.exp(-2 * e) for e in (0.5, 0.4, 0.6)) / 3
        image = self.image(medium(SCATTERS) + BALL.format("", '"bool holdout" true'))
        self.assert_opacity(image, expected)
        # The camera looks by a mirror at a shining holdout that stands behind it.
        lamp = ('AttributeBegin\nAreaLightSource "diffuse" "rgb L" [2 2 2] "bool twosided" true\nTranslate 0 0 -12\n'
                'Shape "sphere" "float radius" 5 "bool holdout" true\nAttributeEnd\n')
        mirror = f'AttributeBegin\n{MIRRORS}{SLAB.format(2)}\nAttributeEnd\n'
        image = self.image(lamp + mirror)
        self.assert_opacity(image, 1)
        self.assertAlmostEqual(image["G"][HEIGHT // 2 * WIDTH + WIDTH // 2], 2, delta=0.1)

    def test_lamps_that_holdouts_hide_are_no_error(self):
        """Small lamps count for the error of pixels whose samples may have missed them."""
        lamp = ('AttributeBegin\nAreaLightSource "diffuse" "rgb L" [1e6 1e6 1e6]\nTranslate .05 .05 {0}\n'
                'Shape "sphere" "float radius" .0004 {1}\nAttributeEnd\n')
        hole = 'Shape "bilinearmesh" "point3 P" [-5 -5 3  5 -5 3  -5 5 3  5 5 3] "bool holdout" true\n'
        for shown, content in ((True, lamp.format(2, "")), (False, lamp.format(4, "")), (False, lamp.format(2, '"bool holdout" true'))):
            with self.subTest(content=content):
                self.rendered("--error", 0.05, "--max-spp", 256, "--stats", "s.json", scene=VIEW + content + hole)
                spp = json.loads((self.folder / "s.json").read_text())["spp"]
                self.assertGreater(spp, 200) if shown else self.assertLess(spp, 100)

    def test_glow_before_holdouts_is_predicted(self):
        glows = medium(ABSORBS, ' "rgb Le" [1 1 1]')
        image = self.image(glows + 'Translate 0 0 3\nShape "sphere" "float radius" 1 "bool holdout" true\n', "--method", "covariance")
        self.assertGreater(image["covweight.Y"][HEIGHT // 2 * WIDTH + WIDTH // 2], 0.1)

    def test_films_keep_opacity(self):
        """Threads, films that go on and films of parts that are merged change no bit."""
        scene = VIEW + medium(SCATTERS) + BALL.format("", '"bool holdout" true')
        for method in ("uniform", "hybrid"):
            with self.subTest(method=method):
                def render(name, *arguments):
                    return exr.read(self.rendered("--method", method, *arguments, output=name, scene=scene)).pixels

                whole = render("one.exr", "--spp", 16, "--threads", 1)
                self.assertEqual(whole, render("two.exr", "--spp", 16, "--threads", 2))
                self.assertGreater(len(set(whole["A"])), 10)
                render("begun.exr", "--spp", 16, "--film", f"{method}.film")
                self.run_program("merge", f"{method}.film", "-o", "again.exr")
                self.assertEqual(whole["A"], exr.read(self.folder / "again.exr").pixels["A"])
        for k in (1, 2):
            self.rendered("--spp", 16, "--method", "uniform", "--shard", f"{k}/2", "--film", f"{k}.film", scene=scene, output=None)
        self.assertEqual(self.run_program("merge", "1.film", "2.film", "-o", "merged.exr").code, DONE)
        one = exr.read(self.rendered("--spp", 16, "--method", "uniform", scene=scene)).pixels
        self.assertEqual(one, exr.read(self.folder / "merged.exr").pixels)
        # A render that goes on from what half of its samples left.
        going = ("--method", "uniform", "--checkpoint", "kept.film", "--resume")
        self.rendered("--spp", 8, *going, scene=scene)
        self.assertEqual(one["A"], exr.read(self.rendered("--spp", 16, *going, scene=scene)).pixels["A"])


if __name__ == "__main__":
    unittest.main()
