"""--frames: the frames of an animation, each with a moment, a seed and files of its own."""

import fcntl
import json
import os
import signal
import struct
import subprocess
import time
import unittest

import exr
from gltf_file import shining, uri
from support import DONE, INTERRUPTED, PROGRAM, SLOWER, TINY, USAGE, CliTest, warnings_of

# A green square that goes from x = -4 to x = 4 in two seconds, and a red one at x = 0 below; no camera and no light.
TIMES, WAY = struct.pack("<2f", 0, 2), struct.pack("<6f", -4, 2, 0, 4, 2, 0)
CORNERS = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
DATA = CORNERS + TIMES + WAY


STILL = {
    "asset": {"version": "2.0"},
    "extensionsUsed": ["KHR_materials_emissive_strength"],
    "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0, "translation": [-4, 2, 0]}, {"mesh": 1, "translation": [0, -2, 0]}],
    "materials": [shining([0, 1, 0]), shining([1, 0, 0])],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": m}]} for m in range(2)],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
        {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
        {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"},
    ],
    "bufferViews": [
        {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        {"buffer": 0, "byteOffset": 60, "byteLength": 8}, {"buffer": 0, "byteOffset": 68, "byteLength": 24},
    ],
    "buffers": [{"byteLength": len(DATA), "uri": uri(DATA)}],
}
MOVING = STILL | {"animations": [{"samplers": [{"input": 2, "output": 3}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]}
WIDTH, HEIGHT = 48, 32
RENDER = ["--method", "uniform", "--spp", "16", "--resolution", f"{WIDTH}x{HEIGHT}", "--progress", "none", "--reproducible"]


class Frames(CliTest):
    def frames(self, *arguments, file=MOVING, name="a.gltf"):
        self.write(name, json.dumps(file) if isinstance(file, dict) else file)
        return self.run_program("render", name, *RENDER, *arguments)

    def pixels(self, name):
        return exr.read(self.folder / name).pixels

    def place(self, name, channel):
        """(column, width) of what shines in a channel: the mean and the deviation of its light."""
        light = self.pixels(name)[channel]
        total = sum(light)
        mean = sum(v * (i % WIDTH) for i, v in enumerate(light)) / total
        return mean, (sum(v * (i % WIDTH - mean) ** 2 for i, v in enumerate(light)) / total) ** 0.5

    def test_each_moment_has_its_file(self):
        self.assertEqual(self.frames("--frames", "0-8X4", "--fps", "4", "-o", "a.exr").code, DONE)
        self.assertEqual(sorted(p.name for p in self.folder.glob("*.exr")), ["a.0000.exr", "a.0004.exr", "a.0008.exr"])
        green = [self.place(f"a.{frame:04}.exr", "G") for frame in (0, 4, 8)]
        red = [self.place(f"a.{frame:04}.exr", "R") for frame in (0, 4, 8)]
        # The square goes from end to end of what the camera sees, which stands still: so does the other square.
        self.assertGreater(green[1][0] - green[0][0], 8)
        self.assertGreater(green[2][0] - green[1][0], 8)
        for column, width in red[1:]:
            self.assertAlmostEqual(column, red[0][0], delta=0.1)
            self.assertAlmostEqual(width, red[0][1], delta=0.1)

    def test_the_shutter_moves_along(self):
        self.assertEqual(self.frames("--frames", "3", "--fps", "4", "-o", "default.exr").code, DONE)
        self.assertEqual(self.frames("--frames", "3", "--fps", "4", "--shutter", "0,0.125", "-o", "half.exr").code, DONE)
        self.assertEqual(self.frames("--frames", "3", "--fps", "4", "--shutter=-0.25,0.25", "-o", "wide.exr").code, DONE)
        self.assertEqual(self.pixels("default.0003.exr")["G"], self.pixels("half.0003.exr")["G"])
        self.assertGreater(self.place("wide.0003.exr", "G")[1], self.place("half.0003.exr", "G")[1] + 0.2)
        # The time of exposure is the blur's alone.
        self.assertAlmostEqual(sum(self.pixels("wide.0003.exr")["G"]) / sum(self.pixels("half.0003.exr")["G"]), 1, delta=0.05)

    def test_a_frame_is_the_same_alone(self):
        self.assertEqual(self.frames("--frames", "0-2", "--seed", "7", "-o", "all.exr").code, DONE)
        self.assertEqual(self.frames("--frames", "2", "--seed", "7", "-o", "one.exr").code, DONE)
        self.assertEqual((self.folder / "all.0002.exr").read_bytes(), (self.folder / "one.0002.exr").read_bytes())
        # Noise does not stand still: the red square's outline has other samples in each frame.
        self.assertNotEqual(self.pixels("all.0000.exr")["R"], self.pixels("all.0001.exr")["R"])

    def test_names(self):
        done = self.frames("--frames", "9-10", "-o", "shot#1.##.exr", "--png", "p##.png", "--stats", "stats", "--film", "#####.film")
        self.assertEqual(done.code, DONE, done)
        for name in ("shot#1.09.exr", "shot#1.10.exr", "p09.png", "p10.png", "stats.0009", "stats.0010", "00009.film", "00010.film"):
            self.assertTrue((self.folder / name).exists(), name)
        self.assertEqual(self.frames("--frames", "123-123", name="walk.gltf").code, DONE)
        self.assertTrue((self.folder / "walk.0123.exr").exists())

    def test_a_frame_resumes(self):
        self.assertEqual(self.frames("--frames", "0-1", "-o", "a.exr", "--checkpoint", "a.film").code, DONE)
        whole = (self.folder / "a.0001.exr").read_bytes()
        (self.folder / "a.0001.exr").unlink()
        self.assertEqual(self.frames("--frames", "0-1", "-o", "a.exr", "--checkpoint", "a.film", "--resume").code, DONE)
        self.assertEqual((self.folder / "a.0001.exr").read_bytes(), whole)

    def test_warnings_are_told_once(self):
        told = [text for _, text in warnings_of(self.frames("--frames", "0-2", "-o", "a.exr"))]
        self.assertEqual(len([text for text in told if "no camera" in text]), 1, told)
        self.assertEqual(len(told), len(set(told)), told)
        told = [text for _, text in warnings_of(self.frames("--frames", "0-1", "-o", "a.exr", file=STILL))]
        self.assertEqual(len([text for text in told if "nothing is animated" in text]), 1, told)

    def test_faults_of_pictures_are_told_once(self):
        for camera, fault in (("eye 0,-2,2 target 0,-2,0 fov 40", "half of what has light in the PNG is"), ("eye 0,0,50 target 0,0,99 fov 40", "sees nothing")):
            told = [text for _, text in warnings_of(self.frames("--frames", "0-2", "-o", "a.png", "--camera", camera, "--exposure", "8"))]
            self.assertEqual(len([text for text in told if fault in text]), 1, told)

    def test_time_counts_for_each(self):
        self.assertEqual(self.frames("--frames", "0-2", "--spp", "1", "--time", "60", "-o", "a.exr", "--stats", "s#.json").code, DONE)
        totals = [json.loads((self.folder / f"s{frame}.json").read_text())["seconds_total"] for frame in range(3)]
        phases = [sum(json.loads((self.folder / f"s{frame}.json").read_text())["seconds"].values()) for frame in range(3)]
        for total, phase in zip(totals, phases):
            self.assertLess(total, 2 * phase + 0.5 * SLOWER)

    def test_an_interrupt_ends_them_all(self):
        self.write("a.gltf", json.dumps(MOVING))
        command = [PROGRAM, "render", "a.gltf", *RENDER, "--spp", "100000000", "--frames", "0-5", "-o", "a.exr"]
        with subprocess.Popen(command, cwd=self.folder, stderr=subprocess.DEVNULL) as running:
            time.sleep(1.5 * SLOWER)
            running.send_signal(signal.SIGINT)
            self.assertEqual(running.wait(timeout=60 * SLOWER), INTERRUPTED)
        self.assertTrue((self.folder / "a.0000.exr").exists())
        self.assert_no_file("a.0001.exr")

    def test_an_interrupt_while_a_frame_is_written_ends_them(self):
        """The reader of a stream holds the program up between two frames."""
        self.write("a.gltf", json.dumps(MOVING))
        command = [PROGRAM, "render", "a.gltf", *RENDER, "--frames", "0-2", "-o", "a.exr", "--stats", "/dev/stdout"]
        ours, its = os.pipe()
        fcntl.fcntl(its, fcntl.F_SETPIPE_SZ, 4096)
        os.write(its, b" " * 4096)  # it is full
        with subprocess.Popen(command, cwd=self.folder, stdout=its, stderr=subprocess.PIPE) as running:
            os.close(its)
            until = time.monotonic() + 60 * SLOWER
            while not (self.folder / "a.0000.exr").exists() and time.monotonic() < until:
                time.sleep(0.05)
            time.sleep(0.2 * SLOWER)
            running.send_signal(signal.SIGINT)
            time.sleep(0.2 * SLOWER)
            with open(ours, "rb") as stream:
                self.assertTrue(json.loads(stream.read())["complete"])
            told = running.stderr.read().decode()
            self.assertEqual(running.wait(timeout=60 * SLOWER), INTERRUPTED, told)
        self.assertIn("interrupted after frame 0 of 2", told)
        self.assert_no_file("a.0001.exr")

    def test_streams_have_no_number(self):
        done = self.frames("--frames", "0-1", "-o", "a.exr", "--stats", "/dev/stdout")
        self.assertEqual(done.code, DONE, done)
        self.assertEqual(done.stdout.count('"complete": true'), 2)
        with open(self.folder / "all.json", "wb") as file:
            command = [PROGRAM, "render", "a.gltf", *RENDER, "--frames", "0-1", "-o", "a.exr", "--stats", "/dev/stdout"]
            self.assertEqual(subprocess.run(command, cwd=self.folder, stdout=file, stderr=subprocess.DEVNULL).returncode, DONE)
        self.assertEqual((self.folder / "all.json").read_text().count('"complete": true'), 2)

    def test_frames_go_on_from_frames_alone(self):
        """Whether lights are those of exporters is judged by the middle of the whole animation, where this one is brighter."""
        lit = MOVING | {
            "extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 2700}]}},
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}], "scenes": [{"nodes": [0, 1, 2, 3]}],
            "nodes": [*MOVING["nodes"], {"camera": 0, "translation": [0, 0, 12]},
                      {"translation": [0, 0, 5], "extensions": {"KHR_lights_punctual": {"light": 0}}}]}
        self.assertEqual(self.frames("--frames", "0", "--fps", "4", "-o", "a.exr", "--checkpoint", "a.film", file=lit).code, DONE)
        done = self.frames("--shutter", "0,0.125", "--quiet", "-o", "b.exr", "--checkpoint", "a.0000.film", "--resume", file=lit)
        self.assert_fails(done, USAGE, "a.0000.film", "--frames: given there, not given here")

    def test_frames_that_are_too_late(self):
        """Single precision has no exposures as short that late."""
        self.assert_fails(self.frames("--frames", "0-9999990x9999990", "--fps", "1000", "-o", "a.exr"), USAGE, "--frames", "0.0005 seconds", "9999.99 seconds")
        self.assertEqual(self.frames("--frames", "86400", "-o", "hour.exr").code, DONE)

    def test_refused(self):
        for text in ("", "a", "3-", "-3", "3-1", "1-2x0", "1x", "1-2-3", "1-2x3x4", "99999999", "1 - 2", "+1"):
            self.assert_fails(self.frames(f"--frames={text}", "-o", "a.exr"), USAGE, "--frames", "0-47x4")
        for text in ("0", "-1", "inf", "a"):
            self.assert_fails(self.frames("--frames", "1", f"--fps={text}", "-o", "a.exr"), USAGE, "--fps")
        self.assert_fails(self.frames("--fps", "30", "-o", "a.exr"), USAGE, "--fps", "--frames")
        self.assert_fails(self.frames("--frames", "0-1", "-o", "a.exr", file=TINY, name="a.pbrt"), USAGE, "--frames", "glTF")
        done = subprocess.run([PROGRAM, "render", "-", "--frames", "0-1", "-o", "a.exr", *RENDER], cwd=self.folder,
                              input=json.dumps(MOVING).encode(), capture_output=True)
        self.assertEqual(done.returncode, USAGE)
        self.assertIn(b"--frames expects a file", done.stderr)
        self.assertEqual(list(self.folder.glob("*.exr")), [])


if __name__ == "__main__":
    unittest.main()
