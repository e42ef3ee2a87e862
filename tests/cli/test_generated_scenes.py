"""The generator of scenes, and what it makes: same bytes again, sound meshes, pictures without a warning.

Without the snooker table, whose textures take longer to draw than those of all others together, and without the
analytic planes, which have no mesh and no light that could face the wrong way."""

import math
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

import exr
from support import DONE, CliTest, warnings_of

SOURCE = pathlib.Path(os.environ.get("COVTRACE_SOURCE", pathlib.Path(__file__).resolve().parents[2]))
# Least mean of green, about half of the right one: a scene whose light is gone or faces the other
# way is darker.
SCENES = {
    "helicopter": 0.09,
    "mirror-motion": 0.05,
    "glossy-lens": 0.06,
    "bulbs": 0.02,
    "motion": 0.06,
    "defocus-checker": 0.13,
    "foliage": 0.22,
    "shininess": 0.04,
}
HELD = ["glossy-lens", "foliage"]  # quick ones, for properties of the generator


def generate(folder, *arguments):
    command = [sys.executable, SOURCE / "scenes/generate.py", "--output", folder, *arguments]
    return subprocess.run(command, capture_output=True, text=True)


def read_ply(path):
    """Positions, normals and faces of a file by write_ply."""
    data = path.read_bytes()
    header, body = data[: data.index(b"end_header\n")].decode(), data[data.index(b"end_header\n") + 11 :]
    words = [line.split() for line in header.splitlines()]
    vertices, faces = (int(line[2]) for line in words if line[0] == "element")
    table = list(struct.iter_unpack("<8f", body[: 32 * vertices]))
    triangles = [face[1:] for face in struct.iter_unpack("<Biii", body[32 * vertices :])]
    assert len(triangles) == faces
    return [v[:3] for v in table], [v[3:6] for v in table], triangles


def facing(positions, normals, face):
    """Cosine between a face's own normal and the mean of its vertices', None where it has no area."""
    a, b, c = (positions[i] for i in face)
    u, v = ([q - p for p, q in zip(a, end)] for end in (b, c))
    own = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    mean = [sum(normals[i][k] for i in face) for k in range(3)]
    area, length = math.hypot(*own), math.hypot(*mean)
    longest = max(math.dist(a, b), math.dist(b, c), math.dist(c, a))
    if area < 1e-4 * longest**2:
        return None
    return sum(p * q for p, q in zip(own, mean)) / (area * length)


class GeneratorTest(CliTest):
    def test_what_did_not_change_is_left_alone_and_the_rest_is_mended(self):
        self.assertEqual(generate(self.folder, *HELD).returncode, DONE)
        files = {path: path.stat().st_mtime_ns for path in self.folder.rglob("*") if path.is_file()}
        damaged, extra = self.folder / "foliage/scene.pbrt", self.folder / "foliage/meshes/extra.ply"
        whole = damaged.read_bytes()
        damaged.write_bytes(whole[:100])
        extra.write_bytes(b"")
        check = generate(self.folder, "--check", *HELD)
        self.assertEqual(check.returncode, 1)
        differing = ["differs: foliage/meshes/extra.ply", "differs: foliage/scene.pbrt"]
        self.assertEqual(check.stderr.splitlines(), differing)
        self.assertEqual(generate(self.folder, *HELD).returncode, DONE)
        self.assertEqual(damaged.read_bytes(), whole)
        self.assertFalse(extra.exists())
        for path, time in files.items():
            if path != damaged:
                self.assertEqual(path.stat().st_mtime_ns, time, path)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), sorted(HELD))
        self.assertEqual(generate(self.folder, "--check", *HELD).returncode, DONE)

    def test_a_folder_that_is_no_scene_is_kept(self):
        self.write("foliage/letter.txt", "mine")
        result = generate(self.folder, "foliage")
        self.assertNotEqual(result.returncode, DONE)
        self.assertIn("in the way", result.stderr)
        self.assertEqual((self.folder / "foliage/letter.txt").read_text(), "mine")


class GeneratedScenesTest(CliTest):
    @classmethod
    def setUpClass(cls):
        cls.scenes = pathlib.Path(tempfile.mkdtemp(prefix="covtrace-scenes-"))
        cls.addClassCleanup(shutil.rmtree, cls.scenes, ignore_errors=True)
        result = generate(cls.scenes, *SCENES)
        assert result.returncode == DONE, result.stderr

    def test_faces_and_normals_point_the_same_way(self):
        for path in sorted(self.scenes.rglob("*.ply")):
            with self.subTest(path.relative_to(self.scenes)):
                positions, normals, faces = read_ply(path)
                self.assertTrue(all(abs(math.hypot(*n) - 1) < 1e-4 for n in normals))
                cosines = [facing(positions, normals, face) for face in faces]
                self.assertGreater(min(c for c in cosines if c is not None), 0)

    def test_renders_without_a_warning(self):
        for name, floor in SCENES.items():
            with self.subTest(name):
                scene = self.scenes / name / "scene.pbrt"
                size = ["--resolution", "48x27", "--spp", "2", "--seed", "1"]
                result = self.run_program("render", scene, "-o", "out.exr", "--progress", "none", *size)
                self.assertEqual((result.code, warnings_of(result)), (DONE, []), result)
                image = exr.read(self.folder / "out.exr")
                for channel in "RGB":
                    self.assertTrue(all(map(math.isfinite, image.pixels[channel])))
                green = image.pixels["G"]
                self.assertGreater(sum(green) / len(green), floor)

    def test_no_salt_on_the_helicopters_floor(self):
        """The noise of the cabin's floor, as a part of its light: 0.14 where shadow rays pass the pane, 0.34 where the lamp
        behind it is met by chance alone."""
        scene = self.scenes / "helicopter/scene.pbrt"
        size = ["--resolution", "160x90", "--crop", "44,54,62,61", "--method", "uniform", "--spp", "64", "--seed", "1"]
        result = self.run_program("render", scene, "-o", "out.exr", "--progress", "none", *size)
        self.assertEqual(result.code, DONE, result)
        pixels = exr.read(self.folder / "out.exr").pixels
        noise = sum(map(math.sqrt, pixels["variance.G"])) / sum(pixels["G"])
        self.assertLess(noise, 0.2)


if __name__ == "__main__":
    unittest.main()
