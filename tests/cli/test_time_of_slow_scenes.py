"""Budgets of time where a single path takes long: thousands of media, one inside the other."""

import math
import time
import unittest

import exr
from support import DONE, HEADER, SLOWER, CliTest


class SlowPaths(CliTest):
    def test_nested_media(self):
        """Media inside each other, 5,000 of them: the render ran past 100 s of 3."""
        media = "".join(
            f'MakeNamedMedium "m{i}" "string type" "homogeneous" "rgb sigma_s" [1 1 1]\n'
            f'MediumInterface "m{i}" "{f"m{i - 1}" if i else ""}"\nMaterial "interface"\n'
            f'Shape "sphere" "float radius" {1 + i * 1e-4}\n' for i in range(5000))
        header = HEADER.replace('Integrator "path" "integer maxdepth" 4', 'Integrator "volpath" "integer maxdepth" 5')
        self.write("media.pbrt", header + 'WorldBegin\nLightSource "infinite"\n' + media + 'Shape "sphere" "float radius" .5\n')
        for method in ("uniform", "covariance", "hybrid"):
            with self.subTest(method=method):
                start = time.monotonic()
                result = self.run_program("render", "media.pbrt", "-o", "out.exr", "--time", "2", "--method", method, timeout=100)
                self.assertEqual(result.code, DONE, result)
                self.assertLess(time.monotonic() - start, 15 * SLOWER)
                image = exr.read(self.folder / "out.exr")
                self.assertTrue(all(map(math.isfinite, image.pixels["R"])))
                if min(image.pixels["samples.Y"]) == 0:
                    self.assertIn("--time: the time was over before", result.stderr)


if __name__ == "__main__":
    unittest.main()
