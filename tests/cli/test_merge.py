"""Shards: several machines, one image, the bits of one machine."""

import itertools
import json
import shutil
import unittest

import exr
from films import METHODS, FilmTest
from support import DONE, INTERRUPTED, USAGE

SHARDS = 4


class Merge(FilmTest):
    def shard(self, k, scene, method, *arguments, n=SHARDS):
        self.run_render(
            scene, method, "--shard", f"{k}/{n}", "--film", f"part-{k}.film", "--checkpoint", "all.film", "--resume",
            *arguments, output=None,
        )

    def merge(self, films, *arguments):
        result = self.run_program("merge", *films, *arguments)
        self.assertEqual(result.code, DONE, result)
        return result

    def rounds(self, scene, method, *arguments, n=SHARDS, order=lambda parts: parts):
        """Traces and merges rounds as the job array of the documentation does. Returns the rounds it took."""
        parts = [f"part-{k}.film" for k in range(1, n + 1)]
        for r in range(1, 20):
            for k in range(1, n + 1):
                self.shard(k, scene, method, *arguments, n=n)
            if "; complete" not in self.merge(order(parts), "--film", "all.film", "--quiet").stdout + self.assert_sound("all.film"):
                continue
            self.merge(["all.film"], "-o", "merged.exr")
            return r
        self.fail("the rounds do not end")

    def test_rounds_of_shards(self):
        for method, rounds in (("uniform", 1), ("covariance", 5), ("hybrid", 4)):
            for scene in ("moving", "sky"):
                with self.subTest(method=method, scene=scene):
                    for film in self.folder.glob("*.film*"):
                        film.unlink()
                    taken = self.rounds(scene, method, "--spp", "16", order=lambda parts: parts[::-1])
                    self.assertEqual(taken, rounds)
                    self.run_render(scene, method, "--spp", "16", output="whole.exr")
                    self.assert_identical("whole.exr", "merged.exr")

    def test_more_shards_than_tiles(self):
        self.rounds("plain", "hybrid", "--spp", "4", n=30)
        self.run_render("plain", "hybrid", "--spp", "4", output="whole.exr")
        self.assert_identical("whole.exr", "merged.exr")

    def test_all_orders(self):
        """Merging in any order, in every round of each method: the same film, byte by byte; also of joined ones; at
        last the same image."""
        parts = [f"part-{k}.film" for k in range(1, SHARDS + 1)]
        for method in METHODS:
            with self.subTest(method=method):
                for film in self.folder.glob("*.film*"):
                    film.unlink()
                while "; complete" not in (self.assert_sound("all.film") if (self.folder / "all.film").exists() else ""):
                    for k in range(1, SHARDS + 1):
                        self.shard(k, "sky", method, "--spp", "8")
                    films = set()
                    for order in itertools.permutations(parts):
                        self.merge(order, "--film", "joined.film", "--quiet")
                        films.add((self.folder / "joined.film").read_bytes())
                    self.merge([*parts[:2]], "--film", "ab.film")
                    self.merge([*parts[2:]], "--film", "cd.film")
                    result = self.run_program("merge", "cd.film", "ab.film", "--film", "all.film", "-o", "all.exr")
                    is_last = "; complete" in self.assert_sound("all.film")
                    self.assertEqual(result.code, DONE if is_last else INTERRUPTED, result)
                    films.add((self.folder / "all.film").read_bytes())
                    self.assertEqual(len(films), 1)
                self.run_render("sky", method, "--spp", "8", output="whole.exr")
                self.assert_identical("whole.exr", "all.exr")

    def test_a_missing_shard_leaves_a_hole(self):
        self.shard(1, "plain", "uniform", "--spp", "2")
        self.shard(3, "plain", "uniform", "--spp", "2")
        result = self.run_program("merge", "part-3.film", "part-1.film", "-o", "half.exr")
        self.assertEqual(result.code, INTERRUPTED, result)
        self.assertIn("2 of 4 shards", result.stderr)
        self.assertIn("warning: the image is not complete: 2 of its 4 shards are missing", result.stderr)
        result = self.run_program("info", "half.exr")
        self.assertRegex(result.stdout, r"complete = 0")
        self.run_render("plain", "uniform", "--spp", "2", output="whole.exr")
        half, whole = exr.read(self.folder / "half.exr"), exr.read(self.folder / "whole.exr")
        for name, values in half.pixels.items():
            for i, value in enumerate(values):
                x, y = i % 70, i // 70
                there = (x // 16 + y // 16) % SHARDS in (0, 2)
                self.assertEqual(value, whole.pixels[name][i] if there else 0, (name, x, y))

    def test_an_image_that_is_not_complete(self):
        """An incomplete image has exit code 6, as that of a render that was interrupted; a film that is joined step
        by step is nothing of the kind."""
        for k in (1, 2, 3):
            self.shard(k, "plain", "hybrid", "--spp", "8", n=3)
        parts = [f"part-{k}.film" for k in (1, 2, 3)]
        for films, arguments, why in (
            (parts[:2], ["-o", "a.exr"], "1 of its 3 shards is missing"),
            (parts[:1], ["--png", "a.png", "--quiet"], "2 of its 3 shards are missing"),
            # The film is of its first round alone.
            (parts, ["-o", "a.exr", "--film", "all.film"], "not come to its end"),
        ):
            with self.subTest(films=films, arguments=arguments):
                result = self.run_program("merge", *films, *arguments)
                self.assertEqual(result.code, INTERRUPTED, result)
                self.assertIn(why, result.stderr)
                self.assertTrue((self.folder / arguments[1]).exists())
        self.merge(parts[:2], "--film", "two.film")
        self.run_render("plain", "hybrid", "--spp", "8", "--film", "whole.film")
        self.assertNotIn("not complete", self.merge(["whole.film"], "-o", "whole.exr").stderr)

    def test_a_shard_goes_on_from_its_own_film(self):
        self.shard(1, "plain", "uniform", "--spp", "8")
        (self.folder / "part-1.film").rename(self.folder / "first.film")
        shutil.copy(self.folder / "first.film", self.folder / "part-1.film")
        result = self.run_program(
            "render", "plain.pbrt", "--method", "uniform", "--spp", "8", "--shard", "1/4", "--film", "part-1.film",
            "--resume", "--stats", "stats.json", "--quiet",
        )
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(json.loads((self.folder / "stats.json").read_text())["radiance"]["samples"], 0)
        for film in ("first", "part-1"):
            result = self.run_program("merge", f"{film}.film", "-o", f"{film}.exr")
            self.assertEqual(result.code, INTERRUPTED, result)  # the film is of one shard
        self.assert_identical("first.exr", "part-1.exr")

    def test_a_shard_that_began_with_another_budget(self):
        """A shard with another budget has the same round: it keeps its samples and joins those with the new --spp."""
        for method in ("covariance", "hybrid"):
            with self.subTest(method=method):
                for film in self.folder.glob("*.film*"):
                    film.unlink()
                self.shard(1, "plain", method, "--spp", "8", n=2)
                self.rounds("plain", method, "--spp", "16", n=2)
                self.run_render("plain", method, "--spp", "16", output="whole.exr")
                self.assert_identical("whole.exr", "merged.exr")

    def test_shards_of_hybrid_with_any_layers(self):
        """Layers that are asked for change nothing that `hybrid` keeps."""
        spp = ["--spp", "2"]
        self.shard(1, "plain", "hybrid", *spp, "--layers", "inview", n=2)
        self.shard(2, "plain", "hybrid", *spp, n=2)
        self.merge(["part-1.film", "part-2.film"], "--film", "all.film")
        self.assertNotIn("shards", self.assert_sound("all.film"))

    def test_refused(self):
        spp = ["--spp", "2"]
        for k in (1, 2):
            self.shard(k, "plain", "uniform", *spp)
        (self.folder / "part-1.film").rename(self.folder / "first.film")
        self.run_render("plain", "uniform", *spp, "--film", "whole.film")
        self.run_render("plain", "uniform", "--seed", "7", *spp, "--film", "foreign.film", "--shard", "3/4", output=None)
        self.run_render("plain", "uniform", "--spp", "3", "--film", "other.film", "--shard", "3/4", output=None)
        self.run_render("plain", "uniform", *spp, "--film", "third.film", "--shard", "3/5", output=None)
        for films, fragments in (
            (["first.film", "first.film"], ["overlaps", "shard 1/4"]),
            (["whole.film", "whole.film"], ["overlaps"]),
            (["first.film", "foreign.film"], ["foreign.film", "--seed: 7, not 0"]),
            (["first.film", "other.film"], ["other.film", "round or budget"]),
            (["first.film", "third.film"], ["third.film", "5 shards"]),
        ):
            with self.subTest(films=films):
                self.assert_fails(self.run_program("merge", *films, "-o", "out.exr"), USAGE, *fragments)
        self.assert_fails(self.run_program("merge", "first.film"), USAGE, "--output")
        result = self.run_program("render", "plain.pbrt", "--method", "uniform", "--checkpoint", "first.film", "--resume")
        self.assert_fails(result, USAGE, "first.film", "shards")


if __name__ == "__main__":
    unittest.main()
