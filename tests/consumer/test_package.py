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
PROGRAM_FILES = {
    "bin/covtrace",
    "share/covtrace/scenes/generate.py",
    "share/covtrace/scenes/generator/snooker.py",
    "share/bash-completion/completions/covtrace",
    "share/doc/covtrace/copyright",
    "share/fish/vendor_completions.d/covtrace.fish",
    "share/man/man1/covtrace.1",
    "share/zsh/vendor-completions/_covtrace",
}


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
        installed = {str(p) for p in self.files(prefix)}
        others = installed - PROGRAM_FILES
        self.assertLessEqual(PROGRAM_FILES, installed)
        self.assertTrue(all(p.startswith("share/covtrace/scenes/") and p.endswith(".py") for p in others), others)
        self.assertIn("covtrace", self.run_command(prefix / "bin" / "covtrace", "--version"))

    def test_debian_package_installs_and_removes(self):
        """Installs into a Debian system without any file of its own, so that nothing on this machine is touched."""
        self.run_command("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", self.folder)
        (package,) = self.folder.glob("covtrace_*.deb")
        for other in set(self.folder.glob("*.deb")) - {package}:
            self.assertRegex(other.name, r"^covtrace-mpi_\d+\.\d+\.\d+_\w+\.deb$")
            self.assertIn("libopenmpi", self.run_command("dpkg-deb", "--field", other, "Depends"))
            self.assertIn("covtrace_mpi.so", self.run_command("dpkg-deb", "--contents", other))
        self.assertRegex(package.name, r"^covtrace_\d+\.\d+\.\d+_\w+\.deb$")
        fields = self.run_command("dpkg-deb", "--field", package)
        for library in ("libembree3", "libtbb", "libopencolorio", "libopenexr", "libdraco", "libmeshoptimizer", "libwebp", "libc6"):
            self.assertIn(library, fields)
        self.assertNotIn("libopenmpi", fields)
        self.assertRegex(" ".join(fields.split()), "covtrace renders scenes .* It needs .*processor")

        root = self.folder / "root"
        for folder in ("info", "updates", "triggers"):
            (root / "var/lib/dpkg" / folder).mkdir(parents=True)
        for file in ("status", "available"):
            (root / "var/lib/dpkg" / file).touch()
        as_root = [] if os.geteuid() == 0 else ["unshare", "--map-root-user"]
        dpkg = [*as_root, "dpkg", f"--root={root}", "--force-depends", "--force-script-chrootless", "--log=/dev/null"]
        self.run_command(*dpkg, "--install", package)
        installed = {str(p) for p in self.files(root / "usr")}
        self.assertLessEqual(PROGRAM_FILES, installed)
        self.assertIn("include/covariance/covariance.hpp", installed)
        self.assertIn("covtrace", self.run_command(root / "usr/bin/covtrace", "--version"))
        for module in (root / "usr").rglob("dist-packages/covtrace"):
            (module / "__pycache__").mkdir()  # as after an import by root
            (module / "__pycache__" / "image.pyc").touch()
        self.run_command(*dpkg, "--purge", "covtrace")
        left = {str(p) for p in self.files(root) if "var/lib/dpkg" not in str(p)}
        self.assertEqual(left, set())

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
