"""The choices of Belcour 2012, section 5.1, in covtrace.render: its density and k, its grid, and the filter that its
text asks for."""

import unittest

import numpy

import covtrace
import scenes


class Thesis(unittest.TestCase):
    def test_counts_are_n_between_the_limits(self):
        thesis = dict(method="covariance", density="thesis", occlusion="voxels", voxels=20, filter="matched")
        image = covtrace.render(scenes.builder(), k=30, cov_spp=0.5, max_spp=40, **thesis)
        self.assertEqual(image.statistics["k"], 30)
        # Counts are whole numbers near N, no more than the limit.
        wanted = numpy.minimum(image["density"], 40)
        self.assertLessEqual(float(numpy.abs(image["samples"] - wanted).max()), 1.001)
        self.assertIsNotNone(covtrace.render(scenes.builder(), spp=4, **thesis).statistics["k"])
        for wrong in (dict(k=0, **thesis), dict(k=3), dict(cov_spp=1.5, **thesis)):
            with self.assertRaises(covtrace.UsageError):
                covtrace.render(scenes.builder(), **wrong)
        # A pixel's covariance gives the same count.
        sigma = image.matrices("cov")[13, 24]
        count = covtrace.covariance.hypercube_density(covtrace.covariance.preintegrate(sigma), covtrace.covariance.integration_count(sigma))
        windowed = sigma + covtrace.covariance.sensor_window()
        self.assertAlmostEqual(float(count) / (numpy.pi * numpy.sqrt(numpy.linalg.det(windowed)) + 1e-12), 1, places=3)


if __name__ == "__main__":
    unittest.main()
