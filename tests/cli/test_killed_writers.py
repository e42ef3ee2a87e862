"""Merging, films and checkpoints whose process is killed at every operation on a file: what is there is whole."""

import os
import shutil
import signal
import subprocess
import unittest

import exr
from films import FilmTest
from support import DONE, LIBRARY_OF_FAILURES, PRELOAD, PROGRAM, SLOWER

SMALL = ["--resolution", "24x16"]


@unittest.skipUnless(os.path.exists(LIBRARY_OF_FAILURES), "the library that lets operations fail is not built")
class KilledWriters(FilmTest):
    def run_with(self, arguments, **environment):
        return self.run_program(*arguments, before=lambda: os.environ.update({"LD_PRELOAD": PRELOAD, **environment}))

    def kill_everywhere(self, arguments, start, check):
        """Runs a command again and again, from the files that start() makes, killed at each of its operations on files;
        check() looks at what is left. Returns the number of kills: checkpoints come by the clock, so that a run may have fewer
        operations than the first one, and ends before it is killed."""
        start()
        self.write("list", "")
        self.assertEqual(self.run_with(arguments, COVTRACE_FAIL_LIST="list").code, DONE)
        operations = (self.folder / "list").read_text().split()
        (self.folder / "list").unlink()
        kills = 0
        for at, operation in enumerate(operations):
            with self.subTest(at=at, operation=operation):
                start()
                killed = subprocess.run(
                    [PROGRAM, *arguments], cwd=self.folder, env={**os.environ, "LD_PRELOAD": PRELOAD, "COVTRACE_KILL_AT": str(at)},
                    stdin=subprocess.DEVNULL, capture_output=True, timeout=60 * SLOWER,
                )
                if killed.returncode != DONE:
                    self.assertEqual(killed.returncode, -signal.SIGKILL, killed.stderr)
                    kills += 1
                check()
                # The same again goes through, and leaves nothing of the one that was killed
                again = self.run_with(arguments)
                self.assertEqual(again.code, DONE, again)
                self.assert_no_leftovers()
        return kills

    def clear(self):
        for file in self.folder.iterdir():
            if not file.name.endswith(".pbrt") and file.name != "kept":
                file.unlink()

    def keep(self):
        """Keeps the files as they are; returns a function that brings this state back."""
        kept = self.folder / "kept"
        shutil.rmtree(kept, ignore_errors=True)
        kept.mkdir()
        for file in self.folder.iterdir():
            if file.is_file() and not file.name.endswith(".pbrt"):
                shutil.copy(file, kept)

        def bring_back():
            self.clear()
            for file in kept.iterdir():
                shutil.copy(file, self.folder)

        return bring_back

    def test_merge(self):
        parts = [f"part-{k}.film" for k in (1, 2, 3)]
        for k, part in enumerate(parts, 1):
            self.run_render("plain", "uniform", "--spp", "2", *SMALL, "--shard", f"{k}/3", "--film", part, output=None)
        for name in ("all.film", "out.exr"):
            self.write(name, b"older")
        inputs = {part: (self.folder / part).read_bytes() for part in parts}

        def check():
            for part, content in inputs.items():
                self.assertEqual((self.folder / part).read_bytes(), content)
            if (self.folder / "all.film").read_bytes() != b"older":
                self.assert_sound("all.film")
            if (self.folder / "out.exr").read_bytes() != b"older":
                exr.read(self.folder / "out.exr")

        kills = self.kill_everywhere(["merge", *parts, "--film", "all.film", "-o", "out.exr"], self.keep(), check)
        self.assertGreater(kills, 10)

    def test_film(self):
        """A film that takes the place of an older one, whose name gets the ending .prev."""
        command = ["render", "plain.pbrt", *SMALL, "--progress", "none", "-o", "out.exr", "--film", "a.film"]
        self.assertEqual(self.run_program(*command, "--spp", "1").code, DONE)

        def check():
            self.assert_sound("a.film")
            exr.read(self.folder / "out.exr")
            if (self.folder / "a.film.prev").exists():
                self.assert_sound("a.film.prev")

        self.assertGreater(self.kill_everywhere([*command, "--spp", "2"], self.keep(), check), 10)

    def test_both_generations_of_a_checkpoint(self):
        command = ["render", "plain.pbrt", *SMALL, "--progress", "none", "-o", "out.exr", "--checkpoint", "c.film", "--resume"]
        self.assertEqual(self.run_program(*command, "--spp", "2").code, DONE)
        self.assertEqual(self.run_program(*command, "--spp", "4").code, DONE)
        self.assertEqual(self.run_program("render", "plain.pbrt", *SMALL, "--spp", "16", "-o", "whole.exr", "--quiet").code, DONE)

        def check():
            self.assert_sound("c.film")
            if (self.folder / "c.film.prev").exists():
                self.assert_sound("c.film.prev")

        long = [*command, "--spp", "16", "--every", "0.01"]
        kills = self.kill_everywhere(long, self.keep(), check)
        self.assertGreater(kills, 15)
        self.assert_identical("out.exr", "whole.exr")


if __name__ == "__main__":
    unittest.main()
