"""`denoise` on files that pbrt-v4, Mitsuba and Cycles wrote (tests/foreign), as they are and as other tools write them again."""

import math
import pathlib
import re
import shutil
import subprocess
import unittest

import exr
from support import DONE, CliTest, warnings_of

RENDERS = pathlib.Path(__file__).parents[1] / "foreign"
# The part that denoise may leave of the relMSE of the mean of both renders; it leaves 0.43 to 0.58.
MOST = 0.65


class ForeignRenders(CliTest):
    def relative_error(self, image, reference):
        result = self.run_program("compare", image, RENDERS / f"{reference}-reference.exr")
        self.assertEqual(result.code, DONE, result)
        return float(re.search(r"^relmse +(\S+)", result.stdout, re.M)[1])

    def denoised(self, *files):
        """The image of two files, or of one with its variance, whose layers are found without options, and its told error."""
        result = self.run_program("denoise", *files, "-o", "out.exr", "--denoiser", "none")
        self.assertEqual((result.code, result.stdout, warnings_of(result)), (DONE, "", []), result)
        return exr.read(self.folder / "out.exr"), float(re.search(r"^estimated error (\S+),", result.stderr)[1])

    def raw_of(self, image):
        exr.write(self.folder / "raw.exr", image.width, image.height, {c: image.pixels[f"raw.{c}"] for c in "RGB"}, {})
        return "raw.exr"

    def assert_cleaner(self, first, second, reference):
        image, told = self.denoised(first, second)
        error = self.relative_error("out.exr", reference)
        self.assertLess(error, MOST * self.relative_error(self.raw_of(image), reference))
        self.assertLess(abs(math.log(told / math.sqrt(error))), math.log(1.5))
        self.assertGreater(min(image.pixels["error.Y"]), 0)
        return image

    def test_mitsuba(self):
        image = self.assert_cleaner(RENDERS / "mitsuba-1.exr", RENDERS / "mitsuba-2.exr", "mitsuba")
        self.assertEqual(image.data_window, (0, 0, 48, 32))

    def test_pbrt(self):
        # The film "gbuffer": passes beside the colours, variances that belong to one render alone.
        image = self.assert_cleaner(RENDERS / "pbrt-1.exr", RENDERS / "pbrt-2.exr", "pbrt")
        self.assertEqual(image.value("spp"), 8)
        # The variance of one render of four samples is known badly, and so is what is noise: 0.79 of the error is left.
        one, _ = self.denoised(RENDERS / "pbrt-1.exr")
        self.assertEqual(one.value("spp"), 4)
        self.assertLess(self.relative_error("out.exr", "pbrt"), 0.9 * self.relative_error(self.raw_of(one), "pbrt"))

    def test_cycles(self):
        image = self.assert_cleaner(RENDERS / "cycles-1.exr", RENDERS / "cycles-2.exr", "cycles")
        self.assertEqual(image.value("spp"), 4)
        self.assertEqual((min(image.pixels["A"]), max(image.pixels["A"])), (0, 1))  # a transparent background

    def test_cycles_that_is_denoised_already(self):
        image = self.assert_cleaner(RENDERS / "cycles-denoised-1.exr", RENDERS / "cycles-denoised-2.exr", "cycles")
        self.assertEqual(image.value("spp"), 4)  # by the counts of its pixels

    def written_again(self, *arguments):
        """Mitsuba's files as OpenImageIO writes them with these arguments."""
        self.assertIsNotNone(shutil.which("oiiotool"), "openimageio-tools is missing: scripts/install-dependencies")
        for k in (1, 2):
            subprocess.run(["oiiotool", RENDERS / f"mitsuba-{k}.exr", *arguments, "-o", f"{k}.exr"], cwd=self.folder, check=True)
        return "1.exr", "2.exr"

    def test_compressions(self):
        expected, _ = self.denoised(RENDERS / "mitsuba-1.exr", RENDERS / "mitsuba-2.exr")
        for arguments in (("--compression", "zips"), ("--compression", "rle"), ("--compression", "none"), ("-d", "float"),
                          ("--tile", "16", "16")):
            with self.subTest(arguments):
                self.assertEqual(self.denoised(*self.written_again(*arguments))[0].pixels, expected.pixels)
        for lossy in ("dwaa", "dwab", "b44a"):
            with self.subTest(lossy):
                self.assert_cleaner(*self.written_again("--compression", lossy), "mitsuba")

    def test_a_data_window_within_the_frame(self):
        image, _ = self.denoised(*self.written_again("--crop", "40x20+4+6"))
        self.assertEqual((image.data_window, image.display_window), ((4, 6, 44, 26), (0, 0, 48, 32)))

    def test_passes_in_parts_of_their_own(self):
        passes = {"Combined": "RGBA", "Denoising Albedo": "RGB", "Denoising Normal": "XYZ", "Denoising Depth": "Z"}
        for k in (1, 2):
            command = ["oiiotool"]
            for name, letters in passes.items():
                channels = ",".join(f"{c}=ViewLayer.{name}.{c}" for c in letters)
                command += [RENDERS / f"cycles-{k}.exr", "--ch", channels, "--attrib", "oiio:subimagename", f"ViewLayer.{name}"]
            command += ["--siappend"] * (len(passes) - 1) + ["-o", f"{k}.exr"]
            subprocess.run(command, cwd=self.folder, check=True)
        self.assert_cleaner("1.exr", "2.exr", "cycles")

    def test_parts_with_windows_of_their_own(self):
        def denoised(name, window):
            for k in (1, 2):
                passes = [[RENDERS / f"mitsuba-{k}.exr", "--ch", channels, "--attrib", "oiio:subimagename", part]
                          for part, channels in (("beauty", "R,G,B,nn.X,nn.Y,nn.Z,dd.T"), ("albedo", "R=albedo.R,G=albedo.G,B=albedo.B"))]
                command = ["oiiotool", *passes[0], *passes[1], *window, "--siappend", "-o", f"{name}{k}.exr"]
                subprocess.run(command, cwd=self.folder, check=True)
            return self.denoised(f"{name}1.exr", f"{name}2.exr")[0]

        cut, whole = denoised("cut", ["--crop", "40x20+4+6"]), denoised("whole", ["--crop", "40x20+4+6", "--croptofull"])
        self.assertEqual(cut.data_window, (0, 0, 48, 32))
        self.assertEqual(cut.pixels, whole.pixels)


if __name__ == "__main__":
    unittest.main()
