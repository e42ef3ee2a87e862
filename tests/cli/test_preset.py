"""--preset: names for bundles of options, which options that are given override."""

import json
import unittest

import exr
from support import DONE, TINY, USAGE, CliTest

DEEP = TINY.replace('"integer maxdepth" 4', '"integer maxdepth" 20')


class Presets(CliTest):
    def spp(self, *arguments, scene=TINY):
        return exr.read(self.rendered("--method", "uniform", *arguments, scene=scene)).value("spp")

    def same(self, a, b, scene=DEEP):
        images = [self.rendered("--method", "uniform", *x, output=f"{i}.exr", scene=scene) for i, x in enumerate((a, b))]
        return json.loads(self.run_program("compare", *images, "--json").stdout)["identical"]

    def test_samples(self):
        self.assertEqual([self.spp("--preset", p) for p in ("draft", "preview", "final")], [4, 32, 512])
        self.assertEqual(self.spp("--preset", "final", "--spp", "2"), 2)
        self.assertEqual(self.spp("--spp", "2", "--preset", "draft"), 2)
        self.assertEqual(self.spp("--preset", "final", "--preset", "draft"), 4)
        # Another budget is one, too.
        self.assertGreater(self.spp("--preset", "draft", "--time", "1"), 8)

    def test_depth(self):
        self.assertTrue(self.same(["--preset", "draft"], ["--spp", "4", "--max-depth", "4"]))
        self.assertFalse(self.same(["--preset", "draft"], ["--spp", "4"]))
        self.assertTrue(self.same(["--preset", "preview"], ["--spp", "32", "--max-depth", "8"]))
        self.assertTrue(self.same(["--preset", "draft", "--max-depth", "20"], ["--spp", "4"]))
        self.assertTrue(self.same(["--preset", "preview"], ["--spp", "32"], scene=TINY))  # 4 is less than 8

    def test_guides_are_learnt_at_the_depth_that_is_rendered(self):
        def lamps(*arguments, depth):
            scene = TINY.replace('"integer maxdepth" 4', f'"integer maxdepth" {depth}')
            self.rendered("--method", "uniform", "--spp", "1", "--stats", "s.json", *arguments, scene=scene)
            guide = json.loads((self.folder / "s.json").read_text())["guides"]["lamps"]
            self.assertIsNotNone(guide["second_moment"])
            return guide["second_moment"]

        self.assertNotEqual(lamps(depth=1), lamps(depth=4))
        self.assertEqual(lamps("--max-depth", "1", depth=4), lamps(depth=1))
        self.assertEqual(lamps("--preset", "draft", depth=20), lamps(depth=4))

    def test_denoiser(self):
        # A library that is none is told of, unless no denoiser is looked for.
        self.write("no.so", "no library")
        arguments = ["--denoiser-library", "no.so", "--spp", "2"]
        for preset in ("draft", "preview"):
            self.assertIn("no denoiser", self.render(TINY, *arguments, "--preset", preset).stderr)
            self.assertNotIn("no denoiser", self.render(TINY, *arguments, "--preset", preset, "--denoiser", "none").stderr)

    def test_drafts_are_analysed_less_and_denoised_fast(self):
        bundle = ["--spp", "4", "--max-depth", "4", "--cov-spp", "0.25", "--denoiser-quality", "fast"]
        for other in ([], ["--denoiser-quality", "high"], ["--cov-spp", "1"]):
            with self.subTest(other=other):
                images = [self.rendered(*arguments, *other, output=f"{i}.exr", scene=DEEP)
                          for i, arguments in enumerate((["--preset", "draft"], bundle))]
                self.assertTrue(json.loads(self.run_program("compare", *images, "--json").stdout)["identical"])
        # Options of hybrid alone are no options of others
        for method in ("uniform", "covariance"):
            self.assertNotIn("changes nothing", self.render(TINY, "--method", method, "--preset", "draft").stderr)

    def test_help_and_errors(self):
        self.assert_fails(self.render(TINY, "--preset", "best"), USAGE, "--preset", "draft|preview|final")
        self.assertIn("--preset draft|preview|final", self.run_program("render", "--help").stdout)
        self.assertEqual(self.render(TINY, "--preset", "draft").code, DONE)


if __name__ == "__main__":
    unittest.main()
