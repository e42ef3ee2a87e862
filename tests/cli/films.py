"""Support for the tests of films: scenes that show all that a render can do, and runs that are killed."""

import json
import random
import signal
import struct
import subprocess

from support import DONE, HEADER, PROGRAM, WORLD, CliTest

METHODS = ("uniform", "covariance", "hybrid")

SIZED = HEADER.replace("xresolution\" 24", "xresolution\" 70").replace("yresolution\" 16", "yresolution\" 50")
LENS = SIZED.replace('"float fov" 40', '"float fov" 40 "float lensradius" 0.15 "float focaldistance" 6')
SKY = 'LightSource "infinite" "rgb L" [.3 .4 .6]\n'
MOVING = """\
AttributeBegin
  ActiveTransform EndTime
  Translate 0.5 0 0
  ActiveTransform All
  Material "conductor" "float roughness" 0.2
  Translate 1.5 0 1
  Shape "sphere" "float radius" 0.4
AttributeEnd
"""
SCENES = {"plain": SIZED + WORLD, "moving": LENS + WORLD + MOVING, "sky": LENS + WORLD + SKY + MOVING}


def textured_glb(png):
    """A square with a texture, a camera and a lamp, everything in one binary glTF file."""
    positions = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0)
    uvs, indices = struct.pack("<8f", 0, 1, 1, 1, 1, 0, 0, 0), struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    views, binary = [], b""
    for part in (positions, uvs, indices, png):
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(part)})
        binary += part + bytes(-len(part) % 4)
    square = {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}
    root = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 1000}]}},
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 3]},
                  {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 1, 3]}],
        "scenes": [{"nodes": [0, 1, 2]}],
        "scene": 0,
        "meshes": [{"primitives": [square]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


class FilmTest(CliTest):
    def setUp(self):
        super().setUp()
        for name, text in SCENES.items():
            self.write(f"{name}.pbrt", text)

    def run_render(self, scene, method, *arguments, code=DONE, output="out.exr", **options):
        where = ["-o", output] if output else []
        result = self.run_program(
            "render", f"{scene}.pbrt", "--method", method, *where, "--progress", "none", *arguments, **options
        )
        self.assertEqual(result.code, code, result)
        return result

    def assert_identical(self, a, b, message=""):
        result = self.run_program("compare", a, b, "--json")
        self.assertEqual(result.code, DONE, result)
        self.assertIs(json.loads(result.stdout)["identical"], True, f"{a} and {b} differ {message}")

    def assert_sound(self, film):
        result = self.run_program("info", film)
        self.assertEqual(result.code, DONE, result)
        return result.stdout


def render_killed(test, folder, arguments, seed, longest):
    """Runs one render that goes on from its checkpoint, killed after random times, until it ends. Returns the kills."""
    choice = random.Random(seed)
    kills = 0
    while True:
        program = subprocess.Popen(
            [PROGRAM, *map(str, arguments)], cwd=folder, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        )
        try:
            # A run gets more time where nothing was kept since the last kills, as on a loaded
            # machine.
            _, errors = program.communicate(timeout=choice.uniform(0, longest * (1 + kills / 20)))
            test.assertEqual(program.returncode, DONE, errors)
            return kills
        except subprocess.TimeoutExpired:
            program.send_signal(signal.SIGKILL)
            program.communicate()
            kills += 1
