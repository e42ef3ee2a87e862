"""What the program tells: compare, info, statistics, progress."""

import array
import json
import math
import sys
import unittest

import exr
from support import DONE, SCENE, TINY, USAGE, CliTest

KEYS = {"mse", "relmse", "relmse_trimmed", "psnr", "flip", "mean_ratio", "nonfinite", "identical"}


def srgb(v):
    v = min(max(v, 0.0), 1.0)
    return 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055


def measures(image, reference, pixels=None):
    """The definitions of the measures, once more."""
    pixels = range(image.width * image.height) if pixels is None else pixels
    squares, relative, encoded = 0.0, [], 0.0
    for i in pixels:
        error = 0.0
        for c in "RGB":
            v, r = image.pixels[c][i], reference.pixels[c][i]
            squares += (v - r) ** 2
            error += (v - r) ** 2 / (r * r + 0.01) / 3
            encoded += (srgb(v) - srgb(r)) ** 2
        relative.append(error)
    relative.sort()
    kept = relative[: len(relative) - len(relative) // 1000]
    n = len(relative)
    return {
        "mse": squares / (3 * n),
        "relmse": sum(relative) / n,
        "relmse_trimmed": sum(kept) / len(kept),
        "psnr": -10 * math.log10(encoded / (3 * n)),
        "mean_ratio": [
            sum(image.pixels[c][i] for i in pixels) / sum(reference.pixels[c][i] for i in pixels) for c in "RGB"
        ],
    }


class Compare(CliTest):
    def setUp(self):
        super().setUp()
        size = ["--resolution", "60x40", "--method", "uniform"]
        self.image = self.rendered(*size, "--spp", "2", output="image.exr")
        self.reference = self.rendered(*size, "--spp", "32", "--seed", "9", output="reference.exr")

    def compare(self, *arguments):
        result = self.run_program("compare", *arguments, "--json")
        self.assertEqual((result.code, result.stderr), (DONE, ""), result)
        return json.loads(result.stdout)

    def assert_measures(self, found, expected):
        self.assertEqual(set(found), KEYS)
        for key in ("mse", "relmse", "relmse_trimmed"):
            self.assertAlmostEqual(found[key], expected[key], delta=1e-5 * expected[key], msg=key)
        self.assertAlmostEqual(found["psnr"], expected["psnr"], delta=1e-3)
        for f, e in zip(found["mean_ratio"], expected["mean_ratio"]):
            self.assertAlmostEqual(f, e, delta=1e-5)

    def test_measures(self):
        found = self.compare(self.image, self.reference)
        image, reference = exr.read(self.image), exr.read(self.reference)
        self.assert_measures(found, measures(image, reference))
        self.assertLess(found["relmse_trimmed"], found["relmse"])
        self.assertTrue(0 < found["flip"] < 1)
        self.assertEqual(found["nonfinite"], 0)
        self.assertIsInstance(found["nonfinite"], int)
        self.assertIs(found["identical"], False)

    def test_crop(self):
        found = self.compare(self.image, self.reference, "--crop", "10,5,40,35")
        inside = [y * 60 + x for y in range(5, 35) for x in range(10, 40)]
        self.assert_measures(found, measures(exr.read(self.image), exr.read(self.reference), inside))

    def test_equal_images(self):
        found = self.compare(self.image, self.image)
        self.assertEqual(set(found), KEYS)
        for key in ("mse", "relmse", "relmse_trimmed", "flip"):
            self.assertEqual(found[key], 0)
        self.assertIsNone(found["psnr"])  # JSON has no infinity
        self.assertEqual(found["mean_ratio"], [1, 1, 1])
        self.assertIs(found["identical"], True)

    def test_more_samples_are_closer(self):
        better = self.rendered(
            "--resolution", "60x40", "--method", "uniform", "--spp", "16", "--seed", "3", output="better.exr"
        )
        near, far = self.compare(better, self.reference), self.compare(self.image, self.reference)
        for key in ("mse", "relmse", "relmse_trimmed", "flip"):
            self.assertLess(near[key], far[key], key)
        self.assertGreater(near["psnr"], far["psnr"])

    def test_values_that_are_no_numbers_are_counted(self):
        values = array.array("f", [0.5] * (3 * 4 * 2))
        values[0], values[7] = math.nan, math.inf
        path = self.write("bad.pfm", f"PF\n4 2\n{1 if sys.byteorder == 'big' else -1}\n".encode() + values.tobytes())
        found = self.compare(path, path)
        self.assertEqual(found["nonfinite"], 2)
        self.assertEqual(found["mse"], 0)

    def test_text_has_the_same_names(self):
        result = self.run_program("compare", self.image, self.reference)
        self.assertEqual(result.code, DONE, result)
        self.assertEqual({line.split()[0] for line in result.stdout.splitlines()}, KEYS)

    def test_images_that_cannot_be_compared(self):
        other = self.rendered("--resolution", "30x40", output="other.exr")
        self.assert_fails(self.run_program("compare", self.image, other), USAGE, "60x40", "30x40")
        self.assert_fails(self.run_program("compare", self.image, "missing.exr"), SCENE, "missing.exr")
        self.assert_fails(self.run_program("compare", self.image, self.folder), SCENE, str(self.folder))
        self.assert_fails(self.run_program("compare", "scene.pbrt", self.image), SCENE, "scene.pbrt")

    def test_damaged_images(self):
        whole = self.image.read_bytes()
        for length in [0, 1, 4, 8, 100, len(whole) // 2, len(whole) - 1]:
            with self.subTest(length=length):
                self.write("short.exr", whole[:length])
                self.assert_fails(self.run_program("compare", "short.exr", self.image), SCENE, "short.exr")
                self.assert_fails(self.run_program("info", "short.exr"), SCENE, "short.exr")


class Info(CliTest):
    def test_image(self):
        result = self.run_program("info", self.rendered("--spp", "2"))
        self.assertEqual((result.code, result.stderr), (DONE, ""), result)
        for text in ("24x16", "raw", "albedo", "cov", "complete = 1", "spp = 2"):
            self.assertIn(text, result.stdout)

    def test_picture(self):
        self.rendered("--png", "out.png")
        result = self.run_program("info", "out.png")
        self.assertEqual(result.code, DONE, result)
        self.assertIn("24x16", result.stdout)

    def test_scene(self):
        self.write("scene.pbrt", TINY)
        result = self.run_program("info", "scene.pbrt")
        self.assertEqual((result.code, result.stderr), (DONE, ""), result)
        for text in ("24x16", "4 samples", "2 triangles", "2 spheres"):
            self.assertIn(text, result.stdout)

    def test_neither(self):
        self.write("notes.txt", "hello")
        self.assert_fails(self.run_program("info", "notes.txt"), SCENE, "notes.txt")
        self.assert_fails(self.run_program("info", "missing.exr"), SCENE, "missing.exr")
        self.assert_fails(self.run_program("info", "missing.pbrt"), SCENE, "missing.pbrt")


class Statistics(CliTest):
    def statistics(self, *arguments):
        self.rendered(*arguments, "--stats", "stats.json")
        return json.loads((self.folder / "stats.json").read_text())

    def test_uniform(self):
        stats = self.statistics("--method", "uniform", "--spp", "3")
        self.assertEqual(stats["radiance"]["samples"], 3 * 24 * 16)
        self.assertEqual(stats["covariance"]["samples"], 0)
        self.assertEqual(stats["spp"], 3)
        self.assertIs(stats["complete"], True)
        self.assertGreaterEqual(stats["radiance"]["rays"], stats["radiance"]["samples"])
        self.assertEqual(stats["radiance"]["rejected"], 0)
        self.assertGreater(stats["seconds_total"], 0)

    def test_covariance_paths_count(self):
        stats = self.statistics("--spp", "8", "--cov-spp", "3")
        self.assertEqual(stats["covariance"]["samples"], 3 * 24 * 16)
        self.assertAlmostEqual(stats["spp"], 8, delta=0.05)
        total = stats["covariance"]["samples"] + stats["radiance"]["samples"]
        self.assertAlmostEqual(total / (24 * 16), stats["spp"], delta=1e-6)
        for phase in ("covariance", "plan", "radiance", "reconstruction"):
            self.assertGreaterEqual(stats["seconds"][phase], 0)
        self.assertLessEqual(sum(stats["seconds"].values()), stats["seconds_total"])


class Progress(CliTest):
    LONG = ["--spp", "300", "--resolution", "64x48"]

    def lines(self, style, method="covariance"):
        self.write("scene.pbrt", TINY)
        result = self.run_program(
            "render", "scene.pbrt", "-o", "out.exr", "--method", method, "--progress", style, "--quiet", *self.LONG
        )
        self.assertEqual((result.code, result.stdout), (DONE, ""), result)
        return result.stderr.splitlines()

    def test_json(self):
        for method in ("uniform", "covariance", "hybrid"):
            with self.subTest(method=method):
                reports = [json.loads(line) for line in self.lines("json", method)]
                self.assertGreater(len(reports), 0)
                for report in reports:
                    self.assertEqual(set(report), {"phase", "fraction", "spp", "elapsed", "remaining"})
                    self.assertTrue(0 <= report["fraction"] <= 1, report)
                    self.assertIn(report["phase"], {"covariance", "radiance", "reconstruction"})
                elapsed = [r["elapsed"] for r in reports]
                self.assertEqual(elapsed, sorted(elapsed))

    def test_percent(self):
        for line in self.lines("percent"):
            self.assertRegex(line, r"^\d{1,2}%$")

    def test_plain(self):
        for line in self.lines("plain"):
            self.assertRegex(line, r"^\w+ +\d+% +\S+ spp")

    def test_none_and_quiet(self):
        self.assertEqual(self.lines("none"), [])

    def test_automatic_is_plain_without_a_terminal(self):
        self.write("scene.pbrt", TINY)
        result = self.run_program("render", "scene.pbrt", "-o", "out.exr", *self.LONG)
        self.assertNotIn("\r", result.stderr)
        self.assertNotIn("\x1b", result.stderr)

    def test_last_line_tells_the_file_and_the_samples(self):
        result = self.render(TINY, "--spp", "2")
        self.assertRegex(result.stderr, r"^out\.exr: 2 samples per pixel in \d+\.\d s\n$")


if __name__ == "__main__":
    unittest.main()
