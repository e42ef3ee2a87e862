"""Light that meets several microfacets of a rough surface, by a parameter of ours."""

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

    def test_white_metal_below_a_coat_vanishes_in_a_furnace(self):
        # Random walks are noisy: the standard deviation of the mean is 0.006.
        self.assert_vanishes(COATED + '"float conductor.roughness" 0.5 ', "conductor.multiplescattering", 0.1, 0.03)


if __name__ == "__main__":
    unittest.main()
