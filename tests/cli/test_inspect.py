"""inspect: the summary of an image and all about a pixel; the pages of inspect and compare."""

import json
import math
import re
import unittest

import exr
from support import DONE, INTERRUPTED, IO, SCENE, TINY, USAGE, CliTest

ENTRIES = [f"{i}{j}" for i in range(5) for j in range(i, 5)]


def determinant(matrix):
    if len(matrix) == 1:
        return matrix[0][0]
    minors = ([row[:i] + row[i + 1 :] for row in matrix[1:]] for i in range(len(matrix)))
    return sum((-1) ** i * matrix[0][i] * determinant(minor) for i, minor in enumerate(minors))


class Inspect(CliTest):
    def setUp(self):
        super().setUp()
        self.image = exr.read(self.rendered("--spp", "8", "--resolution", "40x30"))

    def inspect(self, *arguments, image="out.exr"):
        result = self.run_program("inspect", image, *arguments, "--json")
        self.assertEqual((result.code, result.stderr), (DONE, ""), result)
        return json.loads(result.stdout)

    def value(self, channel, x, y):
        return self.image.pixels[channel][y * self.image.width + x]

    def test_summary(self):
        found = self.inspect()
        self.assertEqual((found["width"], found["height"], found["nonfinite"]), (40, 30, 0))
        samples = self.image.pixels["samples.Y"]
        self.assertEqual(found["samples"]["least"], min(samples))
        self.assertEqual(found["samples"]["most"], max(samples))
        self.assertAlmostEqual(found["samples"]["mean"], sum(samples) / len(samples), places=6)
        self.assertEqual(found["metadata"]["covtrace:method"], "hybrid")
        self.assertEqual(set(found["channels"]), set(self.image.channels))

        relative = [
            self.value("error.Y", x, y)
            / math.sqrt((0.2126 * self.value("R", x, y) + 0.7152 * self.value("G", x, y) + 0.0722 * self.value("B", x, y)) ** 2 + 0.01)
            for y in range(30)
            for x in range(40)
        ]
        self.assertAlmostEqual(found["estimated_error"], math.sqrt(sum(r * r for r in relative) / 1200), delta=1e-4)
        worst = found["most_uncertain"][0]
        self.assertEqual(relative.index(max(relative)), worst["y"] * 40 + worst["x"])

    def test_summary_for_people(self):
        result = self.run_program("inspect", "out.exr")
        self.assertEqual((result.code, result.stderr), (DONE, ""), result)
        for text in ("8 samples per pixel", "filter width", "standard error", "--pixel", "40x30"):
            self.assertIn(text, result.stdout)

    def test_pixel(self):
        x, y = 21, 17
        pixel = self.inspect("--pixel", f"{x},{y}")["pixel"]
        self.assertEqual((pixel["x"], pixel["y"]), (x, y))
        self.assertEqual(pixel["samples"], self.value("samples.Y", x, y))
        for k, entry in enumerate(ENTRIES):
            i, j = int(entry[0]), int(entry[1])
            self.assertAlmostEqual(pixel["covariance"][i][j], self.value(f"cov.{entry}", x, y), delta=1e-6 * abs(self.value(f"cov.{entry}", x, y)))
            self.assertEqual(pixel["covariance"][i][j], pixel["covariance"][j][i])
        scale = [1, 1, 2, 2, 1]  # the aperture is two radii wide
        units = ["cycles/pixel"] * 2 + ["cycles/aperture"] * 2 + ["cycles/shutter"]
        for k, axis in enumerate(pixel["bandwidth"]):
            self.assertAlmostEqual(axis["value"], scale[k] * math.sqrt(self.value(f"cov.{k}{k}", x, y)), delta=1e-5)
            self.assertEqual(axis["unit"], units[k])
        xx, xy, yy = (self.value(f"filter.{c}", x, y) for c in ("xx", "xy", "yy"))
        f = pixel["filter"]
        # The matrix from its axes: the angle counts against the y that points down.
        c, s = math.cos(math.radians(f["angle_degrees"])), -math.sin(math.radians(f["angle_degrees"]))
        a, b = f["major"] ** 2, f["minor"] ** 2
        for found, expected in ((a * c * c + b * s * s, xx), ((a - b) * c * s, xy), (a * s * s + b * c * c, yy)):
            self.assertAlmostEqual(found, expected, places=5)

    def test_count_of_the_hypercube(self):
        self.image = exr.read(self.rendered("--method", "covariance", "--density", "thesis", "--spp", "6", "--resolution", "40x30"))
        k = self.image.value("covtrace:k")
        window = [0, 0, 1 / math.pi**2, 1 / math.pi**2, 3 / math.pi**2]
        for x, y in ((21, 17), (5, 25)):
            found = self.inspect("--pixel", f"{x},{y}")["pixel"]
            matrix = [[v + (window[i] if i == j else 0) for j, v in enumerate(row)] for i, row in enumerate(found["covariance"])]
            # Per aperture: pi lens radii squared.
            expected = math.pi * math.sqrt(max(0, determinant(matrix)))
            self.assertAlmostEqual(found["hypercube"]["density"], expected, delta=1e-3 * expected + 1e-6)
            self.assertAlmostEqual(found["hypercube"]["k"] / float(k), 1, places=4)
            self.assertAlmostEqual(found["hypercube"]["samples"], found["hypercube"]["k"] * found["hypercube"]["density"], places=6)
        text = self.run_program("inspect", "out.exr", "--pixel", "21,17").stdout
        told = re.search(r"samples per unit hypercube .*: pi sqrt\|S \+ W\| = (\S+), times k = (\S+): (\S+)\n", text)
        self.assertIsNotNone(told, text)
        found = self.inspect("--pixel", "21,17")["pixel"]
        for text, name in zip(told.groups(), ("density", "k", "samples")):
            self.assertAlmostEqual(float(text) / found["hypercube"][name], 1, places=3)
        # The matrix that is printed below counts per lens radius, bandwidths over the aperture: two radii.
        bandwidth = {b["axis"]: b["value"] for b in found["bandwidth"]}
        self.assertAlmostEqual(bandwidth["lens x"], 2 * math.sqrt(found["covariance"][2][2]), places=4)
        self.rendered("--spp", "6", "--resolution", "40x30")
        self.assertEqual(set(self.inspect("--pixel", "21,17")["pixel"]["hypercube"]), {"density"})

    def relative_error(self, x, y):
        light = 0.2126 * self.value("R", x, y) + 0.7152 * self.value("G", x, y) + 0.0722 * self.value("B", x, y)
        return self.value("error.Y", x, y) / math.sqrt(light**2 + 0.01)

    def test_certainty_of_a_pixel(self):
        whole = self.inspect()["estimated_error"]
        places = [(x, y) for y in range(30) for x in range(40)]
        for x, y in (max(places, key=lambda p: self.relative_error(*p)), min(places, key=lambda p: self.relative_error(*p))):
            found = self.inspect("--pixel", f"{x},{y}")["pixel"]
            relative = self.relative_error(x, y)
            self.assertAlmostEqual(found["relative_error"] / relative, 1, places=4)
            self.assertAlmostEqual(found["samples_factor"] / max(1, (relative / whole) ** 2), 1, places=3)
            self.assertIn(" times the samples would" if relative > whole else "no more than the image's", found["sentence"])
            self.assertIn(found["sentence"], self.run_program("inspect", "out.exr", "--pixel", f"{x},{y}").stdout)
        worst = self.inspect()["most_uncertain"][0]
        self.assertIn(worst["sentence"], self.run_program("inspect", "out.exr").stdout)

    def test_pixels_without_samples(self):
        self.image = exr.read(self.rendered("--spp", "0.5", "--cov-spp", "0.5", "--resolution", "40x30"))
        empty = self.image.pixels["samples.Y"].index(0)
        found = self.inspect("--pixel", f"{empty % 40},{empty // 40}")["pixel"]
        self.assertIn("no sample was taken here", found["sentence"])

    def test_causes(self):
        """A lens and a shutter that blur a wall of squares, and a spot of light that paths meet by chance alone."""
        wall = """WorldBegin
Texture "squares" "spectrum" "checkerboard" "float uscale" 40 "float vscale" 40
LightSource "infinite" "rgb L" [1 1 1]
Material "diffuse" "texture reflectance" "squares"
{}
Shape "bilinearmesh" "point3 P" [-2 -2 0  2 -2 0  -2 2 0  2 2 0]
"""
        lens = 'Camera "perspective" "float fov" 40 "float lensradius" 0.5 "float focaldistance" 2\n'
        shutter = 'Camera "perspective" "float fov" 40\n'
        moving = "ActiveTransform EndTime\nTranslate 1 0 0\nActiveTransform All"
        film = 'LookAt 0 0 5 0 0 0 0 1 0\nFilm "rgb" "integer xresolution" 24 "integer yresolution" 24\n'
        # Floor and ceiling, and on the ceiling a small spot of light, which alone lights the floor
        rare = """WorldBegin
LightSource "spot" "rgb I" [1000 1000 1000] "point3 from" [0 0 0.1] "point3 to" [0 0 1] "float coneangle" 4 "float conedeltaangle" 1
Material "diffuse"
Shape "bilinearmesh" "point3 P" [-2 -2 0  2 -2 0  -2 2 0  2 2 0]
Shape "bilinearmesh" "point3 P" [-2 -2 1  2 -2 1  -2 2 1  2 2 1]
"""
        for text, cause in ((lens + film + wall.format(""), "out of focus: "), (shutter + film + wall.format(moving), "in motion: "),
                            (shutter + film.replace("0 0 5", "0 0 0.9") + rare, "rare paths (single samples vary by ")):
            lines = text.splitlines(keepends=True)
            self.write("cause.pbrt", "".join(sorted(lines[:3], key=lambda line: line[0] != "L")) + "".join(lines[3:]))
            self.assertEqual(self.run_program("render", "cause.pbrt", "-o", "out.exr", "--spp", "16", "--quiet").code, DONE)
            sentences = [self.inspect("--pixel", f"{x},{y}")["pixel"]["sentence"] for x in (6, 12, 18) for y in (6, 12, 18)]
            self.assertGreater(sum(s.startswith(cause) for s in sentences), 4, sentences)

    def test_shares_of_the_candidates(self):
        self.assertNotIn("shares", self.inspect("--pixel", "21,17")["pixel"])
        self.image = exr.read(self.rendered("--spp", "8", "--resolution", "40x30", "--layers", "all,share"))
        for x, y in ((21, 17), (5, 25)):
            shares = self.inspect("--pixel", f"{x},{y}")["pixel"]["shares"]
            self.assertEqual(set(shares), {"raw", "gaussian", "regression", "denoiser"})
            self.assertAlmostEqual(sum(shares.values()), 1, places=4)
            for kind, share in shares.items():
                self.assertAlmostEqual(share, self.value(f"share.{kind}", x, y), places=6)
        self.rendered("--spp", "8", "--resolution", "40x30", "--denoiser", "none", "--layers", "all,share")
        without = self.inspect("--pixel", "21,17")["pixel"]["shares"]
        self.assertEqual(without["denoiser"], 0)
        self.assertIn("0 % the denoiser", self.run_program("inspect", "out.exr", "--pixel", "21,17").stdout)
        self.rendered("--method", "covariance", "--spp", "8", "--resolution", "40x30", "--layers", "share")
        self.assertNotIn("shares", self.inspect("--pixel", "21,17")["pixel"])

    def test_pixel_for_people(self):
        result = self.run_program("inspect", "out.exr", "--pixel", "21,17")
        self.assertEqual((result.code, result.stderr), (DONE, ""), result)
        for text in ("pixel 21,17", "cycles/aperture", "while the shutter is open", "filter: a Gaussian", "covariance of the spectrum"):
            self.assertIn(text, result.stdout)

    def test_crop_keeps_coordinates(self):
        found = self.inspect("--crop", "10,5,20,25", "--pixel", "12,8")
        self.assertEqual((found["width"], found["height"]), (10, 20))
        self.assertAlmostEqual(found["pixel"]["values"]["R"], self.value("R", 12, 8), places=6)

    def test_plain_pictures(self):
        self.rendered("--png", "out.png")
        found = self.inspect("--pixel", "1,2", image="out.png")
        self.assertEqual(set(found["pixel"]["values"]), {"R", "G", "B"})
        self.assertNotIn("covariance", found["pixel"])
        self.assertNotIn("samples", found)

    def test_wrong_command_lines(self):
        for pixel in ("40,0", "0,30", "-1,0"):
            self.assert_fails(self.run_program("inspect", "out.exr", f"--pixel={pixel}"), USAGE, "--pixel")
        for pixel in ("1", "1,2,3", "a,b", "1.5,2", ""):
            self.assert_fails(self.run_program("inspect", "out.exr", f"--pixel={pixel}"), USAGE, "--pixel")
        self.assert_fails(self.run_program("inspect", "out.exr", "--crop", "50,0,60,9"), USAGE, "--crop")
        self.assert_fails(self.run_program("inspect", "missing.exr"), SCENE, "missing.exr")


