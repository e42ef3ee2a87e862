"""Fibres over pbrt's materials, by parameters of ours."""

import unittest

import exr
from support import DONE, CliTest

PLANE = """\
LookAt 0 3 3  0 0 0  0 1 0
Camera "perspective" "float fov" 5
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
Sampler "zsobol" "integer pixelsamples" 64
WorldBegin
LightSource "infinite"
Material {}
Shape "trianglemesh" "point3 P" [-9 0 -9  9 0 -9  9 0 9  -9 0 9] "integer indices" [0 1 2  0 2 3]
"""
BLACK = '"diffuse" "rgb reflectance" [0 0 0] '


class Sheen(CliTest):
    def seen(self, material, warning=""):
        """Means of red, green and blue."""
        result = self.render(PLANE.format(material), "--method", "uniform")
        self.assertEqual(result.code, DONE, result)
        self.assertIn(warning, result.stderr)
        if not warning:
            self.assertEqual(result.stderr.count("\n"), 1, result)
        pixels = exr.read(self.folder / "out.exr").pixels
        return [sum(pixels[c]) / len(pixels[c]) for c in "RGB"]

    def test_fibres_reflect_by_their_colour(self):
        self.assertEqual(self.seen(BLACK), [0, 0, 0])
        red, green, blue = self.seen(BLACK + '"rgb sheen" [.8 .4 0] "float sheenroughness" 0.5')
        self.assertGreater(red, 0.1)
        self.assertAlmostEqual(green / red, 0.5, delta=0.01)
        self.assertEqual(blue, 0)
        narrow, *_ = self.seen(BLACK + '"rgb sheen" [.8 .4 0]')
        self.assertLess(narrow, 0.8 * red)

    def test_what_is_below_gets_what_they_leave(self):
        white = '"diffuse" "rgb reflectance" [1 1 1] '
        plain, covered = self.seen(white)[0], self.seen(white + '"rgb sheen" [1 1 1] "float sheenroughness" 0.5')[0]
        self.assertAlmostEqual(plain, 1, delta=0.01)
        self.assertLess(covered, 1.01)
        self.assertGreater(covered, 0.7)

    def test_textures_tell_it_too(self):
        texture = PLANE.replace("Material", 'Texture "red" "spectrum" "constant" "rgb value" [.8 .4 0]\nMaterial').format(
            BLACK + '"texture sheen" "red" "float sheenroughness" 0.5')
        self.assertEqual(self.render(texture, "--method", "uniform").code, DONE)
        pixels = exr.read(self.folder / "out.exr").pixels
        self.assertAlmostEqual(sum(pixels["R"]) / 64, self.seen(BLACK + '"rgb sheen" [.8 .4 0] "float sheenroughness" 0.5')[0], delta=1e-3)

    def test_roughness_alone_is_told(self):
        self.seen(BLACK + '"float sheenroughness" 0.5', warning="sheenroughness")


if __name__ == "__main__":
    unittest.main()
