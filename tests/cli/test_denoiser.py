"""A denoiser among the candidates of hybrid: the search for it, the messages about it, the samples that it may not
change."""

import json
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

import exr
from films import FilmTest
from support import DONE, PROGRAM, USAGE, warnings_of

FAKES = pathlib.Path(os.environ.get("COVTRACE_FAKE_DENOISERS", ""))
NAME = "libOpenImageDenoise.so.2"
FAKE_NAME = "Open Image Denoise 2.3.99"
REAL = next((p for p in (pathlib.Path(os.environ.get("COVTRACE_OIDN_LIBRARY", "none")),
                         pathlib.Path(PROGRAM).resolve().parent.parent / "denoiser" / NAME) if p.is_file()), None)


def fake(name):
    return FAKES / name / NAME


def in_environment(**values):
    """A function for `before` that sets variables of the environment in the child."""
    return lambda: os.environ.update({name: str(value) for name, value in values.items()})


class DenoiserTest(FilmTest):
    def hybrid(self, *arguments, method="hybrid", spp="4", **options):
        """Renders a small image into out.exr; returns result and statistics."""
        result = self.run_program("render", "plain.pbrt", "--method", method, "--spp", spp, "-o", "out.exr", "--progress", "none",
                                  "--stats", "s.json", "--reproducible", *arguments, **options)
        self.assertEqual((result.code, result.stdout), (DONE, ""), result)
        return result, json.loads((self.folder / "s.json").read_text())

    def film(self, name):
        """The content of a film, without the seconds that it took."""
        data = (self.folder / name).read_bytes()
        end = 24 + struct.unpack_from("<I", data, 12)[0]
        header = json.loads(data[24:end])
        return {k: v for k, v in header.items() if not k.startswith("seconds")}, data[end:]

    def image(self, name="out.exr"):
        return exr.read(self.folder / name)


