"""covtrace.covariance against the master rule in numpy, and its broadcasting."""

import unittest

import numpy

from covtrace import covariance as c


def random_sigma(rng, *shape):
    a = rng.normal(size=(*shape, 5, 5))
    return a @ a.swapaxes(-1, -2)


def random_frame(rng):
    q, _ = numpy.linalg.qr(rng.normal(size=(3, 3)))
    return q


class Operators(unittest.TestCase):
    def setUp(self):
        self.rng = numpy.random.default_rng(5)

    def test_travel_is_the_shear(self):
        sigma = random_sigma(self.rng, 4)
        d = self.rng.uniform(0, 3, 4)
        a = numpy.broadcast_to(numpy.eye(5), (4, 5, 5)).copy()
        a[:, 0, 2] = a[:, 1, 3] = -d
        expected = a.swapaxes(1, 2) @ sigma @ a
        numpy.testing.assert_allclose(c.travel(sigma, d), expected, rtol=1e-12, atol=1e-12)
        numpy.testing.assert_allclose(c.transform(sigma, a), expected, rtol=1e-12, atol=1e-12)

    def test_broadcasting(self):
        sigma = random_sigma(self.rng, 3, 1)
        d = self.rng.uniform(0, 3, (2,))
        all_of_them = c.travel(sigma, d)
        self.assertEqual(all_of_them.shape, (3, 2, 5, 5))
        for i in range(3):
            for j in range(2):
                numpy.testing.assert_array_equal(all_of_them[i, j], c.travel(sigma[i, 0], d[j]))
        self.assertEqual(c.travel(numpy.zeros((0, 5, 5)), 1.0).shape, (0, 5, 5))
        self.assertIsInstance(c.filter_sharpness(16.0), float)
        with self.assertRaises(ValueError):
            c.travel(random_sigma(self.rng, 3), [1.0, 2.0])
        with self.assertRaisesRegex(ValueError, "argument 1 .*5, 5"):
            c.travel(numpy.eye(4), 1.0)

    def test_strided_and_integer_input(self):
        sigma = random_sigma(self.rng, 6)
        numpy.testing.assert_array_equal(c.travel(sigma[::2], 1), c.travel(sigma[::2].copy(), 1.0))
        numpy.testing.assert_array_equal(c.travel(numpy.eye(5, dtype=int), 2), c.travel(numpy.eye(5), 2.0))

    def test_surface_and_back(self):
        sigma, frame = random_sigma(self.rng), random_frame(self.rng)
        surface = random_frame(self.rng)
        curvature = numpy.array([[0.3, 0.1], [0.1, -0.2]])
        inside = c.surface_enter(sigma, frame, surface, curvature)
        numpy.testing.assert_allclose(c.surface_exit(inside, frame, surface, curvature), sigma,
                                      rtol=1e-8, atol=1e-8)

    def test_motion_and_back(self):
        sigma, frame = random_sigma(self.rng), random_frame(self.rng)
        velocity, turn = self.rng.normal(size=3), self.rng.normal(size=3)
        moved = c.motion_enter(sigma, frame, velocity, turn)
        numpy.testing.assert_allclose(c.motion_exit(moved, frame, velocity, turn), sigma, rtol=1e-9,
                                      atol=1e-9)

    def test_mirror_keeps_sigma(self):
        sigma = random_sigma(self.rng)
        frame = c.frame_along(numpy.array([0.6, 0, -0.8]))
        surface = numpy.eye(3)
        out, mirrored = c.reflect_specular(sigma, frame, surface, [0.6, 0, 0.8])
        numpy.testing.assert_array_equal(out, sigma)
        numpy.testing.assert_allclose(mirrored[2], [0.6, 0, 0.8], atol=1e-12)

    def test_diffuse_removes_the_angles(self):
        frame = c.frame_along(numpy.array([0.6, 0, -0.8]))
        out, _ = c.reflect_diffuse(random_sigma(self.rng), frame, numpy.eye(3), [0, 0, 1.0])
        numpy.testing.assert_allclose(out[2:4], 0, atol=1e-12)

    def test_preintegration_is_the_schur_complement(self):
        sigma = random_sigma(self.rng, 8)
        total = sigma + c.sensor_window()
        schur = total[:, :2, :2] - total[:, :2, 2:] @ numpy.linalg.solve(total[:, 2:, 2:],
                                                                         total[:, 2:, :2])
        numpy.testing.assert_allclose(c.preintegrate(sigma), schur, rtol=1e-8)

    def test_filter(self):
        spectrum = numpy.array([[0.01, 0.0], [0.0, 0.02]])
        expected = numpy.linalg.inv(4 * numpy.pi**2 * 4 * spectrum)
        numpy.testing.assert_allclose(c.filter_covariance(spectrum, 2.0), expected, rtol=1e-12)


if __name__ == "__main__":
    unittest.main()
