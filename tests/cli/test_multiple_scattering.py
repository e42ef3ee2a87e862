"""Light that meets several microfacets of a rough surface, by a parameter of ours."""

import math
import unittest

import exr
from support import DONE, CliTest

SIDE = 24
BALL = f"""\
LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" 18
Film "rgb" "integer xresolution" {SIDE} "integer yresolution" {SIDE}
Sampler "zsobol" "integer pixelsamples" 256
Integrator "path" "integer maxdepth" 100
WorldBegin
LightSource "infinite"
Material {{}}
Shape "sphere" "float radius" 0.7
"""
METAL = '"conductor" "rgb reflectance" [1 1 1] "bool remaproughness" false '
GLASS = '"dielectric" "bool remaproughness" false '
COATED = ('"coatedconductor" "rgb reflectance" [1 1 1] "bool remaproughness" false "float interface.roughness" 0 "float thickness" 0 '
          '"integer maxdepth" 100 ')


class MultipleScattering(CliTest):
    def seen(self, material):
        """Mean of the middle of a ball in a white surrounding."""
        result = self.render(BALL.format(material), "--method", "uniform")
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(result.stderr.count("\n"), 1, result)
        green = exr.read(self.folder / "out.exr").pixels["G"]
        middle = range(SIDE // 4, 3 * SIDE // 4)
        return sum(green[y * SIDE + x] for y in middle for x in middle) / len(middle) ** 2

    def assert_vanishes(self, material, parameter, loss, tolerance=0.01):
        """Asserts that a ball is as bright as the sky with the parameter, and darker by `loss` at least without it."""
        self.assertLess(self.seen(material), 1 - loss)
        self.assertAlmostEqual(self.seen(material + f'"bool {parameter}" true'), 1, delta=tolerance)

    def test_white_metal_vanishes_in_a_furnace(self):
        for alpha, loss in ((0.04, 0), (0.25, 0.05), (0.81, 0.4)):
            with self.subTest(alpha=alpha):
                self.assert_vanishes(METAL + f'"float roughness" {alpha} ', "multiplescattering", loss)

    def test_clear_glass_vanishes_in_a_furnace(self):
        for alpha, loss in ((0.25, 0.04), (0.81, 0.2)):
            with self.subTest(alpha=alpha):
                self.assert_vanishes(GLASS + f'"float roughness" {alpha} ', "multiplescattering", loss)

    def colour_seen(self, scene):
        """Mean colour, each channel with its standard error, of the middle of a ball in a white surrounding."""
        result = self.render(scene, "--method", "uniform")
        self.assertEqual(result.code, DONE, result)
        pixels = exr.read(self.folder / "out.exr").pixels
        middle = [y * SIDE + x for y in range(SIDE // 4, 3 * SIDE // 4) for x in range(SIDE // 4, 3 * SIDE // 4)]
        return [(sum(pixels[c][i] for i in middle) / len(middle), math.sqrt(sum(pixels["variance." + c][i] for i in middle)) / len(middle))
                for c in "RGB"]

    def test_clear_glass_under_a_film_vanishes_in_a_furnace(self):
        # Nanometres of the film, also of two that vary over the ball.
        patches = 'Texture "patches" "float" "checkerboard" "float uscale" 8 "float vscale" 4 "float tex1" 120 "float tex2" 410\n'
        # Each colour is within 1 % and five standard errors: of 18 colours one is outside by chance with one seed in 100000.
        for alpha, eta, film_eta, thickness in ((1, 1.5, 2.5, 100), (0.5, 1.5, 2.5, 450), (1, 1.5, 1.22, 150), (1, 2.4, 1.22, 100),
                                                (0.25, 2.4, 1.6, 300), (1, 1.5, 2.5, None)):
            with self.subTest(alpha=alpha, eta=eta, film_eta=film_eta, thickness=thickness):
                film = f'"float filmthickness" {thickness}' if thickness else '"texture filmthickness" "patches"'
                material = (f'{GLASS} "float eta" {eta} "float roughness" {alpha} "float filmeta" {film_eta} {film} '
                            '"bool multiplescattering" true')
                scene = BALL.replace("Material", patches + "Material").format(material)
                for mean, error in self.colour_seen(scene):
                    self.assertAlmostEqual(mean, 1, delta=0.01 + 5 * error)

    def test_white_metal_below_a_coat_vanishes_in_a_furnace(self):
        # Random walks are noisy: the standard deviation of the mean is 0.006.
        self.assert_vanishes(COATED + '"float conductor.roughness" 0.5 ', "conductor.multiplescattering", 0.1, 0.03)


if __name__ == "__main__":
    unittest.main()