class Pages(CliTest):
    def setUp(self):
        super().setUp()
        self.rendered("--spp", "2", output="a.exr")
        self.rendered("--spp", "2", "--seed", "3", output="b.exr")

    def test_pages_are_whole_and_alone(self):
        for arguments in (["inspect", "a.exr"], ["compare", "a.exr", "b.exr"]):
            with self.subTest(command=arguments[0]):
                result = self.run_program(*arguments, "--report", "page.html")
                self.assertEqual((result.code, result.stderr), (DONE, ""), result)
                page = (self.folder / "page.html").read_text()
                self.assertTrue(page.startswith("<!doctype html>") and page.rstrip().endswith("</html>"))
                self.assertIn("default-src 'none'", page)
                self.assertNotRegex(page, r"""(src|href)\s*=|@import|url\(|https?://""")
                self.assert_no_leftovers()

    def test_pages_tell_how_the_image_was_made_and_that_it_is_not_complete(self):
        self.render(TINY, "--method", "uniform", "--spp", "2", "--shard", "1/2", "--film", "half.film", output=None)
        self.assertEqual(self.run_program("merge", "half.film", "-o", "half.exr").code, INTERRUPTED)
        for image, is_complete in (("a.exr", True), ("half.exr", False)):
            self.run_program("inspect", image, "--report", "page.html")
            page = (self.folder / "page.html").read_text()
            self.assertRegex(page, r'\["made by","covtrace [0-9.]+, method (hybrid|uniform)')
            self.assertEqual("not complete" in page, not is_complete)

    def test_json_stays_alone_on_stdout(self):
        result = self.run_program("compare", "a.exr", "b.exr", "--json", "--report", "page.html")
        self.assertIn("relmse", json.loads(result.stdout))

    def test_measures_of_the_dark(self):
        result = self.run_program("compare", "a.exr", "a.exr", "--report", "page.html")
        self.assertEqual(result.code, DONE, result)
        page = (self.folder / "page.html").read_text()
        self.assertIn('["relMSE at the median\'s exposure","0"]', page)
        self.assertRegex(page, r'\["mean A / mean B by brightness, darkest first","(1|-)( (1|-)){9}"\]')

    def test_a_part(self):
        result = self.run_program("compare", "a.exr", "b.exr", "--crop", "4,2,12,10", "--report", "page.html")
        self.assertEqual(result.code, DONE, result)
        self.assertIn('"width":8', (self.folder / "page.html").read_text())

    def test_cannot_be_written(self):
        for arguments in (["inspect", "a.exr"], ["compare", "a.exr", "b.exr"]):
            result = self.run_program(*arguments, "--report", "nowhere/page.html")
            self.assertEqual(result.code, IO, result)
            self.assertIn("nowhere/page.html", result.stderr)


if __name__ == "__main__":
    unittest.main()
