"""The covariance library as other projects take it: installed, as a folder, or as copied headers."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["COVTRACE_SOURCE"])
BUILD = pathlib.Path(os.environ["COVTRACE_BUILD"])
CMAKE = os.environ.get("CMAKE", "cmake")
COMPILER = os.environ.get("CXX", "c++")
CONSUMER = pathlib.Path(__file__).parent


class Package(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="covtrace-package-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_command(self, *command):
        done = subprocess.run(list(map(str, command)), cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}\n{done.stderr}")
        return done.stdout

    def configure(self, source, build, *arguments):
        self.run_command(CMAKE, "-G", "Ninja", "-S", source, "-B", build, f"-DCMAKE_CXX_COMPILER={COMPILER}", *arguments)

    def consume(self, *arguments):
        self.configure(CONSUMER, "consumer", *arguments)
        self.run_command(CMAKE, "--build", "consumer", "--target", "consumer")
        self.assertEqual(len(self.run_command(self.folder / "consumer" / "consumer").split()), 3)

    def files(self, prefix):
        return {p.relative_to(prefix) for p in prefix.rglob("*") if p.is_file()}

    def test_installed_with_the_renderer(self):
        prefix = self.folder / "prefix"
        self.run_command(CMAKE, "--install", BUILD, "--component", "covariance", "--prefix", prefix)
        installed = self.files(prefix)
        self.assertIn(pathlib.Path("include/covariance/covariance.hpp"), installed)
        self.assertEqual({p.suffix for p in installed}, {".hpp", ".cmake"})
        moved = self.folder / "elsewhere"  # no path of the build may be in it
        prefix.rename(moved)
        self.consume(f"-DCMAKE_PREFIX_PATH={moved}")

    def test_installed_program(self):
        prefix = self.folder / "prefix"
        self.run_command(CMAKE, "--install", BUILD, "--component", "program", "--prefix", prefix)
        self.assertEqual(self.files(prefix), {pathlib.Path("bin/covtrace")})
        self.assertIn("covtrace", self.run_command(prefix / "bin" / "covtrace", "--version"))

    def test_installed_alone(self):
        prefix = self.folder / "prefix"
        self.configure(SOURCE / "covariance", "library", "-DCOVTRACE_BUILD_TESTS=OFF")
        self.run_command(CMAKE, "--install", "library", "--prefix", prefix)
        self.consume(f"-DCMAKE_PREFIX_PATH={prefix}")

    def test_as_a_folder(self):
        for folder in (SOURCE, SOURCE / "covariance"):
            with self.subTest(folder=folder.name):
                self.consume(f"-DCOVTRACE_FOLDER={folder}")
                shutil.rmtree(self.folder / "consumer")

    def test_copied_headers_and_nothing_else(self):
        shutil.copytree(SOURCE / "covariance" / "include", self.folder / "include")
        example = SOURCE / "covariance" / "examples" / "follow_a_path.cpp"
        shutil.copy(example, self.folder)
        self.run_command(COMPILER, "-std=c++20", "-Wall", "-Wextra", "-Werror", "-I", "include", example.name)
        self.assertIn("samples per pixel", self.run_command(self.folder / "a.out"))


if __name__ == "__main__":
    unittest.main()
