"""Runs the tests of this folder inside Blender: all, or those that COVTRACE_TESTS names, as test_camera.CameraTest."""

import os
import pathlib
import sys
import unittest

here = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(here))

names = os.environ.get("COVTRACE_TESTS", "").split() or sorted(file.stem for file in here.glob("test_*.py"))
result = unittest.main(module=None, argv=["run_tests", *names], exit=False, verbosity=2).result
sys.stdout.flush()
# Blender's own exit code knows nothing of failed tests.
os._exit(0 if result.wasSuccessful() else 1)
