"""Pipes, folders and devices in the place of files: they are named in the message, and never waited for."""

import json
import os
import subprocess
import unittest

from support import DONE, IO, PROGRAM, SCENE, TINY, USAGE, CliTest
from test_taken_names import LONG, OUTPUTS


class Pipes(CliTest):
    """Pipes whose other side nobody has open: whoever opens one waits for ever."""

    def setUp(self):
        super().setUp()
        os.mkfifo(self.folder / "pipe")

    def pipe(self, name):
        os.mkfifo(self.folder / name)
        return name

    def test_as_output(self):
        self.pipe("pipe.png")
        for option in OUTPUTS:
            with self.subTest(option=option):
                name = "pipe.png" if option == "--png" else "pipe"
                result = self.render(TINY, *LONG, option, name, output=None, timeout=10)
                self.assert_fails(result, USAGE, f"'{name}'", "a named pipe", "regular file")

    def test_as_checkpoint(self):
        for arguments in (["--checkpoint", "pipe"], ["--checkpoint", "pipe", "--shard", "1/2", "--film", "a.film"]):
            with self.subTest(arguments=arguments):
                output = None if "--shard" in arguments else "out.exr"
                result = self.render(TINY, *LONG, *arguments, "--resume", output=output, timeout=10)
                self.assertIn(result.code, (USAGE, SCENE), result)
                self.assert_fails(result, result.code, "pipe", "a named pipe")

    def test_as_scene(self):
        for name in ("pipe", self.pipe("pipe.pbrt"), self.pipe("pipe.pbrt.gz"), self.pipe("pipe.gltf"), self.pipe("pipe.glb")):
            for command in (["render", name], ["info", name], ["measure", name, "--pixel", "0,0"]):
                if command[0] == "info" and name == "pipe":
                    continue  # the format is taken for an image
                with self.subTest(command=command):
                    self.assert_fails(self.run_program(*command, timeout=10), SCENE, name, "a named pipe")

    def test_as_film_and_image(self):
        self.assert_fails(self.run_program("merge", "pipe", "-o", "a.exr", timeout=10), SCENE, "pipe", "a named pipe")
        for command in (["info", "pipe"], ["inspect", "pipe"], ["compare", "pipe", "pipe"]):
            with self.subTest(command=command):
                self.assert_fails(self.run_program(*command, timeout=10), SCENE, "pipe", "regular file")

    def test_as_result_of_other_commands(self):
        self.rendered("--spp", "1", "--film", "a.film")
        for command in (
            ["merge", "a.film", "-o", "pipe"],
            ["merge", "a.film", "--film", "pipe"],
            ["compare", "out.exr", "out.exr", "--report", "pipe"],
            ["inspect", "out.exr", "--report", "pipe"],
        ):
            with self.subTest(command=command):
                self.assert_fails(self.run_program(*command, timeout=10), USAGE, "pipe", "a named pipe")

    def test_standard_output_may_be_one(self):
        self.write("scene.pbrt", TINY)
        command = [PROGRAM, "render", "scene.pbrt", "--quiet", "--spp", "1", "-o", "/dev/stdout"]
        with subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE) as program:
            self.assertTrue(program.communicate(timeout=60)[0].startswith(b"\x76\x2f\x31\x01"))
        self.assertEqual(program.returncode, DONE)

    def test_standard_input_may_be_a_scene(self):
        """Standard input is a scene where a file is behind it; data from a pipe has no length."""
        self.write("scene.pbrt", TINY)
        command = [PROGRAM, "render", "/dev/stdin", "--quiet", "--spp", "1", "-o", "a.exr"]
        with open(self.folder / "scene.pbrt", "rb") as scene:
            self.assertEqual(subprocess.run(command, cwd=self.folder, stdin=scene, timeout=60).returncode, DONE)
        piped = subprocess.run(command, cwd=self.folder, input=TINY.encode(), capture_output=True, timeout=60)
        self.assertEqual(piped.returncode, SCENE)
        self.assertIn(b"a named pipe", piped.stderr)


class Named(CliTest):
    """Files that a scene names."""

    LINES = (
        'Include "%s"',
        'Shape "plymesh" "string filename" "%s"',
        'Texture "t" "spectrum" "imagemap" "string filename" "%s"',
        'LightSource "infinite" "string filename" "%s"',
        'Material "conductor" "spectrum eta" "./%s"',
    )

    def test_a_pipe_a_folder_a_device(self):
        os.mkfifo(self.folder / "pipe")
        (self.folder / "folder").mkdir()
        (self.folder / "null").symlink_to("/dev/null")
        for name, kind in (("pipe", "a named pipe"), ("folder", "a folder"), ("null", "a device")):
            for line in self.LINES:
                with self.subTest(name=name, line=line):
                    scene = TINY + line % name + "\n"
                    result = self.render(scene, timeout=10)
                    self.assert_fails(result, SCENE, name, f"is {kind}")
                    self.assertRegex(result.stderr, rf"^covtrace: scene\.pbrt:{scene.count(chr(10))}:\d+: ")

    def test_a_lens(self):
        (self.folder / "folder").mkdir()
        scene = TINY.replace('"perspective" "float fov" 40', '"realistic" "string lensfile" "folder"')
        self.assert_fails(self.render(scene, timeout=10), SCENE, "folder", "is a folder")

    def test_the_buffers_of_gltf(self):
        (self.folder / "data.bin").mkdir()
        scene = {"asset": {"version": "2.0"}, "buffers": [{"uri": "data.bin", "byteLength": 4}]}
        self.write("scene.gltf", json.dumps(scene))
        self.assert_fails(self.run_program("render", "scene.gltf"), SCENE, "data.bin", "is a folder")


class Help(CliTest):
    def test_that_cannot_be_written(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        for arguments in (["--help"], ["--version"], ["render", "--help"], ["completion", "bash"]):
            with self.subTest(arguments=arguments), open("/dev/full", "wb") as full:
                result = self.run_program(*arguments, stdout=full, stderr=subprocess.PIPE)
                self.assert_fails(result, IO, "cannot write to", "No space left")


if __name__ == "__main__":
    unittest.main()
