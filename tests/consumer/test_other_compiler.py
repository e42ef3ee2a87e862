"""The covariance library alone and all of its tests with the compiler that this build does not use, warnings as errors."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["COVTRACE_SOURCE"])
CMAKE = os.environ.get("CMAKE", "cmake")
OTHER = "g++" if "clang" in pathlib.Path(os.environ.get("CXX", "c++")).name else "clang++"


@unittest.skipUnless(shutil.which(OTHER), f"{OTHER} is not installed")
class OtherCompiler(unittest.TestCase):
    def test_builds_and_passes_alone(self):
        with tempfile.TemporaryDirectory(prefix="covtrace-other-compiler-") as folder:

            def run(*command):
                done = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}\n{done.stderr}")
                return done.stdout

            # Copy the library without anything of the renderer beside it
            shutil.copytree(SOURCE / "covariance", pathlib.Path(folder) / "covariance")
            run(CMAKE, "-G", "Ninja", "-S", "covariance", "-B", "build", f"-DCMAKE_CXX_COMPILER={OTHER}")
            run(CMAKE, "--build", "build", "-j", "2")
            # The example is built by every compiler in covariance.example.path_tracer
            tested = run("ctest", "--test-dir", "build", "--output-on-failure", "-E", "example.path_tracer")
            self.assertIn("100% tests passed", tested)
            self.assertIn("covariance.oracle", tested)
            self.assertIn("covariance.example", tested)


if __name__ == "__main__":
    unittest.main()
