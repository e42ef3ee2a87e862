"""covtrace.denoise: images, files and arrays of other renderers."""

import pathlib
import tempfile
import unittest
import warnings

import numpy

import covtrace

RENDERS = pathlib.Path(__file__).parents[1] / "foreign"
HEIGHT, WIDTH = 40, 56
Y, X = numpy.indices((HEIGHT, WIDTH))
FLAT = numpy.where((X // 7 + Y // 7) % 2, 0.8, 0.2)
ALBEDO = numpy.stack([FLAT] * 3, -1)
TRUTH = ALBEDO * (1 + 0.5 * numpy.sin(0.1 * X))[:, :, None]
NORMAL = numpy.zeros((HEIGHT, WIDTH, 3)) + (0, 0, 1)
DEPTH = 4 + 0.01 * Y
VARIANCE = (0.4 * TRUTH) ** 2


def noisy(seed):
    return TRUTH * (1 + 0.4 * numpy.random.default_rng(seed).standard_normal((HEIGHT, WIDTH, 1)))


def error(image):
    return numpy.sqrt((((image.rgb - TRUTH) ** 2) / (TRUTH ** 2 + 0.01)).mean())


def denoised(*arguments, **options):
    return covtrace.denoise(*arguments, denoiser="none", **options)


class Denoise(unittest.TestCase):
    def test_two_renders(self):
        image = denoised([noisy(1), noisy(2)], ALBEDO, NORMAL, DEPTH, samples=4)
        self.assertLess(error(image), 0.09)  # the mean of both has 0.27
        self.assertLess(abs(numpy.log(image.statistics["error"] / error(image))), numpy.log(1.6))
        self.assertEqual(image["error"].shape, (HEIGHT, WIDTH))
        numpy.testing.assert_allclose(image["raw"], 0.5 * (noisy(1) + noisy(2)), atol=1e-5)
        self.assertEqual(image.metadata["spp"], 8)

    def test_images_files_and_arrays_are_one(self):
        images = [covtrace.Image.from_arrays(
            noisy(k), {"albedo": dict(zip("RGB", numpy.moveaxis(ALBEDO, -1, 0))),
                       "nn": dict(zip("XYZ", numpy.moveaxis(NORMAL, -1, 0))), "dd.T": DEPTH})
            for k in (1, 2)]
        expected = denoised(images)
        with tempfile.TemporaryDirectory() as folder:
            files = [pathlib.Path(folder) / f"{k}.exr" for k in (1, 2)]
            for image, file in zip(images, files):
                image.write(file)
            of_files = denoised(files)
        for other in (of_files,
                      denoised(numpy.stack([noisy(1), noisy(2)]), [ALBEDO, ALBEDO], NORMAL, depth=DEPTH),
                      denoised(images, albedo=ALBEDO, normal="nn", depth="dd")):
            numpy.testing.assert_array_equal(other.rgb, expected.rgb)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            without = denoised(images, albedo="none")
        self.assertIn("albedo", str(told[0].message))
        self.assertIs(told[0].category, covtrace.SceneWarning)
        self.assertGreater(error(without), error(expected))

    def test_one_render_with_its_variance(self):
        image = denoised(noisy(3), ALBEDO, NORMAL, DEPTH, VARIANCE, samples=16)
        self.assertLess(error(image), 0.16)  # of 0.38
        self.assertLess(abs(numpy.log(image.statistics["error"] / error(image))), numpy.log(1.7))

    def test_files_of_mitsuba_and_cycles(self):
        for name, reference in (("mitsuba", "mitsuba"), ("cycles", "cycles"), ("cycles-denoised", "cycles")):
            with self.subTest(name), warnings.catch_warnings():
                warnings.simplefilter("error")  # all layers are found
                image = denoised([RENDERS / f"{name}-1.exr", RENDERS / f"{name}-2.exr"])
                truth = covtrace.Image.read(RENDERS / f"{reference}-reference.exr")
                left = covtrace.compare(image, truth).relmse
                self.assertLess(left, 0.65 * covtrace.compare(image["raw"], truth).relmse)  # it leaves 0.51 to 0.58
                self.assertLess(abs(numpy.log(image.statistics["error"] / numpy.sqrt(left))), numpy.log(1.5))
                self.assertGreater(image["error"].min(), 0)

    def test_units_do_not_matter(self):
        expected = error(denoised([noisy(1), noisy(2)], ALBEDO, NORMAL, DEPTH))
        for scale in (1e-30, 1e-6, 1e6, 1e30):
            with self.subTest(scale):
                image = denoised([noisy(1) * scale, noisy(2) * scale], ALBEDO, NORMAL, DEPTH)
                left = numpy.sqrt((((image.rgb / scale - TRUTH) ** 2) / (TRUTH ** 2 + 0.01)).mean())
                self.assertLess(left, 1.1 * expected)

    def test_what_is_refused(self):
        a, b = noisy(1), noisy(2)
        for expected, arguments, options in (
                (r"color\[0\] has no variance", (a,), {}),
                (r"color\[1\] has the same pixels as color\[0\]", ([a, a],), {}),
                ("one image with its variance, or two images", ([a, b, noisy(3)],), {}),
                ("albedo has the shape", ([a, b], FLAT), {}),
                ("albedo has 3 arrays for 2 images", ([a, b], [ALBEDO] * 3), {}),
                ("height and width", ([a, b], ALBEDO[:8]), {}),
                ("no layer 'base'", ([a, b], "base"), {}),
                ("normal is 'q'|no layer 'q'", ([a, b], None, "q"), {}),
                ("color is 3", (3,), {}),
                ("samples", ([a, b],), {"samples": 0}),
                ("denoiser_library", ([a, b],), {"denoiser_library": 1}),
                ("threads", ([a, b],), {"threads": -1})):
            with self.subTest(expected), self.assertRaisesRegex(covtrace.UsageError, expected):
                denoised(*arguments, **options)
        with self.assertRaises(covtrace.SceneError):
            denoised(["none.exr", "none.exr"])


if __name__ == "__main__":
    unittest.main()