class Choice(DenoiserTest):
    def test_a_library_that_is_named(self):
        for choice in ([], ["--denoiser", "auto"], ["--denoiser", "oidn"]):
            with self.subTest(choice=choice):
                result, stats = self.hybrid(*choice, "--denoiser-library", fake("good"))
                self.assertEqual(warnings_of(result), [])
                self.assertEqual(stats["denoiser"], {"name": FAKE_NAME, "file": str(fake("good")), "quality": "high"})
                self.assertGreater(stats["seconds"]["denoise"], 0)
                self.assertGreater(stats["seconds"]["reconstruction"], 0)
                self.assertLessEqual(sum(stats["seconds"].values()), stats["seconds_total"])
                self.assertEqual(self.image().value("covtrace:denoiser"), FAKE_NAME)
        self.assertNotIn(str(FAKES).encode(), (self.folder / "out.exr").read_bytes())
        self.assertIn(FAKE_NAME, self.run_program("info", "out.exr").stdout)
        self.assertIn(FAKE_NAME, self.run_program("inspect", "out.exr").stdout)

    def test_it_changes_the_image_and_nothing_that_was_sampled(self):
        self.hybrid("--denoiser-library", fake("good"))
        with_it = self.image()
        _, stats = self.hybrid("--denoiser", "none")
        without = self.image()
        self.assertEqual(stats["denoiser"], {"why_none": "not asked for"})
        self.assertNotIn("denoise", stats["seconds"])
        self.assertNotIn("covtrace:denoiser", (self.folder / "out.exr").read_bytes().decode("latin-1"))
        self.assertNotEqual(with_it.pixels["R"], without.pixels["R"])
        for layer in ("raw.R", "samples.Y", "cov.00", "albedo.G"):
            self.assertEqual(with_it.pixels[layer], without.pixels[layer])

    def test_the_environment(self):
        result, stats = self.hybrid(before=in_environment(COVTRACE_OIDN_LIBRARY=fake("good")))
        self.assertEqual(stats["denoiser"]["name"], FAKE_NAME)
        damaged = in_environment(COVTRACE_OIDN_LIBRARY=fake("version-one"))
        result, stats = self.hybrid(before=damaged)
        self.assertIn("is version 1.4.3", stats["denoiser"]["why_none"])
        result, stats = self.hybrid("--denoiser-library", fake("good"), before=damaged)
        self.assertEqual((warnings_of(result), stats["denoiser"]["name"]), ([], FAKE_NAME))

    def test_none_and_other_methods_look_for_nothing(self):
        damaged = in_environment(COVTRACE_OIDN_LIBRARY=fake("version-one"))
        for options in ({"method": "uniform"}, {"method": "covariance"}, {"choice": "none"}):
            with self.subTest(**options):
                choice = ["--denoiser", options.pop("choice")] if "choice" in options else []
                result, _ = self.hybrid(*choice, **options, before=damaged)
                self.assertEqual(warnings_of(result), [])

    def test_one_that_cannot_be_used(self):
        self.write("text.so", "no library at all\n")
        self.write("cut.so", fake("good").read_bytes()[:3000])
        self.hybrid("--denoiser", "none", "--film", "a.film")
        plain = (self.folder / "out.exr").read_bytes()
        for library, fragment in ((fake("version-one"), "version 1.4.3"), (fake("lacks-a-function"), "oidnCommitFilter"),
                                  (fake("no-device"), "no CPU"), (fake("commit-fails"), "out of order"), ("text.so", "text.so"),
                                  ("cut.so", "its end is missing"), ("missing.so", "missing.so: is no file"), (".", "is no file")):
            with self.subTest(library=library):
                result, stats = self.hybrid("--denoiser-library", library)
                self.assertEqual(len(warnings_of(result)), 1, result)
                self.assertIn(fragment, warnings_of(result)[0][1])
                self.assertIn(fragment, stats["denoiser"]["why_none"])
                self.assertEqual((self.folder / "out.exr").read_bytes(), plain)
                result, _ = self.hybrid("--denoiser-library", library, "--quiet")
                self.assertEqual(result.stderr, "")
                for command in (["render", "plain.pbrt"], ["merge", "a.film"]):
                    result = self.run_program(*command, "-o", "no.exr", "--denoiser", "oidn", "--denoiser-library", library)
                    self.assert_fails(result, USAGE, "--denoiser: oidn: ", fragment)
                    self.assert_no_file("no.exr")

    def test_one_that_fails_at_work(self):
        self.hybrid("--denoiser", "none", "--layers", "none")
        plain = self.image()
        for choice in ("auto", "oidn"):
            result, stats = self.hybrid("--denoiser", choice, "--denoiser-library", fake("execute-fails"))
            self.assertEqual(len(warnings_of(result)), 1, result)
            self.assertIn("the filter is out of order", warnings_of(result)[0][1])
            self.assertIn("the filter is out of order", stats["denoiser"]["why_none"])
            self.assertIn("the filter is out of order", self.image().value("covtrace:denoiserFailure"))
            self.assertNotIn(str(FAKES).encode(), (self.folder / "out.exr").read_bytes())
            self.assertEqual(self.image().pixels["R"], plain.pixels["R"])

    def test_fast_quality_is_the_denoisers_image(self):
        """One of the samples that no other part of the reconstruction has seen, also when it is made of a film."""
        result, stats = self.hybrid("--denoiser-library", fake("good"), "--denoiser-quality", "fast", "--film", "a.film",
                                    "--layers", "all,share")
        self.assertEqual(warnings_of(result), [])
        self.assertIn("denoised fast", result.stderr)
        self.assertEqual(stats["denoiser"]["quality"], "fast")
        image = self.image()
        self.assertEqual(image.value("covtrace:denoiserQuality"), "fast")
        self.assertEqual(set(image.pixels["share.denoiser"]), {1})
        self.assertEqual(set(image.pixels["share.raw"]), {0})
        self.assertGreater(sum(image.pixels["error.Y"]), 0)
        merged = self.run_program("merge", "a.film", "-o", "merged.exr", "--denoiser-library", fake("good"), "--denoiser-quality", "fast")
        self.assertEqual(merged.code, DONE, merged)
        self.assertEqual(self.image("merged.exr").pixels["R"], image.pixels["R"])
        self.hybrid("--denoiser-library", fake("good"))
        self.assertNotEqual(self.image().pixels["R"], image.pixels["R"])
        self.assertEqual(self.image().pixels["raw.R"], image.pixels["raw.R"])

    def test_quality_changes_nothing_without_hybrid(self):
        result, _ = self.hybrid("--denoiser-quality", "fast", method="uniform")
        self.assertIn("--denoiser-quality changes nothing", result.stderr)
        self.hybrid("--film", "a.film", method="uniform")
        merged = self.run_program("merge", "a.film", "-o", "merged.exr", "--denoiser-quality", "fast")
        self.assertIn("--denoiser-quality changes nothing", merged.stderr)

    def test_time_that_is_enough(self):
        """Samples that end long before the time leave enough for high quality."""
        _, stats = self.hybrid("--denoiser-library", fake("slow"), "--time", "60", spp="4")
        self.assertEqual(stats["denoiser"]["quality"], "high")

    def test_time_that_ends_within_the_first_paths(self):
        """An image that comes late anyway is not one of high quality, which would come later still."""
        result, stats = self.hybrid("--denoiser-library", fake("good"), "--time", "0.01", "--resolution", "600x500", spp="64")
        self.assertIn("before every pixel had the samples", result.stderr)
        self.assertNotEqual(stats["denoiser"].get("quality"), "high")

    def test_too_little_time(self):
        """The time of a reconstruction with the denoiser is told by a part of the image."""
        result, stats = self.hybrid("--denoiser-library", fake("slow"), "--time", "1", spp="64")
        self.assertLess(stats["seconds_total"], 5)
        self.assertIn("longer than the time that was left", stats["denoiser"]["why_none"])
        self.assertEqual(len(warnings_of(result)), 1, result)
        self.assertIn("longer than the time that was left", warnings_of(result)[0][1])

    def test_wrong_values(self):
        self.assert_fails(self.run_program("render", "plain.pbrt", "--denoiser", "optix"), USAGE, "--denoiser", "auto|oidn|none")
        self.assert_fails(self.run_program("render", "plain.pbrt", "--denoiser-quality", "low"), USAGE, "--denoiser-quality", "high|fast")
        self.assert_fails(self.run_program("render", "plain.pbrt", "--denoiser-library", ""), USAGE, "--denoiser-library")

    def test_threads_are_those_of_the_render(self):
        for threads in ("1", "3"):
            accept = in_environment(FAKE_OIDN_THREADS=threads)
            _, stats = self.hybrid("--threads", threads, "--denoiser-library", fake("good"), before=accept)
            self.assertEqual(stats["denoiser"].get("name"), FAKE_NAME, stats)

    def test_it_counts_as_memory(self):
        result = self.run_program("render", "plain.pbrt", "-o", "out.exr", "--resolution", "2000x1500", "--max-memory", "500M",
                                  "--denoiser-library", fake("good"))
        self.assertRegex(result.stderr, r"denoiser \d+\.\dM")


