"""bench/quality/same_samples.py: the seed with which `uniform` has the samples that `hybrid` has at 4 per pixel."""

import os
import pathlib
import sys
import unittest

import exr
from support import DONE, TINY, CliTest

sys.path.insert(0, str(pathlib.Path(os.environ.get("COVTRACE_SOURCE", pathlib.Path(__file__).resolve().parents[2])) / "bench/quality"))
import same_samples


class SameSamples(CliTest):
    def raw(self, method, seed):
        result = self.render(TINY, "--method", method, "--seed", str(seed), "--spp", "4", "--denoiser", "none", "--quiet")
        self.assertEqual(result.code, DONE, result)
        return exr.read(self.folder / "out.exr").pixels["raw.G"]

    def test_raw_pixels_are_the_same(self):
        for seed in (1, 2):
            halves = self.raw("hybrid", seed)
            for a, b in zip(halves, self.raw("uniform", same_samples.seed_of_halves(seed))):
                self.assertAlmostEqual(a, b, delta=1e-5 * (1 + abs(a)))
            self.assertNotEqual(halves, self.raw("uniform", seed))


if __name__ == "__main__":
    unittest.main()
