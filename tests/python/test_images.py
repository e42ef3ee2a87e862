"""covtrace.Image and covtrace.compare: files, arrays, layers, measures."""

import pathlib
import tempfile
import unittest

import numpy

import covtrace


class Images(unittest.TestCase):
    def test_pictures_have_exposure_and_view(self):
        image = covtrace.Image.from_arrays(numpy.full((2, 2, 3), 0.25))

        def shown(**arguments):
            with tempfile.TemporaryDirectory() as folder:
                image.write(pathlib.Path(folder) / "a.png", **arguments)
                return covtrace.Image.read(pathlib.Path(folder) / "a.png").rgb[0, 0, 0]

        self.assertAlmostEqual(shown(), 0.25, delta=0.003)
        self.assertAlmostEqual(shown(exposure=1), 0.5, delta=0.004)
        self.assertAlmostEqual(shown(exposure=-1, view="srgb"), 0.125, delta=0.002)
        self.assertNotAlmostEqual(shown(view="agx"), shown(view="filmic"), delta=0.01)
        for wrong in ({"view": "raw"}, {"view": 3}, {"exposure": "x"}, {"exposure": None}, {"exposure": float("nan")}):
            with self.subTest(wrong), self.assertRaises(covtrace.UsageError):
                shown(**wrong)

    def test_round_trip(self):
        rng = numpy.random.default_rng(1)
        rgb = rng.random((5, 7, 3), dtype=numpy.float32)
        normal = {c: rng.random((5, 7)) for c in "XYZ"}
        image = covtrace.Image.from_arrays(rgb, {"N": normal, "Z": rng.random((5, 7))},
                                           {"note": "hello"})
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.exr"
            image.write(file)
            again = covtrace.Image.read(file)
            image.write(pathlib.Path(folder) / "a.png")
            self.assertEqual(covtrace.Image.read(pathlib.Path(folder) / "a.png").size, (7, 5))
        numpy.testing.assert_array_equal(again.rgb, rgb)
        numpy.testing.assert_array_equal(again["N.Y"], normal["Y"].astype(numpy.float32))
        self.assertEqual(again["N"].shape, (5, 7, 3))
        self.assertEqual(again.metadata["note"], "hello")
        self.assertTrue(covtrace.compare(image, again).identical)
        self.assertIn("N", again)
        self.assertNotIn("M", again)
        with self.assertRaises(KeyError):
            again["M"]

    def test_root_channels_around_depth(self):
        # Files sort their channels by name: B, G, R, Z, id.
        shape = (2, 3)
        given = {name: numpy.full(shape, i, dtype=numpy.float32)
                 for i, name in enumerate(("B", "G", "R", "Z", "id"))}
        image = covtrace.Image.from_arrays(layers=given)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.exr"
            image.write(file)
            for one in (image, covtrace.Image.read(file)):
                numpy.testing.assert_array_equal(one.rgb[0, 0], [2, 1, 0])
                self.assertEqual(one["Z"][0, 0], 3)
                self.assertEqual(one["id"][0, 0], 4)

    def test_compare(self):
        reference = numpy.full((8, 8, 3), 0.5)
        c = covtrace.compare(1.1 * reference, reference)
        self.assertAlmostEqual(c.mse, 0.0025, places=6)
        self.assertAlmostEqual(c.relmse, 0.0025 / 0.26, places=6)
        self.assertAlmostEqual(c.relmse_median, 0.0025 / 0.2525, places=6)
        numpy.testing.assert_allclose(c.mean_ratio, 1.1, rtol=1e-6)
        numpy.testing.assert_allclose(c.decile_ratio, [numpy.nan] * 9 + [1.1], rtol=1e-6)
        self.assertEqual(c.flip_map.shape, (8, 8))
        self.assertFalse(c.identical)
        with self.assertRaises(covtrace.UsageError):
            covtrace.compare(reference, numpy.zeros((4, 4, 3)))

    def test_compare_sees_what_is_dark(self):
        reference = numpy.ones((16, 80, 3)) * numpy.repeat(numpy.geomspace(0.001, 1, 10), 8)[None, :, None]
        image = reference.copy()
        image[:, :8] *= 0.4
        c = covtrace.compare(image, reference)
        numpy.testing.assert_allclose(c.mean_ratio, 1, atol=1e-3)
        numpy.testing.assert_allclose(c.decile_ratio, [0.4] + [1] * 9, rtol=1e-5)
        dim = covtrace.compare(0.001 * image, 0.001 * reference)
        self.assertAlmostEqual(dim.relmse_median / c.relmse_median, 1, places=4)

    def test_compare_where_nothing_is_finite(self):
        reference = numpy.full((6, 8, 3), 0.5)
        c = covtrace.compare(numpy.full((6, 8, 3), numpy.nan), reference)
        self.assertEqual(c.nonfinite, 3 * 6 * 8)
        for measure in (c.mse, c.relmse, c.relmse_trimmed, c.relmse_median, c.psnr, c.flip, *c.decile_ratio):
            self.assertTrue(numpy.isnan(measure))
        numpy.testing.assert_array_equal(c.flip_map, numpy.zeros((6, 8)))

    def test_layers_of_a_wrong_shape(self):
        for values in (3.0, [1.0, 2.0], numpy.zeros((2, 2, 2)), numpy.zeros((0, 2))):
            with self.subTest(shape=numpy.shape(values)):
                with self.assertRaisesRegex(ValueError, "'Z' must be a \\(height, width\\) array"):
                    covtrace.Image.from_arrays(layers={"Z": values})

    def test_names_of_channels(self):
        values = numpy.ones((4, 4), numpy.float32)
        for arguments in ({"layers": {"": values}}, {"layers": {"x" * 300: values}},
                          {"rgb": numpy.ones((4, 4, 3)), "layers": {"R": values}}):
            with self.assertRaises(ValueError):
                covtrace.Image.from_arrays(**arguments)


if __name__ == "__main__":
    unittest.main()