class Places(DenoiserTest):
    """A copy of the program, in a folder from which programs may be run, with libraries around it."""

    def setUp(self):
        super().setUp()
        self.tree = pathlib.Path(tempfile.mkdtemp(prefix="covtrace-", dir=os.environ.get("COVTRACE_BUILD")))
        self.addCleanup(shutil.rmtree, self.tree, ignore_errors=True)
        (self.tree / "bin").mkdir()
        self.program = self.tree / "bin/covtrace"
        shutil.copy2(pathlib.Path(PROGRAM).resolve(), self.program)

    def found(self):
        """The denoiser in the statistics of the copied program."""
        environ = {k: v for k, v in os.environ.items() if k != "COVTRACE_OIDN_LIBRARY"}
        subprocess.run([self.program, "render", "plain.pbrt", "-o", "out.exr", "--spp", "1", "--quiet", "--stats", "s.json"],
                       cwd=self.folder, env=environ, check=True, timeout=600)
        return json.loads((self.folder / "s.json").read_text())["denoiser"]

    def test_around_the_program(self):
        # The nearest one counts.
        for place in ("lib/covtrace/denoiser", "denoiser", "bin/denoiser"):
            with self.subTest(place=place):
                (self.tree / place).mkdir(parents=True)
                shutil.copy2(fake("good"), self.tree / place)
                self.assertEqual(self.found(), {"name": FAKE_NAME, "file": str(self.tree / place / NAME), "quality": "high"})

    def test_none_there(self):
        found = self.found()
        if "name" in found:
            self.skipTest("the system has one")
        self.assertIn(f"no {NAME} in '{self.tree}/bin/denoiser'", found["why_none"])
        self.assertIn("denoiser's library", found["why_none"])


