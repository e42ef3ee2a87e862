"""Packages that scripts/release makes: one version everywhere, a wheel and an add-on that are installed and loaded here. In clean
places `scripts/release --check` tries them."""

import ast
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest
import zipfile

SOURCE = pathlib.Path(os.environ["COVTRACE_SOURCE"])
BUILD = pathlib.Path(os.environ["COVTRACE_BUILD"])
PROGRAM = os.environ["COVTRACE"]
PYTHON = "/usr/bin/python3"
VERSION = (SOURCE / "covariance/VERSION").read_text().strip()


def add_on_version():
    tree = ast.parse((SOURCE / "blender/covtrace_blender/__init__.py").read_text())
    return next(ast.literal_eval(node.value) for node in tree.body
                if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info")["version"]


def text_of(file):
    """The text of a file without the version of the format of Blender's manifests."""
    return re.sub(r"(?m)^schema_version .*$", "", file.read_text())


class Version(unittest.TestCase):
    """The version stands in covariance/VERSION, where CMake reads it."""

    def test_is_three_numbers(self):
        self.assertRegex(VERSION, r"\A\d+\.\d+\.\d+\Z")

    def test_program_and_manual_page(self):
        told = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout
        self.assertRegex(told, rf"\Acovtrace {re.escape(VERSION)} \(")
        self.assertIn(f'"covtrace {VERSION}"', (BUILD / "cli/covtrace.1").read_text().splitlines()[0])

    def test_the_add_on_of_older_blenders(self):
        # The add-on repeats the version: Blender reads it without running the file, so that it
        # cannot be looked up.
        self.assertEqual(".".join(map(str, add_on_version())), VERSION)

    def test_the_changelog_has_its_section(self):
        self.assertRegex((SOURCE / "CHANGELOG.md").read_text(), rf"(?m)^## {re.escape(VERSION)}( \(\d{{4}}-\d\d-\d\d\))?$")

    def test_stands_nowhere_else(self):
        """No other file that makes a package has the version: a copy is forgotten at the next one."""
        files = [*SOURCE.glob("packaging/*"), *SOURCE.glob("cmake/*.cmake"), *SOURCE.rglob("CMakeLists.txt"),
                 SOURCE / "scripts/release", SOURCE / "docs/covtrace.1.in"]
        repeating = [str(f.relative_to(SOURCE)) for f in files
                     if f.is_file() and "build" not in f.relative_to(SOURCE).parts and
                     re.search(rf"(?<![\d.]){re.escape(VERSION)}(?![\d.])", text_of(f))]
        self.assertEqual([], repeating)


def run(*command, **environment):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=240,
                          env={**os.environ, **environment})


class Made(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="covtrace-release-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_command(self, *command, **environment):
        done = run(*command, **environment)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}\n{done.stderr}")
        return done.stdout


