"""Processes of mpirun: the bits of one process, for any number of them, and after one was killed."""

import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

from films import METHODS, FilmTest
from support import DONE, PROGRAM, SANITIZED, USAGE

MODULE = pathlib.Path(PROGRAM).resolve().parent / "covtrace_mpi.so"
MPIRUN = shutil.which("mpirun")
ENVIRONMENT = {
    **os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
}


@unittest.skipUnless(MPIRUN and MODULE.exists(), "OpenMPI is not installed")
@unittest.skipIf(SANITIZED, "OpenMPI leaks")
class Ranks(FilmTest):
    def command(self, ranks, scene, method, *arguments):
        return [MPIRUN, "--oversubscribe", "-n", str(ranks), PROGRAM, "render", f"{scene}.pbrt", "--method", method,
                "-o", "out.exr", "--threads", "1", "--quiet", *arguments]

    def run_ranks(self, *arguments):
        done = subprocess.run(self.command(*arguments), cwd=self.folder, env=ENVIRONMENT, capture_output=True, timeout=120)
        self.assertEqual(done.returncode, DONE, done)

    def test_any_number_of_ranks(self):
        for method in METHODS:
            self.run_render("sky", method, "--spp", "16", output="whole.exr")
            for ranks in (2, 4):
                with self.subTest(method=method, ranks=ranks):
                    self.run_ranks(ranks, "sky", method, "--spp", "16")
                    self.assert_identical("whole.exr", "out.exr")

    def test_a_denoiser(self):
        good = pathlib.Path(os.environ["COVTRACE_FAKE_DENOISERS"], "good", "libOpenImageDenoise.so.2")
        options = ["--spp", "8", "--denoiser", "oidn", "--denoiser-library", good]
        self.run_render("sky", "hybrid", *options, output="whole.exr")
        self.run_ranks(2, "sky", "hybrid", *map(str, options))
        self.assert_identical("whole.exr", "out.exr")
        error = ["--error", "0.05", "--denoiser", "oidn", "--denoiser-library", str(good)]
        self.run_ranks(2, "sky", "hybrid", *error)

    def test_first_paths_that_time_cut_short_are_the_beginning_of_one_call(self):
        self.run_ranks(2, "sky", "hybrid", "--time", "0.1", "--film", "cut.film")
        self.run_render("sky", "hybrid", "--spp", "4", "--checkpoint", "cut.film", "--resume")
        self.run_render("sky", "hybrid", "--spp", "4", output="whole.exr")
        self.assert_identical("whole.exr", "out.exr")

    def test_an_error_of_one_rank_ends_all(self):
        for arguments, code in ((["-o", "none/x.exr"], USAGE), (["--tev", "not an address:x"], USAGE), (["--stats", "none/s.json"], USAGE)):
            with self.subTest(arguments=arguments):
                done = subprocess.run(self.command(2, "plain", "uniform", "--spp", "1", *arguments), cwd=self.folder, env=ENVIRONMENT,
                                      capture_output=True, timeout=60, text=True)
                self.assertEqual(done.returncode, code, done)
                self.assertIn("covtrace: ", done.stderr)

    def test_standard_input_is_refused(self):
        """It would reach the first process alone."""
        command = ["-" if word == "plain.pbrt" else word for word in self.command(2, "plain", "uniform", "--spp", "1")]
        done = subprocess.run(command, cwd=self.folder, env=ENVIRONMENT, capture_output=True, timeout=60, text=True, input="WorldBegin")
        self.assertEqual(done.returncode, USAGE, done)
        self.assertIn("standard input", done.stderr)

    def test_ranks_that_do_not_begin_with_the_same(self):
        """The checkpoint is in a folder of the first process alone."""
        self.run_render("plain", "uniform", "--spp", "1", "--checkpoint", "c.film")
        other = self.folder / "other"
        other.mkdir()
        shutil.copy(self.folder / "plain.pbrt", other)
        part = [PROGRAM, "render", "plain.pbrt", "--method", "uniform", "--spp", "4", "--checkpoint", "c.film", "--resume",
                "-o", "out.exr", "--threads", "1", "--quiet"]
        done = subprocess.run([MPIRUN, "--oversubscribe", "-n", "1", "--wdir", self.folder, *part, ":", "-n", "1", "--wdir", other, *part],
                              env=ENVIRONMENT, capture_output=True, timeout=60, text=True)
        self.assertEqual(done.returncode, USAGE, done)
        self.assertIn("don't begin with the same", done.stderr)

    def test_a_module_that_does_not_load_tells_why(self):
        shutil.copy(PROGRAM, self.folder / "covtrace")
        self.write("covtrace_mpi.so", b"no library")
        done = subprocess.run([self.folder / "covtrace", "render", "plain.pbrt", "-o", "out.exr"], cwd=self.folder,
                              env={**ENVIRONMENT, "OMPI_COMM_WORLD_SIZE": "2"}, capture_output=True, timeout=60, text=True)
        self.assertEqual(done.returncode, USAGE, done)
        self.assertIn("cannot be used: ", done.stderr)

    def test_a_killed_rank_and_the_same_command_again(self):
        spp = ["--spp", "96", "--checkpoint", "c.film", "--every", "0.1", "--resume"]
        self.run_render("moving", "hybrid", "--spp", "96", output="whole.exr")
        for killed in (0, 1):
            with self.subTest(rank=killed):
                for old in self.folder.glob("c.film*"):
                    old.unlink()
                run = subprocess.Popen(
                    self.command(2, "moving", "hybrid", *spp), cwd=self.folder, env=ENVIRONMENT,
                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                )
                deadline = time.monotonic() + 30
                while not (self.folder / "c.film").exists() and run.poll() is None and time.monotonic() < deadline:
                    time.sleep(0.02)
                for child in pathlib.Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text().split():
                    environment = pathlib.Path(f"/proc/{child}/environ").read_bytes()
                    if f"OMPI_COMM_WORLD_RANK={killed}\0".encode() in environment:
                        os.kill(int(child), signal.SIGKILL)
                self.assertNotEqual(run.wait(timeout=60), DONE)
                self.assert_sound("c.film")
                self.run_ranks(2, "moving", "hybrid", *spp)
                self.assert_identical("whole.exr", "out.exr")


if __name__ == "__main__":
    unittest.main()
