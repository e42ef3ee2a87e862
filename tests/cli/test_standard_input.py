"""The scene `-`: standard input, pbrt's text or either kind of glTF."""

import json
import struct
import subprocess
import unittest

import exr
from support import DONE, HEADER, PROGRAM, SCENE, TINY, CliTest, Result
from test_defaults import TRIANGLE


def glb(document):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<3I", 2, 20 + len(text), len(text)) + b"JSON" + text


class StandardInput(CliTest):
    def piped(self, content, *arguments, command="render"):
        done = subprocess.run([PROGRAM, command, "-", *arguments], cwd=self.folder, capture_output=True, timeout=60,
                              input=content.encode() if isinstance(content, str) else content)
        return Result(done.returncode, done.stdout.decode(), done.stderr.decode())

    def test_pbrt(self):
        arguments = ["--method", "uniform", "--layers", "none", "--reproducible"]
        self.rendered(*arguments)
        result = self.piped(TINY, "-o", "piped.exr", *arguments)
        self.assertEqual(result.code, DONE, result)
        self.assertEqual((self.folder / "piped.exr").read_bytes(), (self.folder / "out.exr").read_bytes())

    def test_the_output_has_the_films_name_or_scene(self):
        result = self.piped(TINY, "--spp", "1")
        self.assertEqual(result.code, DONE, result)
        self.assertIn("film.exr: ", result.stderr)
        exr.read(self.folder / "film.exr")
        result = self.piped(TINY.replace('"string filename" "film.exr"', ""), "--spp", "1")
        self.assertIn("scene.exr: ", result.stderr)
        exr.read(self.folder / "scene.exr")

    def test_files_are_looked_for_in_the_working_folder(self):
        self.write("parts/ball.pbrt", 'Shape "sphere"')
        scene = HEADER + 'WorldBegin\nLightSource "infinite"\nInclude "parts/ball.pbrt"\n'
        self.assertEqual(self.piped(scene, "--spp", "1").code, DONE)
        buffers = json.loads(json.dumps(TRIANGLE))
        buffers["buffers"][0]["uri"] = "t.bin"
        self.write("t.bin", struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
        self.assertEqual(self.piped(json.dumps(buffers), "--spp", "1", "--resolution", "8x8").code, DONE)

    def test_gltf(self):
        for content in (json.dumps(TRIANGLE), " \n" + json.dumps(TRIANGLE)):
            told = self.piped(content, command="info")
            self.assertEqual(told.code, DONE, told)
            self.assertIn("1 triangles", told.stdout)
        binary = json.loads(json.dumps(TRIANGLE))
        told = self.piped(glb(binary), command="info")
        self.assertIn("1 triangles", told.stdout, told)
        result = self.piped(glb(binary), "--spp", "1", "--resolution", "8x8", "--camera", "eye 0,0,3 target 0,0,0 fov 40")
        self.assertEqual(result.code, DONE, result)
        self.assertIn("scene.exr: ", result.stderr)

    def test_measure(self):
        result = self.piped(TINY, "--pixel", "12,8", "--samples", "4096", "--paths", "16", "--json", command="measure")
        self.assertEqual(json.loads(result.stdout)["samples"], 4096)

    def test_errors_have_their_place(self):
        self.assert_fails(self.piped('WorldBegin\n\n  Shape "spere"\n'), SCENE, "standard input:3:3: ", "spere")
        self.assert_fails(self.piped(""), SCENE, "standard input", "WorldBegin")
        self.assert_fails(self.piped('{"asset": '), SCENE, "standard input:1:")
        for content, name in ((b"BLENDER-v304", "Blender"), (b"#usda 1.0", "USD"), (b"PXR-USDC", "USD"), (b"<scene/>", "Mitsuba"),
                              (b"ply\nformat", "PLY"), (b"\x1f\x8b\x08", "gzip"), (b"PK\x03\x04", "ZIP")):
            for command in ("render", "info"):
                self.assert_fails(self.piped(content, command=command), SCENE, "standard input: ", name, "glTF")

    def test_a_file_of_that_name(self):
        self.write("-", TINY)
        self.assertEqual(self.run_program("render", "./-", "--spp", "1").code, DONE)


if __name__ == "__main__":
    unittest.main()
