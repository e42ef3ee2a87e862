"""Scenes far from the origin are as bright as at the origin, although single precision has steps of a thousandth there."""

import unittest

import exr
from support import DONE, CliTest

FAR = 10000
SCENE = """\
Film "rgb" "integer xresolution" 48 "integer yresolution" 36
Sampler "zsobol" "integer pixelsamples" 128
Integrator "path" "integer maxdepth" 7
LookAt 0 1.5 -6  0 .8 0  0 1 0
Translate {back}
Camera "perspective" "float fov" 40
WorldBegin
Translate {there}
AttributeBegin
AreaLightSource "diffuse" "rgb L" [6 6 6]
Translate 0 2.4 0
{lamp}
AttributeEnd
AttributeBegin
{thing}
AttributeEnd
Material "diffuse" "rgb reflectance" [.7 .7 .7]
Shape "trianglemesh" "point3 P" [-4 0 -4  4 0 -4  4 0 4  -4 0 4] "integer indices" [0 1 2  0 2 3]
Shape "trianglemesh" "point3 P" [-4 0 4  4 0 4  4 5 4  -4 5 4] "integer indices" [0 1 2  0 2 3]
"""
BALL, DISK = 'Shape "sphere" "float radius" .5', 'Rotate 100 1 0 0  Shape "disk" "float radius" .5'
WINDOW = 'Material "thindielectric"  Shape "trianglemesh" "point3 P" [-4 1.4 -4  4 1.4 -4  4 1.4 4  -4 1.4 4] "integer indices" [0 1 2  0 2 3]'
MIRROR = 'Material "conductor" "rgb reflectance" [.9 .9 .9] "float roughness" 0' \
         '  Shape "trianglemesh" "point3 P" [3 0 -4  3 0 4  3 4 4  3 4 -4] "integer indices" [0 1 2  0 2 3]'


class FarScenes(CliTest):
    def mean(self, lamp, thing, far):
        there = (far, 0.7 * far, -0.9 * far)
        text = SCENE.format(lamp=lamp, thing=thing, there=" ".join(map(str, there)), back=" ".join(str(-t) for t in there))
        self.assertEqual(self.render(text, "--method", "uniform").code, DONE)
        pixels = exr.read(self.folder / "out.exr").pixels["R"]
        return sum(pixels) / len(pixels)

    def test_scenes_keep_their_light(self):
        for name, lamp, thing in (("sphere", BALL, ""), ("disk", DISK, ""), ("through a pane", BALL, WINDOW), ("by a mirror", BALL, MIRROR)):
            with self.subTest(name):
                # The random numbers are the same, so that the noise nearly is.
                self.assertAlmostEqual(self.mean(lamp, thing, FAR) / self.mean(lamp, thing, 0), 1, delta=0.002)


if __name__ == "__main__":
    unittest.main()
