"""Images in less memory: the option --texture-memory changes no pixel."""

import json
import os
import random
import subprocess
import unittest

from films import METHODS, SCENES, FilmTest
from support import DONE, IO

SIDE = 256
ALL = 3 * sum(4**k for k in range(9))  # bytes of all levels
TEXTURED = SCENES["moving"].replace(
    'Material "diffuse" "rgb reflectance" [.5 .4 .3]',
    'Texture "noise" "spectrum" "imagemap" "string filename" "noise.ppm"\nMaterial "diffuse" "texture reflectance" "noise"',
)


class TextureMemory(FilmTest):
    def setUp(self):
        super().setUp()
        self.write("noise.ppm", b"P6\n%d %d\n255\n" % (SIDE, SIDE) + random.Random(1).randbytes(3 * SIDE * SIDE))
        self.write("textured.pbrt", TEXTURED)

    def test_the_image_is_the_same(self):
        for method in METHODS:
            self.run_render("textured", method, "--spp", "4", output="whole.exr")
            for bound, threads in (("102400", 1), ("102400", 3), ("16384", 2), ("1", 2)):
                with self.subTest(method=method, bound=bound, threads=threads):
                    result = self.run_render("textured", method, "--spp", "4", "--texture-memory", bound, "--threads", threads)
                    self.assertIn(f"textures take {ALL} bytes", result.stderr)
                    self.assert_identical("whole.exr", "out.exr")

    def test_what_is_in_memory(self):
        self.run_render("textured", "uniform", "--spp", "1", "--stats", "whole.json")
        result = self.run_render("textured", "uniform", "--spp", "1", "--texture-memory", "102400", "--stats", "paged.json")
        self.assertEqual(result.stderr.count("warning"), 1, result)
        whole, paged = (json.loads((self.folder / f"{name}.json").read_text())["memory"]["textures"] for name in ("whole", "paged"))
        self.assertEqual(whole, ALL)
        self.assertLessEqual(paged, 100 * 1024)

    def test_the_spectra_of_textures_count(self):
        for method in ("covariance", "hybrid"):
            self.run_render("textured", method, "--spp", "2", "--stats", "stats.json")
            memory = json.loads((self.folder / "stats.json").read_text())["memory"]
            self.assertGreater(memory["textures"], ALL + 4 * SIDE * SIDE)  # a float for each texel at least
            self.assertNotIn("spectra", memory)

    def test_a_film_goes_on_under_another_bound(self):
        self.run_render("textured", "hybrid", "--spp", "8", output="whole.exr")
        film = ["--checkpoint", "t.film", "--resume"]
        self.run_render("textured", "hybrid", "--spp", "4", *film)
        self.run_render("textured", "hybrid", "--spp", "8", *film, output="resumed.exr")
        self.run_render("textured", "hybrid", "--spp", "4", "--checkpoint", "p.film", "--texture-memory", "50000")
        self.run_render("textured", "hybrid", "--spp", "8", "--checkpoint", "p.film", "--resume")
        self.assert_identical("resumed.exr", "out.exr")

    def test_a_folder_that_cannot_be_written(self):
        for folder in (str(self.folder / "missing"), "/dev/null"):
            with self.subTest(folder=folder):
                pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
                result = self.run_program("render", "textured.pbrt", "-o", "out.exr", "--texture-memory", "50000", "--progress", "none",
                                          env={**os.environ, "TMPDIR": folder}, **pipes)
                self.assert_fails(result, IO, "temporary file of textures", folder)
                self.assert_no_file()

    def test_nothing_is_left(self):
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        (self.folder / "scratch").mkdir()
        result = self.run_program("render", "textured.pbrt", "-o", "out.exr", "--spp", "1", "--texture-memory", "50000", "--progress", "none",
                                  env={**os.environ, "TMPDIR": str(self.folder / "scratch")}, **pipes)
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(list((self.folder / "scratch").iterdir()), [])


if __name__ == "__main__":
    unittest.main()
