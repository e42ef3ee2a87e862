"""What the tests of films share: scenes that show all that a render can do, and runs that are killed."""

import json
import random
import signal
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
            # Where nothing was kept since the last kills, as on a loaded machine, it gets more time.
            _, errors = program.communicate(timeout=choice.uniform(0, longest * (1 + kills / 20)))
            test.assertEqual(program.returncode, DONE, errors)
            return kills
        except subprocess.TimeoutExpired:
            program.send_signal(signal.SIGKILL)
            program.communicate()
            kills += 1
