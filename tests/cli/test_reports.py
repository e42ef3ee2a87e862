"""Reports of the program: compare, info, statistics, progress."""

import array
import fcntl
import json
import math
import os
import pty
import struct
import subprocess
import sys
import termios
import unittest

import exr
from support import DONE, PROGRAM, SCENE, TINY, USAGE, CliTest

KEYS = {
    "mse", "relmse", "relmse_trimmed", "relmse_median", "psnr", "flip", "mean_ratio", "decile_ratio", "nonfinite",
    "identical",
}


def srgb(v):
    v = min(max(v, 0.0), 1.0)
    return 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055


def luminance(image, i):
    return sum(w * image.pixels[c][i] for w, c in zip((0.2126, 0.7152, 0.0722), "RGB"))


def decile_ratio(image, reference, pixels):
    """The sums of luminance over those of the reference, in ten groups of 8x8 blocks by its brightness."""
    top, left = divmod(pixels[0], image.width)
    blocks = {}
    for i in pixels:
        y, x = divmod(i, image.width)
        blocks.setdefault(((y - top) // 8, (x - left) // 8), []).append(i)
    by_brightness = sorted(blocks.values(), key=lambda b: sum(luminance(reference, i) for i in b) / len(b))
    ratios = []
    for k in range(10):
        group = by_brightness[k * len(blocks) // 10 : (k + 1) * len(blocks) // 10]
        inside = [i for block in group for i in block]
        light = sum(luminance(reference, i) for i in inside)
        ratios.append(sum(luminance(image, i) for i in inside) / light if light else None)
    return ratios


def measures(image, reference, pixels=None):
    """The measures by their definitions, once more; `pixels` are a rectangle's, row by row."""
    pixels = range(image.width * image.height) if pixels is None else pixels
    n = len(pixels)
    squares, encoded = 0.0, 0.0
    for i in pixels:
        for c in "RGB":
            v, r = image.pixels[c][i], reference.pixels[c][i]
            squares += (v - r) ** 2
            encoded += (srgb(v) - srgb(r)) ** 2

    def relative(eps):
        def error(v, r):
            return (v - r) ** 2 / (r * r + eps * eps)

        return sorted(sum(error(image.pixels[c][i], reference.pixels[c][i]) for c in "RGB") / 3 for i in pixels)

    kept = n - n // 1000
    median = sorted(luminance(reference, i) for i in pixels)[n // 2]
    return {
        "mse": squares / (3 * n),
        "relmse": sum(relative(0.1)) / n,
        "relmse_trimmed": sum(relative(0.1)[:kept]) / kept,
        "relmse_median": sum(relative(0.1 * median)[:kept]) / kept,
        "psnr": -10 * math.log10(encoded / (3 * n)),
        "mean_ratio": [
            sum(image.pixels[c][i] for i in pixels) / sum(reference.pixels[c][i] for i in pixels) for c in "RGB"
        ],
        "decile_ratio": decile_ratio(image, reference, pixels),
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
        for key in ("mse", "relmse", "relmse_trimmed", "relmse_median"):
            self.assertAlmostEqual(found[key], expected[key], delta=1e-5 * expected[key], msg=key)
        self.assertAlmostEqual(found["psnr"], expected["psnr"], delta=1e-3)
        for key in ("mean_ratio", "decile_ratio"):
            self.assertEqual(len(found[key]), len(expected[key]))
            for f, e in zip(found[key], expected[key]):
                if e is None:
                    self.assertIsNone(f, key)
                else:
                    self.assertAlmostEqual(f, e, delta=1e-5, msg=key)

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
        for key in ("mse", "relmse", "relmse_trimmed", "relmse_median", "flip"):
            self.assertEqual(found[key], 0)
        self.assertIsNone(found["psnr"])  # JSON has no infinity
        self.assertEqual(found["mean_ratio"], [1, 1, 1])
        self.assertEqual(found["decile_ratio"], [None] * 3 + [1] * 7)  # the sky is black
        self.assertIs(found["identical"], True)

    def test_more_samples_are_closer(self):
        better = self.rendered(
            "--resolution", "60x40", "--method", "uniform", "--spp", "16", "--seed", "3", output="better.exr"
        )
        near, far = self.compare(better, self.reference), self.compare(self.image, self.reference)
        for key in ("mse", "relmse", "relmse_trimmed", "relmse_median", "flip"):
            self.assertLess(near[key], far[key], key)
        self.assertGreater(near["psnr"], far["psnr"])

    def test_values_that_are_no_numbers_are_counted(self):
        values = array.array("f", [0.5] * (3 * 4 * 2))
        values[0], values[7] = math.nan, math.inf
        path = self.write("bad.pfm", f"PF\n4 2\n{1 if sys.byteorder == 'big' else -1}\n".encode() + values.tobytes())
        found = self.compare(path, path)
        self.assertEqual(found["nonfinite"], 2)
        self.assertEqual(found["mse"], 0)
        self.assertEqual(found["decile_ratio"], [None] * 9 + [1])  # a single block
        page = self.folder / "page.html"
        for image, is_told in ((path, True), (self.image, False)):
            self.run_program("compare", image, image, "--report", page)
            self.assertEqual("values that are not finite" in page.read_text(), is_told)

    def test_text_has_the_same_names(self):
        result = self.run_program("compare", self.image, self.reference)
        self.assertEqual(result.code, DONE, result)
        self.assertEqual({line.split()[0] for line in result.stdout.splitlines()}, KEYS)

    def test_groups_without_light_are_dashes(self):
        result = self.run_program("compare", self.image, self.image)
        line = next(line for line in result.stdout.splitlines() if line.startswith("decile_ratio"))
        self.assertEqual(line.split()[1:], ["-"] * 3 + ["1.00000"] * 7)  # the sky is black

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

    def test_images_and_films_have_nothing_to_choose(self):
        self.rendered("--checkpoint", "out.film", "--spp", "1")
        for option, value in (("--camera", "eye 0,0,0 target 1,0,0 fov 40"), ("--camera", "Front"), ("--gltf-scene", "1"), ("--animation", "none"), ("--variant", "1")):
            for file, kind in (("out.exr", "an image"), ("out.film", "a film")):
                self.assert_fails(self.run_program("info", file, option, value), USAGE, f"{option}: '{file}' is {kind}; expected a scene")


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
        self.assertAlmostEqual(stats["radiance"]["rays_per_path"], stats["radiance"]["rays"] / (3 * 24 * 16))
        self.assertGreater(stats["seconds"]["load"], 0)
        memory = stats["memory"]
        self.assertEqual(memory["meshes"], 4 * 12 + 2 * 12)  # the floor of TINY: positions and triangles
        self.assertGreater(memory["peak_resident"], memory["shapes"])

    def test_statistics_by_kind(self):
        stats = self.statistics("--spp", "4", "--cov-spp", "2")
        for one in (stats["covariance"], stats["radiance"]):
            kinds = [one[kind + "_rays"] for kind in ("camera", "bounce", "shadow")]
            self.assertEqual(sum(kinds), one["rays"])
            self.assertGreaterEqual(kinds[0], one["samples"])
            self.assertEqual(sum(one["path_lengths"]), one["samples"])
            counted = sum(length * paths for length, paths in enumerate(one["path_lengths"]))
            self.assertLessEqual(counted, one["vertices"])  # the last length stands for longer ones too
        self.assertLessEqual(sum(stats["memory"][kind] for kind in ("meshes", "shapes", "film")),
                             stats["memory"]["peak_resident"])
        for kind in ("embree", "textures", "prediction", "occluders"):
            self.assertGreaterEqual(stats["memory"][kind], 0)
        for phase in ("load", "build", "covariance", "radiance", "reconstruction", "write"):
            self.assertGreaterEqual(stats["seconds"][phase], 0)
        self.assertLessEqual(sum(stats["seconds"].values()), stats["seconds_total"])

    def test_covariance_paths_count(self):
        stats = self.statistics("--spp", "8", "--cov-spp", "3")
        self.assertEqual(stats["covariance"]["samples"], 3 * 24 * 16)
        self.assertGreater(stats["covariance"]["replay_thread_seconds"], 0)
        self.assertLess(stats["covariance"]["replay_thread_seconds"], stats["covariance"]["thread_seconds"])
        self.assertEqual(stats["radiance"]["replay_thread_seconds"], 0)
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
        keys = {"phase", "fraction", "spp", "error", "elapsed", "remaining", "samples_per_second"}
        for method in ("uniform", "covariance", "hybrid"):
            with self.subTest(method=method):
                *reports, last = [json.loads(line) for line in self.lines("json", method)]
                self.assertGreater(len(reports), 0)
                for report in reports:
                    self.assertEqual(set(report), keys)
                    self.assertTrue(0 <= report["fraction"] < 1, report)
                    self.assertIn(report["phase"], {"covariance", "radiance", "reconstruction"})
                elapsed = [r["elapsed"] for r in reports]
                self.assertEqual(elapsed, sorted(elapsed))
                self.assertEqual((last["phase"], last["fraction"], last["remaining"]), ("done", 1, 0))
                self.assertEqual(set(last), keys)
                self.assertAlmostEqual(last["spp"], 300, delta=1)

    def test_the_error_falls_as_samples_come(self):
        self.write("scene.pbrt", TINY)
        arguments = ["-o", "out.exr", "--method", "uniform", "--time", "2", "--resolution", "64x48", "--quiet"]
        result = self.run_program("render", "scene.pbrt", *arguments, "--progress", "json")
        self.assertEqual(result.code, DONE, result)
        reports = [json.loads(line) for line in result.stderr.splitlines()]
        known = [r for r in reports if r["error"] is not None]
        self.assertGreater(len(known), 1)
        self.assertLess(known[-1]["error"], known[0]["error"])
        # The error that was told last is about that of the raw samples in the file.
        image = exr.read(self.folder / "out.exr")
        n = len(image.pixels["R"])
        mean = sum(image.pixels["variance." + c][i] / (image.pixels["raw." + c][i] ** 2 + 0.01) for c in "RGB" for i in range(n)) / (3 * n)
        self.assertLess(math.sqrt(mean), 1.05 * known[-1]["error"])
        self.assertGreater(math.sqrt(mean), known[-1]["error"] / 2)  # rounds grow by half

    def test_hybrid_tells_the_error_that_is_asked_for(self):
        self.write("scene.pbrt", TINY)
        arguments = ["-o", "out.exr", "--error", "0.0001", "--time", "3", "--resolution", "64x48", "--quiet"]
        result = self.run_program("render", "scene.pbrt", *arguments, "--progress", "json")
        self.assertEqual(result.code, DONE, result)
        known = [r["error"] for r in map(json.loads, result.stderr.splitlines()) if r["error"] is not None]
        self.assertGreater(len(known), 1)
        self.assertLess(known[-1], known[0])
        # The error that was told last is about that of the delivered image's layer.
        image = exr.read(self.folder / "out.exr")
        brightness = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in zip(*(image.pixels[c] for c in "RGB"))]
        mean = sum(e**2 / (y**2 + 0.01) for e, y in zip(image.pixels["error.Y"], brightness)) / len(brightness)
        self.assertLess(math.sqrt(mean), 1.5 * known[-1])
        self.assertGreater(math.sqrt(mean), known[-1] / 4)  # rounds double; colours err in different directions

    def test_progress_of_a_render_until_an_error(self):
        self.write("scene.pbrt", TINY)
        for method, error in (("uniform", "0.002"), ("hybrid", "0.001")):
            with self.subTest(method=method):
                arguments = ["-o", "out.exr", "--method", method, "--error", error, "--resolution", "64x48", "--quiet"]
                result = self.run_program("render", "scene.pbrt", *arguments, "--progress", "json")
                self.assertEqual(result.code, DONE, result)
                fractions = [json.loads(line)["fraction"] for line in result.stderr.splitlines()]
                self.assertGreater(max(fractions[:-1]), 0.1)

    def test_percent(self):
        *lines, last = self.lines("percent")
        for line in lines:
            self.assertRegex(line, r"^\d{1,2}%$")
        self.assertEqual(last, "100%")

    def test_never_100_percent_without_a_file(self):
        self.write("scene.pbrt", TINY)
        scene = ["render", "scene.pbrt", "--progress", "percent", "--quiet", "-o", "out.exr"]
        (self.folder / "out.exr").mkdir()
        result = self.run_program(*scene, "--spp", "2")
        self.assertNotEqual(result.code, DONE)
        self.assertNotIn("100%", result.stderr)

    def test_plain(self):
        for line in self.lines("plain"):
            self.assertRegex(line, r"^\w+ +\d+% +\d+(\.\d{1,2})? spp")

    def test_bar_fits_the_terminal(self):
        for columns in (100, 40, 12):
            with self.subTest(columns=columns):
                text = self.on_terminal(columns, "--spp", "600", "--resolution", "64x48")
                drawn = [part.replace("\x1b[K", "") for part in text.split("\r")]
                bars = [part for part in drawn if "%" in part]
                self.assertGreater(len(bars), 1)
                for bar in bars:
                    self.assertLess(len(bar), columns, bar)
                    self.assertNotIn("100%", bar)
                if columns == 100:
                    for text in ("elapsed", "spp", "#", "."):
                        self.assertIn(text, bars[-1])
                # The bar is gone before the line that stays.
                self.assertRegex(drawn[-1] if drawn[-1].strip() else drawn[-2], r"^out\.exr: 600 samples per pixel")

    def on_terminal(self, columns, *arguments):
        """Standard error of a render, as a terminal gets it."""
        self.write("scene.pbrt", TINY)
        master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        command = [PROGRAM, "render", "scene.pbrt", "-o", "out.exr", *arguments]
        process = subprocess.Popen(command, cwd=self.folder, stderr=slave)
        os.close(slave)
        text = b""
        try:
            while part := os.read(master, 4096):
                text += part
        except OSError:  # the terminal's other end is closed
            pass
        os.close(master)
        self.assertEqual(process.wait(60), DONE)
        return text.decode()

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
