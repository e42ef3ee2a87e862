"""`denoise`: images as other renderers write them, and what cannot be reconstructed."""

import math
import random
import re
import unittest

import exr
from support import DONE, SCENE, USAGE, CliTest, warnings_of
from test_denoiser import FAKE_NAME, FAKES, NAME

WIDTH, HEIGHT = 48, 32


def albedo(x, y):
    return 0.8 if (x // 6 + y // 6) % 2 else 0.2


def truth(x, y):
    return albedo(x, y) * (1 + 0.5 * math.sin(0.1 * x))


def plane(value):
    return [value(x, y) for y in range(HEIGHT) for x in range(WIDTH)]


def noisy(seed, relative=0.4):
    """Red, green and blue with one normal noise."""
    numbers = random.Random(seed)
    return plane(lambda x, y: truth(x, y) * (1 + relative * numbers.gauss(0, 1)))


def mitsuba(seed):
    """An image of the "aov" integrator with "albedo:albedo,nn:sh_normal,dd:depth"."""
    color, flat = noisy(seed), plane(albedo)
    channels = {name: color for name in ("R", "G", "B", "img.R", "img.G", "img.B")}
    channels |= {f"albedo.{c}": flat for c in "RGB"} | {f"nn.{c}": plane(lambda x, y: float(c == "Z")) for c in "XYZ"}
    return channels | {"dd.T": plane(lambda x, y: 4 + 0.01 * y)}


def pbrt(seed, samples):
    """An image of the "gbuffer" film, whose variance is that of a sample."""
    channels = mitsuba(seed)
    variance = plane(lambda x, y: samples * (0.4 * truth(x, y)) ** 2)
    image = {c: channels[c] for c in "RGB"} | {f"Albedo.{c}": channels[f"albedo.{c}"] for c in "RGB"}
    image |= {f"{n}.{c}": channels[f"nn.{c}"] for n in ("N", "Ns") for c in "XYZ"} | {f"Variance.{c}": variance for c in "RGB"}
    return image | {"P.X": plane(lambda x, y: 0.0), "P.Y": plane(lambda x, y: 0.0), "P.Z": channels["dd.T"]}


def cycles(seed):
    """A multilayer image of Blender whose denoiser has made Combined."""
    channels = mitsuba(seed)
    image = {f"ViewLayer.Combined.{c}": plane(lambda x, y: 7.0) for c in "RGBA"}
    image |= {f"ViewLayer.Noisy Image.{c}": channels[c] for c in "RGB"}
    image |= {f"ViewLayer.Denoising Albedo.{c}": channels[f"albedo.{c}"] for c in "RGB"}
    image |= {f"ViewLayer.Denoising Normal.{c}": channels[f"nn.{c}"] for c in "XYZ"}
    return image | {"ViewLayer.Denoising Depth.Z": channels["dd.T"]}


def relative_error(image):
    squares = [(image.pixels[c][i] - t) ** 2 / (t * t + 0.01) for c in "RGB" for i, t in enumerate(plane(truth))]
    return math.sqrt(sum(squares) / len(squares))


class Denoise(CliTest):
    def image(self, name, channels, **metadata):
        exr.write(self.folder / name, WIDTH, HEIGHT, channels, metadata)
        return name

    def denoise(self, *arguments):
        """The image and its told error; without a denoiser, as other machines have none."""
        result = self.run_program("denoise", *arguments, "-o", "out.exr", "--denoiser", "none")
        self.assertEqual((result.code, result.stdout), (DONE, ""), result)
        told = float(re.search(r"^estimated error (\S+), no denoiser$", result.stderr, re.M)[1])
        return exr.read(self.folder / "out.exr"), told, [text for _, text in warnings_of(result)]

    def test_two_renders_of_each_renderer(self):
        for renderer, of_seed in (("mitsuba", mitsuba), ("pbrt", lambda seed: pbrt(seed, 4)), ("cycles", cycles)):
            with self.subTest(renderer):
                files = [self.image(f"{renderer}-{k}.exr", of_seed(k), samplesPerPixel=4) for k in (1, 2)]
                image, told, warnings = self.denoise(*files)
                error = relative_error(image)
                self.assertLess(error, 0.09)  # the mean of both has 0.27
                self.assertLess(abs(math.log(told / error)), math.log(1.6))
                self.assertEqual(warnings, [])
                self.assertEqual(set(image.channels), {"R", "G", "B", "error.Y"} | ({"A"} if renderer == "cycles" else set())
                                 | {f"{layer}.{c}" for layer in ("raw", "variance") for c in "RGB"})
                self.assertEqual(image.value("spp"), 8)

    def test_one_render_with_its_variance(self):
        image, told, warnings = self.denoise(self.image("a.exr", pbrt(1, 16), samplesPerPixel=16))
        error = relative_error(image)
        self.assertLess(error, 0.16)  # of 0.38
        self.assertLess(abs(math.log(told / error)), math.log(1.7))
        self.assertEqual(warnings, [])
        # The noise of a pixel is 0.4 of it, and one sample's is lent by brighter ones around.
        x, y = 9, 9
        self.assertAlmostEqual(math.sqrt(image.pixels["variance.G"][y * WIDTH + x]) / (0.4 * truth(x, y)), 1, delta=0.2)

    def test_the_same_bits_again(self):
        file = self.image("a.exr", pbrt(1, 16), samplesPerPixel=16)
        self.denoise(file)
        first = (self.folder / "out.exr").read_bytes()
        self.denoise(file, "--threads", "1")
        self.assertEqual((self.folder / "out.exr").read_bytes(), first)

    def test_layers_by_name(self):
        def renamed(seed):
            return {name.replace("albedo", "base").replace("nn", "up"): v for name, v in mitsuba(seed).items()}

        files = [self.image(f"{k}.exr", renamed(k)) for k in (1, 2)]
        without, _, warnings = self.denoise(*files)
        self.assertEqual(len(warnings), 1)
        self.assertIn("no layer is known as albedo, normal", warnings[0])
        image, _, warnings = self.denoise(*files, "--albedo", "base", "--normal", "up", "--depth", "dd", "--samples", "16")
        self.assertEqual(warnings, [])
        self.assertEqual(image.value("spp"), 32)
        self.assertLess(relative_error(image), 0.8 * relative_error(without))
        left_out, _, _ = self.denoise(*files, "--albedo", "base", "--normal", "none", "--depth", "none")
        self.assertNotEqual(left_out.pixels["R"], image.pixels["R"])
        self.assert_fails(self.run_program("denoise", *files, "-o", "a.exr", "--albedo", "reflectance"), USAGE, "--albedo",
                          "1.exr", "'reflectance'", "base, dd, img, up")

    def test_our_own_renders(self):
        for k in (1, 2):
            self.rendered("--method", "uniform", "--spp", "4", "--seed", str(k), output=f"{k}.exr")
        image, _, warnings = self.denoise("1.exr", "2.exr")
        self.assertEqual(warnings, [])
        self.assertEqual(image.value("spp"), 8)

    def test_a_denoiser(self):
        files = [self.image(f"{k}.exr", mitsuba(k)) for k in (1, 2)]
        arguments = ("denoise", *files, "-o", "out.exr", "--denoiser-library")
        result = self.run_program(*arguments, FAKES / "good" / NAME)
        self.assertEqual((result.code, warnings_of(result)), (DONE, []), result)
        self.assertTrue(result.stderr.endswith(f", {FAKE_NAME}\n"), result)
        with_it = exr.read(self.folder / "out.exr")
        self.assertEqual(with_it.value("covtrace:denoiser"), FAKE_NAME)
        self.assertNotEqual(with_it.pixels["R"], self.denoise(*files)[0].pixels["R"])
        result = self.run_program(*arguments, FAKES / "execute-fails" / NAME)
        self.assertEqual(result.code, DONE, result)
        self.assertIn("without the denoiser", warnings_of(result)[0][1])
        self.assertTrue(result.stderr.endswith(", no denoiser\n"), result)

    def test_lost_pixels(self):
        channels = mitsuba(1)
        channels["G"] = channels["G"][:]
        channels["G"][100] = math.nan
        image, _, warnings = self.denoise(self.image("1.exr", channels), self.image("2.exr", mitsuba(2)))
        self.assertEqual(len(warnings), 1)
        self.assertIn("1 pixel is not finite", warnings[0])
        self.assertTrue(all(math.isfinite(v) for values in image.pixels.values() for v in values))

    def test_what_cannot_tell_its_noise(self):
        one, two = self.image("1.exr", mitsuba(1)), self.image("2.exr", mitsuba(2))
        again = self.image("again.exr", mitsuba(1))
        exr.write(self.folder / "small.exr", 2, 2, {c: [1, 2, 3, 4] for c in "RGB"}, {})
        for images, fragments in (([one], ["1.exr has no variance", "second render with another seed"]),
                                  ([one, again], ["again.exr has the same pixels as 1.exr"]),
                                  ([one, one], ["has the same pixels"]),
                                  ([one, two, again], ["expected one image with its variance, or two images"]),
                                  ([one, "small.exr"], ["small.exr", "2x2", "48x32"])):
            with self.subTest(images):
                self.assert_fails(self.run_program("denoise", *images, "-o", "out.exr"), USAGE, *fragments)
                self.assert_no_file()
        self.assert_fails(self.run_program("denoise", one, "none.exr", "-o", "out.exr"), SCENE, "none.exr")
        self.assert_fails(self.run_program("denoise", one, two, "-o", one), USAGE, "1.exr")
        self.assert_fails(self.run_program("denoise", one, two), USAGE, "--output")

    def test_pictures(self):
        files = [self.image(f"{k}.exr", mitsuba(k)) for k in (1, 2)]
        result = self.run_program("denoise", *files, "-o", "out.png", "--quiet")
        self.assertEqual((result.code, result.stderr), (DONE, ""), result)
        result = self.run_program("denoise", *files, "-o", "out.exr", "--png", "b.png", "--exposure", "0", "--quiet")
        self.assertEqual(result.code, DONE, result)
        self.assertEqual((self.folder / "out.png").read_bytes(), (self.folder / "b.png").read_bytes())


if __name__ == "__main__":
    unittest.main()
