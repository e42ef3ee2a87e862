"""What scripts/release makes, short of installing it: one version everywhere."""

import ast
import os
import pathlib
import re
import subprocess
import unittest

SOURCE = pathlib.Path(os.environ["COVTRACE_SOURCE"])
BUILD = pathlib.Path(os.environ["COVTRACE_BUILD"])
PROGRAM = os.environ["COVTRACE"]
VERSION = (SOURCE / "covariance/VERSION").read_text().strip()


def add_on_version():
    tree = ast.parse((SOURCE / "blender/covtrace_blender/__init__.py").read_text())
    return next(ast.literal_eval(node.value) for node in tree.body
                if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info")["version"]


def text_of(file):
    """Without the version of the format of Blender's manifests."""
    return re.sub(r"(?m)^schema_version .*$", "", file.read_text())


class Version(unittest.TestCase):
    """covariance/VERSION has it; CMake reads it there."""

    def test_is_three_numbers(self):
        self.assertRegex(VERSION, r"\A\d+\.\d+\.\d+\Z")

    def test_program_and_manual_page(self):
        told = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout
        self.assertRegex(told, rf"\Acovtrace {re.escape(VERSION)} \(")
        self.assertIn(f'"covtrace {VERSION}"', (BUILD / "cli/covtrace.1").read_text().splitlines()[0])

    def test_the_add_on_of_older_blenders(self):
        # Blender reads it without running the file, so that it cannot be looked up.
        self.assertEqual(".".join(map(str, add_on_version())), VERSION)

    def test_the_changelog_has_its_section(self):
        self.assertRegex((SOURCE / "CHANGELOG.md").read_text(), rf"(?m)^## {re.escape(VERSION)}( \(\d{{4}}-\d\d-\d\d\))?$")

    def test_stands_nowhere_else(self):
        """In no file that makes a package: what repeats it is forgotten at the next one."""
        files = [*SOURCE.glob("packaging/*"), *SOURCE.glob("cmake/*.cmake"), *SOURCE.rglob("CMakeLists.txt"),
                 SOURCE / "scripts/release", SOURCE / "docs/covtrace.1.in"]
        repeating = [str(f.relative_to(SOURCE)) for f in files
                     if f.is_file() and "build" not in f.relative_to(SOURCE).parts and
                     re.search(rf"(?<![\d.]){re.escape(VERSION)}(?![\d.])", text_of(f))]
        self.assertEqual([], repeating)


if __name__ == "__main__":
    unittest.main()
