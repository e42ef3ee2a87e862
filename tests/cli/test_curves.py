"""White curves in a white surrounding keep the light: they are as bright as the sky behind them."""

import random
import unittest

import exr
from support import DONE, CliTest

SCENE = """\
LookAt 0 0 -6  0 0 0  0 1 0
Camera "perspective" "float fov" 20
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
Sampler "zsobol" "integer pixelsamples" 64
Integrator "path" "integer maxdepth" 60
WorldBegin
LightSource "infinite"
"""
# Each gives back all light.
WHITE = 'Material "diffuse" "rgb reflectance" [1 1 1]\n'
HAIR = 'Material "hair" "rgb sigma_a" [0 0 0] "float beta_m" 0.2\n'


class Curves(CliTest):
    def brightness(self, width, count, material):
        """Means over the picture of so many curves of about unit length: of their light, and of how much they cover."""
        numbers = random.Random(3)
        text = SCENE + material
        for _ in range(count):
            points = [[numbers.uniform(-1, 1) for _ in range(3)]]
            for _ in range(3):
                points.append([p + numbers.gauss(0, 0.25) for p in points[-1]])
            text += f'Shape "curve" "float width" {width} "point3 P" [{" ".join(f"{x:.6f}" for p in points for x in p)}]\n'
        self.assertEqual(self.render(text, "--method", "uniform").code, DONE)
        image = exr.read(self.folder / "out.exr")
        return sum(image.pixels["R"]) / len(image.pixels["R"]), sum(image.pixels["albedo.R"]) / len(image.pixels["R"])

    def test_hair_keeps_the_light(self):
        mean, covered = self.brightness(0.02, 1500, WHITE)
        self.assertGreater(covered, 0.5)
        # A standard error is 0.0005; what goes into the open ends does not all come back within 60 bounces.
        self.assertAlmostEqual(mean, 1, delta=0.006)
        # Strands of hair have no inside; tubes with smooth normals are wide ones.
        for width, count in ((0.02, 1500), (0.15, 100)):
            mean, covered = self.brightness(width, count, HAIR)
            self.assertGreater(covered, 0.5)
            self.assertAlmostEqual(mean, 1, delta=0.006)


if __name__ == "__main__":
    unittest.main()
