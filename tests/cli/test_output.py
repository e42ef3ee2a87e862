"""The places of results, and failures where they cannot be written."""

import json
import os
import pathlib
import stat
import subprocess
import unittest

import exr
from support import DONE, HEADER, IO, PROGRAM, TINY, USAGE, WORLD, CliTest, limits

LONG = ["--spp", "1000000"]  # a render that nobody waits for: the error must come before it


class Names(CliTest):
    def test_the_film_names_the_image(self):
        exr.read(self.rendered(output=None))

    def test_every_image_is_an_exr(self):
        self.assertEqual(self.render(TINY.replace("film.exr", "film.png"), output=None).code, DONE)
        exr.read(self.folder / "film.exr")
        self.assert_no_file("film.png")

    def test_without_a_name_the_scene_names_it(self):
        scene = TINY.replace('"string filename" "film.exr"', "")
        self.assertEqual(self.render(scene, output=None).code, DONE)
        exr.read(self.folder / "scene.exr")

    def test_names_with_spaces_and_other_letters(self):
        (self.folder / "ein Ordner").mkdir()
        exr.read(self.rendered(output="ein Ordner/Bild äöü 画像.exr"))

    def test_a_link_stays_a_link(self):
        self.write("target.exr", "old")
        (self.folder / "out.exr").symlink_to("target.exr")
        self.rendered()
        self.assertTrue((self.folder / "out.exr").is_symlink())
        exr.read(self.folder / "target.exr")

    def test_permissions_stay(self):
        self.write("out.exr", "old").chmod(0o640)
        self.assertEqual(stat.S_IMODE(self.rendered().stat().st_mode), 0o640)

    def test_devices(self):
        result = self.render(TINY, output="/dev/null")
        self.assertEqual(result.code, DONE, result)
        self.assertTrue(stat.S_ISCHR(os.stat("/dev/null").st_mode))

    def test_nothing_else_is_left_in_the_folder(self):
        self.rendered("--png", "out.png", "--stats", "stats.json")
        names = sorted(p.name for p in self.folder.iterdir())
        self.assertEqual(names, ["out.exr", "out.png", "scene.pbrt", "stats.json"])


class CannotBeWritten(CliTest):
    """Outputs that cannot be written are found before the render, since LONG would not end."""

    def test_missing_folder(self):
        for option in ("-o", "--png", "--stats"):
            with self.subTest(option=option):
                result = self.render(TINY, *LONG, option, "nowhere/file", output=None, timeout=10)
                self.assert_fails(result, USAGE, "nowhere/file")

    def test_pipes_get_image_and_statistics(self):
        self.write("scene.pbrt", TINY)
        for options, name in (("-o", "image.exr"), ("--stats", "stats.json")):
            command = [PROGRAM, "render", "scene.pbrt", "--quiet", "--spp", "1", "-o", "/dev/null"]
            if options == "-o":
                command = command[:-2]
            with open(self.folder / name, "wb") as file:
                renderer = subprocess.Popen([*command, options, "/dev/stdout"], cwd=self.folder,
                                            stdout=subprocess.PIPE)
                file.write(renderer.communicate(timeout=60)[0])
            self.assertEqual(renderer.returncode, DONE)
        exr.read(self.folder / "image.exr")
        self.assertIn("seconds_total", json.loads((self.folder / "stats.json").read_text()))

    def test_a_log_that_standard_output_goes_to_stays(self):
        self.write("scene.pbrt", TINY)
        with open(self.folder / "log", "w", encoding="utf-8") as log:
            log.write("before\n")
            log.flush()
            subprocess.run([PROGRAM, "render", "scene.pbrt", "--quiet", "--spp", "1", "--stats", "/dev/stdout"],
                           cwd=self.folder, stdout=log, check=True, timeout=60)
            log.write("after\n")
        lines = (self.folder / "log").read_text().splitlines()
        self.assertEqual((lines[0], lines[1], lines[-1]), ("before", "{", "after"))

    def test_folder_in_place_of_the_file(self):
        (self.folder / "taken").mkdir()
        for option in ("-o", "--png", "--stats"):
            with self.subTest(option=option):
                result = self.render(TINY, *LONG, option, "taken", output=None, timeout=10)
                self.assert_fails(result, IO, "taken")
                self.assertEqual(list((self.folder / "taken").iterdir()), [])

    def test_folder_that_nobody_may_write_to(self):
        if os.geteuid() == 0:
            folder = pathlib.Path("/proc")
        else:
            folder = self.folder / "locked"
            folder.mkdir(mode=0o555)
        for option in ("-o", "--png", "--stats"):
            with self.subTest(option=option):
                result = self.render(TINY, *LONG, option, folder / "file", output=None, timeout=10)
                self.assert_fails(result, IO, str(folder / "file"))


