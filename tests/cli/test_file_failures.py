"""Every operation on every file that a render writes fails once: the old file or the new one is there, whole."""

import os
import unittest

import exr
from films import FilmTest
from support import DONE, IO, LIBRARY_OF_FAILURES, PRELOAD


@unittest.skipUnless(os.path.exists(LIBRARY_OF_FAILURES), "the library that lets operations fail is not built")
class Failures(FilmTest):
    ARGUMENTS = ["--spp", "2", "--resolution", "24x16", "--film", "a.film", "--png", "out.png", "--stats", "s.json", "--reproducible"]

    def run_with(self, **environment):
        return self.run_program(
            "render", "plain.pbrt", "--method", "hybrid", "-o", "out.exr", "--progress", "none", *self.ARGUMENTS,
            before=lambda: os.environ.update({"LD_PRELOAD": PRELOAD, **environment}),
        )

    def contents(self):
        return {n: (self.folder / n).read_bytes() for n in ("out.exr", "out.png", "a.film")}

    def test_every_operation_fails_once(self):
        old = {name: b"the old " + name.encode() for name in ("out.exr", "out.png", "a.film")}
        for name, content in old.items():
            self.write(name, content)
        self.assertEqual(self.run_with(COVTRACE_FAIL_LIST="list").code, DONE)
        operations = (self.folder / "list").read_text().split()
        self.assertGreater(len(operations), 20)
        self.assertLessEqual({"open", "write", "fsync", "close", "rename", "link", "unlink"}, set(operations))
        good = self.contents()
        (self.folder / "a.film.prev").unlink()
        for at, operation in enumerate(operations):
            with self.subTest(at=at, operation=operation):
                for name, content in old.items():
                    self.write(name, content)
                result = self.run_with(COVTRACE_FAIL_AT=str(at))
                # Failed links and removals are harmless: the older film is then moved, or a spare
                # name is left.
                harmless = operation in ("link", "unlink")
                self.assertEqual(result.code, DONE if harmless else IO, result)
                if not harmless:
                    self.assertIn("cannot write '", result.stderr)
                for name, content in self.contents().items():
                    if name == "a.film" and content != old[name]:
                        self.assert_sound(name)  # its times differ
                    else:
                        self.assertIn(content, (good[name], old[name]), name)
                if (self.folder / "a.film.prev").exists():
                    (self.folder / "a.film.prev").unlink()
                self.assert_no_leftovers()

    def test_short_writes(self):
        self.assertEqual(self.run_with().code, DONE)
        good = self.contents()
        self.assertEqual(self.run_with(COVTRACE_SHORT_WRITES="1").code, DONE)
        again = self.contents()
        self.assertEqual(again["out.exr"], good["out.exr"])
        self.assertEqual(again["out.png"], good["out.png"])
        self.assert_sound("a.film")
        exr.read(self.folder / "out.exr")


if __name__ == "__main__":
    unittest.main()
