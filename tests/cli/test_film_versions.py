"""Films of other versions of the program: refused, with both versions, and left where they are."""

import struct
import unittest

from support import DONE, SCENE, USAGE, TINY, CliTest

FORMAT = 4
AT = 8  # offset of the format's number in the file


class Versions(CliTest):
    def setUp(self):
        super().setUp()
        self.rendered("--spp", "1", "--film", "a.film")
        self.film = (self.folder / "a.film").read_bytes()

    def of_format(self, number):
        return self.film[:AT] + struct.pack("<I", number) + self.film[AT + 4 :]

    def test_this_format_is_read(self):
        self.assertEqual(self.film, self.of_format(FORMAT))
        self.assertEqual(self.run_program("merge", "a.film", "-o", "b.exr").code, DONE)

    def test_other_formats_are_named(self):
        version = self.run_program("--version").stdout.removeprefix("covtrace ").strip()
        scene = ["render", self.write("scene.pbrt", TINY).name, "-o", "b.exr", "--spp", "2"]
        for number in (0, 1, 2, 5, 17, 256, 1 << 31, (1 << 32) - 1):
            self.write("old.film", self.of_format(number))
            for command in (["merge", "old.film", "-o", "b.exr"], ["merge", "a.film", "old.film", "-o", "b.exr"],
                            ["info", "old.film"], [*scene, "--checkpoint", "old.film", "--resume"],
                            [scene[0], scene[1], "--shard", "1/2", "--film", "part.film", "--checkpoint", "old.film", "--resume"]):
                with self.subTest(number=number, command=command):
                    self.assert_fails(
                        self.run_program(*command), SCENE, "old.film", f"format {number},", f"the formats 3 and {FORMAT}", version
                    )
                    self.assertEqual((self.folder / "old.film").read_bytes(), self.of_format(number))
                    self.assert_no_file("b.exr")

    def test_such_a_checkpoint_is_not_set_aside(self):
        """A film of another version is not damaged, even where the earlier one could be gone on from."""
        self.write("c.film.prev", self.film)
        newer = self.of_format(FORMAT + 1)
        self.write("c.film", newer)
        result = self.render(TINY, "--spp", "2", "--checkpoint", "c.film", "--resume", output="c.exr")
        self.assert_fails(result, SCENE, "c.film", f"format {FORMAT + 1}")
        self.assertEqual((self.folder / "c.film").read_bytes(), newer)
        self.assert_no_file("c.film.damaged")

    def test_a_render_goes_on_with_its_own_version(self):
        """A film of the same format is read, and the version that differs is told."""
        self.assertIn(b'"version": "', self.film)
        self.assertEqual(self.render(TINY, "--spp", "1", "--checkpoint", "a.film", "--resume").code, DONE)
        result = self.render(TINY, "--spp", "1", "--seed", "2", "--checkpoint", "a.film", "--resume")
        self.assert_fails(result, USAGE, "a.film", "--seed")


if __name__ == "__main__":
    unittest.main()
