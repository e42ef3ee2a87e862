"""Support for the tests of the command line: running the program, small scenes, the form of every error."""

import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import unittest
from dataclasses import dataclass

PROGRAM = os.environ.get("COVTRACE", "covtrace")
SANITIZED = os.environ.get("COVTRACE_SANITIZE") == "1"
# The library that lets operations on files fail, and what loads it before others: the address
# sanitizer wants to be the first.
LIBRARY_OF_FAILURES = os.environ.get("COVTRACE_FAIL_FILE_OPERATION", "")
PRELOAD = f"{os.environ.get('COVTRACE_PRELOAD', '')} {LIBRARY_OF_FAILURES}"
SLOWER = 40 if SANITIZED else 1  # factor of time for a sanitized program on a loaded machine

DONE, USAGE, SCENE, LIMIT, IO, INTERRUPTED, INTERNAL = 0, 2, 3, 4, 5, 6, 7

HEADER = """\
LookAt 0 1 6  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "string filename" "film.exr"
Sampler "zsobol" "integer pixelsamples" 4
Integrator "path" "integer maxdepth" 4
"""

WORLD = """\
WorldBegin
LightSource "point" "point3 from" [2 3 4] "rgb I" [10 10 10]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [3 3 3]
  Translate 0 3 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
Material "diffuse" "rgb reflectance" [.5 .4 .3]
Shape "sphere" "float radius" 1
Shape "trianglemesh" "point3 P" [-4 -1 -4  4 -1 -4  4 -1 4  -4 -1 4]
    "integer indices" [0 2 1  0 3 2]
"""

TINY = HEADER + WORLD


@dataclass
class Result:
    code: int
    stdout: str
    stderr: str

    def __str__(self):
        return f"exit code {self.code}\nstdout: {self.stdout!r}\nstderr: {self.stderr!r}"


def limits(**values):
    """A function for `before` that sets limits such as AS=2**30 in the child.

    Sanitizers: AS is left out where they need terabytes of it; the thread sanitizer writes a file of its own before main(), of
    which FSIZE=0 must not kill it.
    """
    if SANITIZED:
        values.pop("AS", None)

    def apply():
        if SANITIZED:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        for name, value in values.items():
            resource.setrlimit(getattr(resource, f"RLIMIT_{name}"), (value, value))

    return apply


class CliTest(unittest.TestCase):
    """Runs the program in a fresh folder of its own, `self.folder`."""

    def setUp(self):
        memory = "/dev/shm"
        self.folder = pathlib.Path(
            tempfile.mkdtemp(prefix="covtrace-", dir=memory if os.access(memory, os.W_OK) else None)
        )
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, name, content):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    def run_program(self, *arguments, before=None, timeout=60, folder=None, **options):
        done = subprocess.run(
            [PROGRAM, *map(str, arguments)],
            cwd=folder or self.folder,
            stdin=subprocess.DEVNULL,
            capture_output=not options,
            timeout=SLOWER * timeout,
            preexec_fn=before,
            **options,
        )
        result = Result(
            done.returncode,
            (done.stdout or b"").decode(errors="replace"),
            (done.stderr or b"").decode(errors="replace"),
        )
        self.assertGreaterEqual(result.code, 0, f"ended by a signal: {result}")
        return result

    def render(self, scene=TINY, *arguments, output="out.exr", **options):
        """Renders the text of a scene without progress; the image, if any, is self.folder / output."""
        self.write("scene.pbrt", scene)
        where = ["-o", output] if output else []
        return self.run_program(
            "render", "scene.pbrt", *where, "--progress", "none", *arguments, **options
        )

    def rendered(self, *arguments, output="out.exr", scene=TINY, **options):
        """Renders, expects success, returns the path of the image (output=None: the name that TINY's film gives)."""
        result = self.render(scene, *arguments, output=output, **options)
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(result.stdout, "", result)
        return self.folder / (output or "film.exr")

    def assert_fails(self, result, code, *fragments):
        """Asserts the exit code, nothing on stdout, and one line on stderr that holds all the fragments.

        A usage error that the parser of the command line found has a second line that tells of --help."""
        self.assertEqual(result.code, code, result)
        self.assertEqual(result.stdout, "", result)
        lines = [l for l in result.stderr.split("\n") if l and not l.startswith("Run 'covtrace --help'")]
        self.assertEqual(len(lines), 1, result)
        self.assertTrue(lines[0].startswith("covtrace: "), result)
        self.assertNotRegex(result.stderr, r"terminate called|std::|internal error", result)
        for fragment in fragments:
            self.assertIn(fragment, lines[0], result)

    def assert_fails_at(self, result, place, *fragments, code=SCENE):
        """Asserts a failure at `place`: file:line:column, at the start of the message."""
        self.assert_fails(result, code, *fragments)
        self.assertTrue(result.stderr.startswith(f"covtrace: {place}: "), result)

    def assert_no_file(self, name="out.exr"):
        self.assertFalse((self.folder / name).exists(), f"{name} was written")

    def assert_no_leftovers(self):
        left = [p.name for p in self.folder.iterdir() if ".part" in p.name or ".tmp" in p.name]
        self.assertEqual(left, [], "temporary files are left")


def place_of(text, fragment, name="scene.pbrt"):
    """The place file:line:column where `fragment` first stands in `text`."""
    before = text[: text.index(fragment)]
    column = len(before) - (before.rfind("\n") + 1) + 1
    return f"{name}:{before.count(chr(10)) + 1}:{column}"


WARNING = re.compile(r"^warning: (?:(?P<place>\S+:\d+:\d+): )?(?P<text>.+)$")


def warnings_of(result):
    """The warnings of a result, each as (place or None, text)."""
    found = [WARNING.match(line) for line in result.stderr.split("\n") if line.startswith("warning")]
    return [(m["place"], m["text"]) for m in found if m]
