"""Processors without the instructions that the build is compiled for are refused with a message, where the program and
the Python module would otherwise end by a signal. Other processors are emulated: Debian's package qemu-user."""

import os
import pathlib
import shutil
import subprocess
import unittest

PROGRAM = os.environ["COVTRACE"]
BUILD = pathlib.Path(os.environ["COVTRACE_BUILD"])
PYTHON = "/usr/bin/python3"
EMULATOR = shutil.which("qemu-x86_64")
# Processors of the emulator: the last of its maker's before AVX, and one with all that the emulator
# has.
WITHOUT, WITH = "Nehalem", "max"


def march():
    return next((line.split("=", 1)[1].strip() for line in open(BUILD / "CMakeCache.txt")
                 if line.startswith("COVTRACE_MARCH:")), "")


@unittest.skipUnless(march() == "x86-64-v3", "this build is not for x86-64-v3 (preset release)")
@unittest.skipUnless(EMULATOR, "needs qemu-x86_64 (scripts/install-dependencies --release)")
class Processor(unittest.TestCase):
    def on(self, processor, *command):
        return subprocess.run([EMULATOR, "-cpu", processor, *command], capture_output=True, text=True, timeout=120,
                              env={**os.environ, "PYTHONPATH": str(BUILD / "python")})

    def test_the_program_says_what_is_missing(self):
        done = self.on(WITHOUT, PROGRAM, "--version")
        self.assertEqual((done.returncode, done.stdout), (4, ""), done.stderr)
        self.assertRegex(done.stderr, r"\Acovtrace: this build needs a processor with AVX2[^\n]*PRESET=portable[^\n]*\n\Z")

    def test_the_program_runs_where_nothing_is_missing(self):
        done = self.on(WITH, PROGRAM, "--version")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"\Acovtrace \d")

    @unittest.skipUnless((BUILD / "python/covtrace").is_dir(), "the Python package is not built")
    def test_python_gets_an_exception(self):
        done = self.on(WITHOUT, PYTHON, "-B", "-c", "import covtrace")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, r"\nImportError: covtrace: this build needs a processor with AVX2[^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()
