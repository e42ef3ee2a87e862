"""The layers of pbrt-v4's film "gbuffer": its channels, and values that geometry tells."""

import math
import unittest

import exr
from support import DONE, CliTest

# A plane through (0, 0, 4), turned about the x axis, seen from a camera that stands elsewhere.
SCENE = """
Film "{film}" {space} "string filename" "out.exr" "integer xresolution" 16 "integer yresolution" 12
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
LookAt 3 -1 2  3 -1 7  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Translate 3 -1 6
Rotate 30 1 0 0
Material "diffuse" "rgb reflectance" [ 0.2 0.4 0.6 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]
    "point3 P" [ -8 -8 0  8 -8 0  8 8 0  -8 8 0 ]
"""
PBRT = (
    "R G B Albedo.R Albedo.G Albedo.B P.X P.Y P.Z dzdx dzdy N.X N.Y N.Z Ns.X Ns.Y Ns.Z u v "
    "Variance.R Variance.G Variance.B RelativeVariance.R RelativeVariance.G RelativeVariance.B"
).split()


class GBuffer(CliTest):
    def layers(self, *options, film="gbuffer", space="", method="uniform", spp=16, output="out.exr"):
        scene = SCENE.format(film=film, space=space)
        result = self.render(scene, "--method", method, "--spp", spp, *options, output=output)
        self.assertEqual(result.code, DONE, result)
        self.assertNotIn("warning", result.stderr)
        return exr.read(self.folder / output)

    def check_geometry(self, image, eye):
        """Compares with the plane n p = n (0, 0, 4) of the camera's space, which is moved by `eye`."""
        angle = math.radians(30)
        normal = (0, math.sin(angle), -math.cos(angle))
        slope = math.tan(math.radians(20)) / 6  # of the view, for a pixel: the shorter side has 12
        for y in range(12):
            for x in range(16):
                at = y * 16 + x
                w = ((x - 7.5) * slope, (5.5 - y) * slope, 1)
                t = 4 * normal[2] / sum(a * b for a, b in zip(normal, w))
                value = lambda name: image.pixels[name][at]
                for axis, p, n, o in zip("XYZ", w, normal, eye):
                    self.assertAlmostEqual(value("P." + axis), t * p + o, delta=0.02)
                    self.assertAlmostEqual(value("N." + axis), n, delta=1e-4)
                    self.assertAlmostEqual(value("Ns." + axis), n, delta=1e-4)
                # v runs along the slope: (y, z) = v (cos, sin), from -8 to 8
                self.assertAlmostEqual(value("u"), (t * w[0] + 8) / 16, delta=2e-3)
                self.assertAlmostEqual(value("v"), (t * w[1] / math.cos(angle) + 8) / 16, delta=2e-3)
                self.assertAlmostEqual(value("dzdx"), 0, delta=1e-4)
                below = (w[0], w[1] - slope, 1)
                step = 4 * normal[2] / sum(a * b for a, b in zip(normal, below)) - t
                self.assertAlmostEqual(value("dzdy"), abs(step), delta=0.05 * abs(step))
                self.assertAlmostEqual(value("Albedo.B"), 0.6, delta=1e-5)
                self.assertAlmostEqual(value("RelativeVariance.R"), value("Variance.R") / value("raw.R"), delta=1e-6)

    def test_in_the_cameras_space(self):
        image = self.layers()
        self.assertLessEqual(set(PBRT), set(image.channels))
        self.check_geometry(image, (0, 0, 0))

    def test_in_the_world(self):
        self.check_geometry(self.layers(space='"string coordinatesystem" "world"'), (3, -1, 2))

    def test_other_methods_keep_them(self):
        for method in ("covariance", "hybrid"):
            with self.subTest(method):
                self.check_geometry(self.layers(method=method), (0, 0, 0))

    def test_names_can_be_chosen(self):
        plain = self.layers("--layer-names", "default").channels
        for name in "P.X Ng.Z uv.X uv.Y dz.X dz.Y relvariance.B".split():
            self.assertIn(name, plain)
        self.assertNotIn("dzdx", plain)

    def test_other_films_have_them_where_they_are_named(self):
        without = self.layers(film="rgb").channels
        self.assertFalse({"P.X", "Ng.X", "uv.X", "dz.X", "relvariance.R"} & set(without))
        named = self.layers("--layers", "P,Ng,N", film="rgb")
        self.assertEqual(set(named.channels), set("R G B P.X P.Y P.Z Ng.X Ng.Y Ng.Z N.X N.Y N.Z".split()))
        self.assertAlmostEqual(named.pixels["P.Z"][6 * 16 + 8], 6, delta=0.2)

    def test_films_go_on_with_them(self):
        whole = self.layers()
        for spp in (4, 16):
            resumed = self.layers("--film", "f.cvf", spp=spp, output="resumed.exr")
        for name in ("P.X", "N.Z", "u", "dzdy"):
            self.assertEqual(list(resumed.pixels[name]), list(whole.pixels[name]), name)


if __name__ == "__main__":
    unittest.main()