class FilmsAndMerge(DenoiserTest):
    def test_a_film_knows_nothing_of_it(self):
        good = ["--denoiser-library", fake("good")]
        self.hybrid(*good, "--film", "a.film")
        shutil.copy(self.folder / "out.exr", self.folder / "with.exr")
        self.hybrid("--denoiser", "none", "--film", "b.film")
        self.assertEqual(self.film("a.film"), self.film("b.film"))
        for film in ("a.film", "b.film"):
            result = self.run_program("merge", film, "-o", "merged.exr", *good)
            self.assertEqual((result.code, warnings_of(result)), (DONE, []), result)
            self.assert_identical("with.exr", "merged.exr")
            result = self.run_program("merge", film, "-o", "merged.exr", "--denoiser", "none", "--quiet")
            self.assertEqual((result.code, result.stderr), (DONE, ""), result)
            self.assert_identical("out.exr", "merged.exr")

    def test_going_on_with_and_without(self):
        good, none = ["--denoiser-library", fake("good")], ["--denoiser", "none"]
        self.hybrid(*good, "--checkpoint", "whole.film", spp="16")
        shutil.copy(self.folder / "out.exr", self.folder / "whole.exr")
        for first, second in ((good, none), (none, good)):
            (self.folder / "c.film").unlink(missing_ok=True)
            self.hybrid(*first, "--checkpoint", "c.film", "--resume")
            self.hybrid(*second, "--checkpoint", "c.film", "--resume", spp="16")
            self.assertEqual(self.film("c.film"), self.film("whole.film"))
        self.assert_identical("out.exr", "whole.exr")

    def test_shards_need_none(self):
        damaged = in_environment(COVTRACE_OIDN_LIBRARY=fake("version-one"))
        result = self.run_program("render", "plain.pbrt", "--spp", "1", "--shard", "1/2", "--film", "s.film", "--progress", "none", before=damaged)
        self.assertEqual((result.code, warnings_of(result)), (DONE, []), result)

    def test_merge_warns_of_one_that_fails(self):
        self.hybrid("--denoiser", "none", "--film", "a.film")
        for name, fragment in (("version-one", "version 1.4.3"), ("execute-fails", "the filter is out of order")):
            result = self.run_program("merge", "a.film", "-o", "merged.exr", "--denoiser-library", fake(name))
            self.assertEqual(result.code, DONE, result)
            self.assertIn(fragment, warnings_of(result)[0][1])
            self.assert_identical("out.exr", "merged.exr")


@unittest.skipUnless(REAL, "Open Image Denoise is not there: ./scripts/install-dependencies fetches it")
class RealLibrary(DenoiserTest):
    def test_threads_and_runs_do_not_matter(self):
        images = set()
        for threads in ("1", "2", "3", "1"):
            self.hybrid("--denoiser", "oidn", "--denoiser-library", REAL, "--threads", threads, "--resolution", "61x37")
            images.add((self.folder / "out.exr").read_bytes())
        self.assertEqual(len(images), 1)

    def test_its_files_cut_off(self):
        parts = sorted(REAL.parent.glob("libOpenImageDenoise*.so*"))
        copies = self.folder / "copies"
        for damaged in parts:
            if damaged.is_symlink():
                continue
            with self.subTest(part=damaged.name):
                shutil.rmtree(copies, ignore_errors=True)
                copies.mkdir()
                for part in parts:
                    (copies / part.name).symlink_to(part)
                (copies / damaged.name).unlink()
                with damaged.open("rb") as whole:
                    (copies / damaged.name).write_bytes(whole.read(damaged.stat().st_size // 3))
                result, stats = self.hybrid("--denoiser-library", copies / NAME)
                self.assertIn(f"{damaged.name}: its end is missing", stats["denoiser"]["why_none"])
                self.assertEqual(len(warnings_of(result)), 1, result)


if __name__ == "__main__":
    unittest.main()
