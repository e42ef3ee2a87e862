"""The name of an image says its format."""

import array
import json
import sys
import unittest

import exr
from support import DONE, TINY, USAGE, CliTest

LONG = ["--spp", "1000000"]
SPP = ["--method", "uniform", "--spp", "4", "--reproducible"]
MAGIC = {".exr": b"\x76\x2f\x31\x01", ".png": b"\x89PNG\r\n\x1a\n", ".pfm": b"PF\n", ".hdr": b"#?RADIANCE\n"}


class Formats(CliTest):
    def relmse(self, image, reference):
        result = self.run_program("compare", image, reference, "--json")
        self.assertEqual(result.code, DONE, result)
        return json.loads(result.stdout)["relmse"]

    def test_the_bytes_are_what_the_name_says(self):
        for ending, magic in MAGIC.items():
            for name in (f"out{ending}", f"OUT{ending.upper()}"):
                with self.subTest(name=name):
                    image = self.rendered(*SPP, output=name)
                    self.assertTrue(image.read_bytes().startswith(magic))

    def test_no_ending_is_an_exr(self):
        exr.read(self.rendered(*SPP, output="image"))

    def test_others_are_refused(self):
        for name in ("out.jpg", "out.jpeg", "out.tif", "out.tga", "out.exr.bak", "out.0001", "out.html"):
            with self.subTest(name=name):
                result = self.render(TINY, *LONG, output=name, timeout=10)
                self.assert_fails(result, USAGE, "--output", name, ".exr", ".png", ".pfm", ".hdr")
                self.assert_no_file(name)

    def test_png_is_a_png(self):
        for name in ("out.exr", "out.jpg", "out.hdr"):
            with self.subTest(name=name):
                result = self.render(TINY, *LONG, "--png", name, output="image.exr", timeout=10)
                self.assert_fails(result, USAGE, "--png", name, ".png")
        self.rendered(*SPP, "--png", "picture")
        self.assertTrue((self.folder / "picture").read_bytes().startswith(MAGIC[".png"]))

    def test_other_formats_hold_no_layers(self):
        result = self.render(TINY, *LONG, "--layers", "albedo", output="out.png", timeout=10)
        self.assert_fails(result, USAGE, "out.png", "'albedo'", ".exr")
        self.rendered(*SPP, "--layers", "none", output="out.png")

    @unittest.skipIf(sys.byteorder == "big", "reads little-endian values")
    def test_pfm_has_every_bit(self):
        crop = ["--crop", "3,2,20,15"]
        image = exr.read(self.rendered(*SPP, *crop))
        header, size, scale, values = self.rendered(*SPP, *crop, output="out.pfm").read_bytes().split(b"\n", 3)
        self.assertEqual((header, size, float(scale)), (b"PF", b"17 13", -1))
        values = array.array("f", values)
        self.assertEqual(len(values), 17 * 13 * 3)
        for y in range(13):
            for x in range(17):
                for c in range(3):
                    self.assertEqual(values[((12 - y) * 17 + x) * 3 + c], image.pixels["RGB"[c]][y * 17 + x])
        self.rendered(*SPP)
        self.rendered(*SPP, output="out.pfm")
        self.assertEqual(self.relmse("out.pfm", "out.exr"), 0)

    def test_hdr_is_close(self):
        self.rendered(*SPP)
        self.rendered(*SPP, output="out.hdr")
        self.assertLess(self.relmse("out.hdr", "out.exr"), 0.004**2)

    def test_png_of_either_option_is_the_same(self):
        self.rendered(*SPP, "--png", "a.png")
        self.rendered(*SPP, output="b.png")
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())

    def test_layer_names_change_no_picture(self):
        self.rendered(*SPP, "--png", "a.png")
        self.rendered(*SPP, "--png", "b.png", "--layer-names", "blender")
        self.assertIn("ViewLayer.Combined.R", exr.read(self.folder / "out.exr").channels)
        self.rendered(*SPP, "--layer-names", "blender", output="c.png")
        for name in ("b.png", "c.png"):
            self.assertEqual((self.folder / name).read_bytes(), (self.folder / "a.png").read_bytes())

    def test_merge(self):
        self.rendered(*SPP, "--film", "a.film", "--png", "a.png")
        for name, magic in (("m.png", ".png"), ("m.pfm", ".pfm"), ("m.hdr", ".hdr")):
            with self.subTest(name=name):
                result = self.run_program("merge", "a.film", "-o", name)
                self.assertEqual(result.code, DONE, result)
                self.assertTrue((self.folder / name).read_bytes().startswith(MAGIC[magic]))
        self.assertEqual((self.folder / "m.png").read_bytes(), (self.folder / "a.png").read_bytes())
        self.assert_fails(self.run_program("merge", "a.film", "-o", "m.jpg"), USAGE, "m.jpg", ".pfm")
        self.assert_fails(self.run_program("merge", "a.film", "--png", "m.exr"), USAGE, "--png", "m.exr")
        self.assert_no_file("m.jpg")

    def test_a_report_is_no_image(self):
        self.rendered(*SPP)
        before = (self.folder / "out.exr").read_bytes()
        for name in ("r.exr", "r.PNG", "r.hdr", "r.jpg", "r.JPEG", "r.tga", "r.qoi", "r.ppm", "r.webp"):
            for command in (["compare", "out.exr", "out.exr"], ["inspect", "out.exr"]):
                with self.subTest(name=name, command=command[0]):
                    self.assert_fails(self.run_program(*command, "--report", name), USAGE, "--report", name, ".html")
                    self.assert_no_file(name)
        self.assertEqual((self.folder / "out.exr").read_bytes(), before)


class Read(CliTest):
    def test_compare_reads_what_is_written(self):
        """Reading includes narrow images, whose rows in Radiance files have no run lengths."""
        for size in ("1x3", "7x5", "9x4", "200x3"):
            for ending in (".pfm", ".hdr", ".png"):
                with self.subTest(size=size, ending=ending):
                    self.rendered(*SPP, "--resolution", size)
                    self.rendered(*SPP, "--resolution", size, output=f"out{ending}")
                    result = self.run_program("compare", f"out{ending}", "out.exr", "--json")
                    self.assertEqual(result.code, DONE, result)
                    if ending != ".png":  # PNG is cut at white
                        self.assertLess(json.loads(result.stdout)["relmse"], 1e-4)


if __name__ == "__main__":
    unittest.main()