@unittest.skipUnless((SOURCE / "build/auditwheel/auditwheel").is_dir(), "needs auditwheel (scripts/fetch-auditwheel)")
@unittest.skipUnless((BUILD / "python/covtrace").is_dir(), "the Python package is not built")
@unittest.skipIf(os.environ.get("COVTRACE_PRELOAD"), "a module with sanitizers is not for wheels")
@unittest.skipUnless(run(PYTHON, "-c", "import pip, wheel").returncode == 0, "needs Debian's python3-pip and python3-wheel")
class Wheel(Made):
    def test_is_installed_and_renders_with_its_own_libraries(self):
        self.run_command(SOURCE / "packaging/wheel", BUILD, self.folder / "new/dist")
        [wheel] = (self.folder / "new/dist").glob("*.whl")
        self.assertRegex(wheel.name, rf"\Acovtrace-{re.escape(VERSION)}-(cp3\d+)-\1-manylinux_2_\d+_x86_64\.whl\Z")
        target = self.folder / "site-packages"
        self.run_command(PYTHON, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--target", target, wheel)
        told = self.run_command(PYTHON, SOURCE / "packaging/check_python.py", VERSION, SOURCE / "packaging/scene.pbrt",
                                PYTHONPATH=str(target))
        self.assertTrue(told.startswith(f"{target}/covtrace/__init__.py: {VERSION}"), told)
        [module] = (target / "covtrace").glob("_covtrace.*.so")
        outside = [line for line in self.run_command("ldd", module).splitlines() if "=> /" in line and str(target) not in line]
        self.assertLess(0, len(outside))
        for line in outside:  # what every Linux with that C library has
            self.assertRegex(line.split()[0], r"\A(lib(c|m|z|stdc\+\+|gcc_s|dl|pthread|rt)\.so\.\d+|/lib64/ld-linux.*)\Z")
        bundled = {re.sub(r"-[0-9a-f]{8}\.so.*", "", f.name) for f in (target / "covtrace.libs").iterdir()}
        self.assertLessEqual({"libembree3", "libtbb", "libOpenColorIO", "libOpenEXR-3_1", "libdraco", "libmeshoptimizer", "libwebp", "libexpat"}, bundled)
        licences = target / f"covtrace-{VERSION}.dist-info/licenses"
        self.assertLessEqual({"libembree3-3", "libtbb12", "libopencolorio2.1", "libopenexr-3-1-30", "libdraco7", "libmeshoptimizer2d", "libwebp7", "libexpat1"}, {d.name for d in licences.iterdir()})


# Enough of Blender for modules that are loaded and not used: anything, and classes to inherit from.
BPY = """
import sys
from unittest.mock import MagicMock
for name in ("bpy", "bpy_extras", "gpu", "gpu_extras", "gpu_extras.presets", "mathutils", "mathutils.bvhtree"):
    sys.modules[name] = MagicMock()
for name in ("AddonPreferences", "PropertyGroup", "Panel", "RenderEngine"):
    setattr(sys.modules["bpy"].types, name, type(name, (), {}))
sys.modules["bpy"].app.version = (4, 2, 0)
import importlib, pkgutil
package = importlib.import_module("covtrace_blender")
print(*sorted(m.name for m in pkgutil.walk_packages(package.__path__, "covtrace_blender.") if importlib.import_module(m.name)))
"""


class Extension(Made):
    def test_is_one_folder_that_blender_knows_as_an_extension_and_as_an_add_on(self):
        self.run_command(sys.executable, SOURCE / "packaging/blender-extension", self.folder / "new/dist")
        [archive] = (self.folder / "new/dist").glob("*.zip")
        self.assertEqual(archive.name, f"covtrace_blender-{VERSION}.zip")
        with zipfile.ZipFile(archive) as files:
            names = set(files.namelist())
            manifest = tomllib.loads(files.read("covtrace_blender/blender_manifest.toml").decode())
            files.extractall(self.folder)
        sources = {str(f.relative_to(SOURCE / "blender")) for f in (SOURCE / "blender/covtrace_blender").rglob("*.py")}
        self.assertEqual(names, sources | {"covtrace_blender/blender_manifest.toml", "covtrace_blender/LICENSE"})
        # Blender 4.2 asks for these keys of a manifest, and limits their lengths.
        self.assertEqual((manifest["schema_version"], manifest["version"], manifest["type"], manifest["license"]),
                         ("1.0.0", VERSION, "add-on", ["SPDX:Apache-2.0"]))
        for text in (manifest["tagline"], *manifest["permissions"].values()):
            self.assertLessEqual(len(text), 64)
            self.assertRegex(text, r"\w\Z")
        self.assertRegex(manifest["blender_version_min"], r"\A4\.[2-9]\.\d\Z")
        self.assertTrue(manifest["id"].isidentifier() and manifest["name"] and manifest["maintainer"])
        loaded = self.run_command(PYTHON, "-B", "-c", BPY, PYTHONPATH=str(self.folder))
        modules = {name.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for name in sources}
        self.assertEqual(set(loaded.split()), modules - {"covtrace_blender"})


if __name__ == "__main__":
    unittest.main()