class FailsInTheMiddle(CliTest):
    def test_full_disk_keeps_the_old_file(self):
        old = b"an older image"
        cases = {
            "out.exr": ["--resolution", "100x100"],
            "out.png": ["-o", "/dev/null", "--png", "out.png", "--resolution", "200x200"],
            "out.json": ["-o", "/dev/null", "--stats", "out.json"],
        }
        for name, arguments in cases.items():
            for size in (0, 100):
                with self.subTest(name=name, size=size):
                    self.write(name, old)
                    self.write("scene.pbrt", TINY)
                    output = ["-o", name] if name == "out.exr" else []
                    result = self.run_program(
                        "render", "scene.pbrt", *output, *arguments, "--spp", "1", "--quiet", before=limits(FSIZE=size)
                    )
                    self.assert_fails(result, IO, f"'{name}'")
                    self.assertEqual((self.folder / name).read_bytes(), old)
                    self.assert_no_leftovers()

    def test_full_disk_without_an_old_file(self):
        for size in (0, 1, 4096):
            with self.subTest(size=size):
                result = self.render(TINY, "--resolution", "100x100", "--spp", "1", before=limits(FSIZE=size))
                self.assert_fails(result, IO, "'out.exr'")
                self.assert_no_file()
                self.assert_no_leftovers()

    def test_full_device(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        self.assert_fails(self.render(TINY, output="/dev/full"), IO, "/dev/full")
        for option in ("--png", "--stats"):
            with self.subTest(option=option):
                result = self.render(TINY, option, "/dev/full")
                self.assert_fails(result, IO, "/dev/full")
                exr.read(self.folder / "out.exr")  # the part that could be written is there


class StandardStreams(CliTest):
    def setUp(self):
        super().setUp()
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")

    def test_a_result_that_cannot_be_written_is_an_error(self):
        image = self.rendered("--quiet")
        for arguments in (["compare", image, image, "--json"], ["info", image], ["info", "scene.pbrt"]):
            with self.subTest(arguments=arguments[0]), open("/dev/full", "wb") as full:
                result = self.run_program(*arguments, stdout=full, stderr=subprocess.PIPE)
                self.assert_fails(result, IO, "standard output")

    def test_messages_that_cannot_be_written_are_lost(self):
        with open("/dev/full", "wb") as full:
            self.write("scene.pbrt", TINY)
            for style in ("auto", "plain", "json", "bar"):
                with self.subTest(style=style):
                    result = self.run_program(
                        "render", "scene.pbrt", "-o", "out.exr", "--progress", style, stdout=subprocess.PIPE, stderr=full
                    )
                    self.assertEqual((result.code, result.stdout), (DONE, ""))
                    exr.read(self.folder / "out.exr")
            self.assertEqual(self.run_program("render", "none.pbrt", stderr=full).code, 3)

    def test_closed_streams_do_not_end_in_the_image(self):
        self.write("scene.pbrt", TINY)
        command = f'exec "{PROGRAM}" render scene.pbrt -o out.exr --progress json <&- >&- 2>&-'
        self.assertEqual(subprocess.run(["sh", "-c", command], cwd=self.folder, timeout=60).returncode, DONE)
        data = (self.folder / "out.exr").read_bytes()
        exr.read(self.folder / "out.exr")
        self.assertNotIn(b'{"phase"', data)

    def test_a_reader_that_goes_away_ends_nothing(self):
        self.write("scene.pbrt", HEADER + WORLD)
        command = f'"{PROGRAM}" render scene.pbrt -o out.exr --progress json --spp 64 2>&1 | true'
        subprocess.run(["bash", "-c", command], cwd=self.folder, timeout=60)
        exr.read(self.folder / "out.exr")


if __name__ == "__main__":
    unittest.main()
