"""Layer names of other renderers, read by our own reader, by inspect and by OpenImageIO's oiiotool."""

import json
import re
import subprocess
import unittest

import exr
from support import DONE, USAGE, TINY, CliTest


class LayerNames(CliTest):
    def setUp(self):
        super().setUp()
        self.plain = exr.read(self.rendered("--spp", "4", output="default.exr"))

    def channels(self, names):
        return set(exr.read(self.rendered("--spp", "4", "--layer-names", names, output=f"{names}.exr")).channels)

    def test_default(self):
        self.assertEqual(self.channels("default"), set(self.plain.channels))

    def test_pbrt(self):
        found = self.channels("pbrt")
        for name in "R G B Albedo.R Albedo.G Albedo.B Ns.X Ns.Y Ns.Z Variance.R Variance.G Variance.B".split():
            self.assertIn(name, found)
        self.assertEqual(len(found), len(self.plain.channels))
        self.assertFalse({n for n in found if n.startswith(("albedo", "N.", "variance"))})

    def test_blender(self):
        found = self.channels("blender")
        for name in (
            "Combined.R Combined.G Combined.B Combined.A Depth.Z|Denoising Albedo.R|Denoising Normal.X|Noisy Image.B|"
            "Debug Sample Count.X|error.X|filter.Z|cov 04.X"
        ).replace(" Combined", "|Combined").replace(" Depth", "|Depth").split("|"):
            self.assertIn("ViewLayer." + name, found)
        self.assertEqual(len(found), len(self.plain.channels))
        for name in found:  # layer.pass.channel, one letter: what Blender splits
            self.assertRegex(name, r"^ViewLayer\.[^.]+\.[A-Z]$")

    def test_inspect_knows_them(self):
        def inspect(file):
            result = self.run_program("inspect", file, "--pixel", "12,9", "--json")
            self.assertEqual(result.code, DONE, result)
            found = json.loads(result.stdout)
            return found["pixel"], found["samples"]

        expected = inspect("default.exr")
        for names in ("pbrt", "blender"):
            self.channels(names)
            self.assertEqual(inspect(f"{names}.exr"), expected)

    def test_compare_finds_the_colour(self):
        self.channels("blender")
        result = self.run_program("compare", "blender.exr", "default.exr", "--json")
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(json.loads(result.stdout)["mse"], 0)

    def test_oiiotool_reads_every_layer(self):
        for names in ("default", "pbrt", "blender"):
            ours = self.channels(names)
            text = subprocess.run(["oiiotool", "--stats", "-v", f"{names}.exr"], cwd=self.folder, capture_output=True, text=True, check=True).stdout
            line = re.search(r"channel list: (.*)", text).group(1)
            self.assertEqual({c.strip().removesuffix(" (float)") for c in line.split(",")}, ours)
        # Compare the values of one layer, as oiiotool writes them
        subprocess.run(["oiiotool", "blender.exr", "--ch", "ViewLayer.Noisy Image.R,ViewLayer.Noisy Image.G,ViewLayer.Noisy Image.B", "--chnames", "R,G,B", "-d", "float", "--compression", "zip", "-o", "raw.exr"], cwd=self.folder, check=True)
        raw = exr.read(self.folder / "raw.exr")
        for c in "RGB":
            self.assertEqual(raw.pixels[c], self.plain.pixels["raw." + c])

    def test_unknown_names(self):
        self.assert_fails(self.render(TINY, "--layer-names", "maya"), USAGE, "--layer-names", "maya")


if __name__ == "__main__":
    unittest.main()
