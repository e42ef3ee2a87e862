"""The film of a scene names the image, and does not choose where to write."""

import unittest

import exr
from support import DONE, TINY, CliTest, warnings_of


class FilmName(CliTest):
    def named(self, name):
        return TINY.replace('"film.exr"', f'"{name}"')

    def render_in(self, folder, scene):
        (self.folder / folder).mkdir(exist_ok=True)
        self.write(f"{folder}/scene.pbrt", scene)
        return self.run_program("render", "scene.pbrt", "--spp", "1", "--progress", "none", folder=self.folder / folder)

    def test_a_name_that_leads_elsewhere_loses_its_folder(self):
        victim = self.write("victim/precious.exr", "precious")
        (self.folder / "here").mkdir()
        (self.folder / "here/way").symlink_to("../victim")
        (self.folder / "here/link.exr").symlink_to("../victim/link.exr")
        for name in (victim, "../victim/precious.exr", "x/../../victim/precious.exr", "way/precious.exr"):
            with self.subTest(name=name):
                result = self.render_in("here", self.named(name))
                self.assertEqual(result.code, DONE, result)
                self.assertEqual(victim.read_text(), "precious")
                exr.read(self.folder / "here/precious.exr")
                (self.folder / "here/precious.exr").unlink()
                [(place, text)] = warnings_of(result)
                self.assertTrue(place.startswith("scene.pbrt:3:"), place)
                for fragment in (str(name), "outside of the working folder", "'precious.exr'", "--output"):
                    self.assertIn(fragment, text)
        result = self.render_in("here", self.named("link.exr"))
        self.assertEqual(result.code, DONE, result)
        self.assertFalse((self.folder / "victim/link.exr").exists())
        exr.read(self.folder / "here/scene.exr")

    def test_a_folder_is_no_name(self):
        for name in ("..", "../", "/"):
            with self.subTest(name=name):
                result = self.render_in("here", self.named(name))
                self.assertEqual(result.code, DONE, result)
                exr.read(self.folder / "here/scene.exr")
                (self.folder / "here/scene.exr").unlink()
                [(_, text)] = warnings_of(result)
                self.assertIn("a folder", text)

    def test_names_within_the_working_folder_stay(self):
        (self.folder / "here/images").mkdir(parents=True)
        for name in ("images/a.exr", self.folder / "here/images/a.exr", "images/../images/a.exr"):
            with self.subTest(name=name):
                result = self.render_in("here", self.named(name))
                self.assertEqual((result.code, warnings_of(result)), (DONE, []), result)
                exr.read(self.folder / "here/images/a.exr")
                (self.folder / "here/images/a.exr").unlink()

    def test_output_writes_anywhere(self):
        result = self.render(self.named("../victim/a.exr"), "--spp", "1", output=self.folder / "out.exr")
        self.assertEqual((result.code, warnings_of(result)), (DONE, []), result)


if __name__ == "__main__":
    unittest.main()
