"""Renders in all combinations of threads, ranks, methods, scenes, killed or not: the same bits in every one. The nightly
test runs it.

    COVTRACE=build/release/covtrace python3 -m unittest film_matrix        # in this folder
"""

import itertools
import os
import pathlib
import random
import signal
import subprocess
import time
import unittest

from films import LENS, METHODS, MOVING, SCENES, SIZED, SKY, FilmTest
from support import DONE, PROGRAM, SANITIZED, WORLD
from test_mpi import ENVIRONMENT, MODULE, MPIRUN

THREADS, RANKS = (1, 2, 3, 8), (1, 2, 4)
SIZE = ["--spp", "12", "--resolution", "40x30"]
GLASS = """\
AttributeBegin
  Material "dielectric" "float eta" 1.5
  Translate -1.6 0 1
  Shape "sphere" "float radius" 0.5
AttributeEnd
"""
MIST = 'MakeNamedMedium "mist" "string type" "homogeneous" "rgb sigma_s" [.1 .1 .1] "rgb sigma_a" [.02 .02 .02]\n'
IN_MIST = MIST + 'MediumInterface "" "mist"\n' + LENS
ALL_SCENES = {**SCENES, "glass": SIZED + WORLD + SKY + GLASS, "mist": IN_MIST + WORLD + MOVING}


def ranks_of(run):
    """The processes that mpirun started."""
    try:
        children = pathlib.Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text().split()
    except OSError:
        return []
    found = []
    for child in children:
        try:
            if b"OMPI_COMM_WORLD_RANK=" in pathlib.Path(f"/proc/{child}/environ").read_bytes():
                found.append(int(child))
        except OSError:  # it has just ended
            pass
    return found


@unittest.skipUnless(MPIRUN and MODULE.exists(), "OpenMPI is not installed")
@unittest.skipIf(SANITIZED, "OpenMPI leaks")
class Matrix(FilmTest):
    def setUp(self):
        super().setUp()
        for name, text in ALL_SCENES.items():
            self.write(f"{name}.pbrt", text)

    def command(self, scene, method, threads, ranks):
        start = [MPIRUN, "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
        return [*start, PROGRAM, "render", f"{scene}.pbrt", "--method", method, *SIZE, "--threads", str(threads),
                "-o", "out.exr", "--quiet", "--checkpoint", "c.film", "--every", "0.01", "--resume"]

    def start(self, command):
        return subprocess.Popen(command, cwd=self.folder, env=ENVIRONMENT, stdin=subprocess.DEVNULL,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def kill(self, run, choice):
        """Kills one of the processes that render; the others of mpirun end with it. Returns whether there was one."""
        targets = ranks_of(run) if run.args[0] == MPIRUN else [run.pid]
        if targets and run.poll() is None:
            try:
                os.kill(choice.choice(targets), signal.SIGKILL)
                return True
            except ProcessLookupError:
                pass
        return False

    def end(self, run):
        """The messages of a run until its end. mpirun itself may wait for ever for a process that died while it
        started them: it is killed once none of its processes lives; one that lives is a failure."""
        for _ in range(12):
            try:
                return run.communicate(timeout=10)[1]
            except subprocess.TimeoutExpired:
                if run.args[0] == MPIRUN and not ranks_of(run):
                    run.kill()
        run.kill()
        self.fail(f"{run.communicate()[1]} it does not end, though one of its processes was killed")

    def render(self, command, choice, seconds):
        """Renders until the program ends by itself; with `seconds` it is killed at least once after at most about so
        long. Returns the kills."""
        kills = 0
        for _ in range(200):
            run = self.start(command)
            try:
                limit = choice.uniform(0, seconds * (1 + kills / 5)) if seconds else 300
                _, errors = run.communicate(timeout=limit)
            except subprocess.TimeoutExpired:
                kills += self.kill(run, choice)
                errors = self.end(run)
            if run.returncode == DONE:
                return kills
            self.assertTrue(seconds and kills, errors)
        self.fail("it never came to its end")

    def test_every_combination(self):
        renders = kills = 0
        for scene, method in itertools.product(ALL_SCENES, METHODS):
            self.run_render(scene, method, *SIZE, "--threads", "2", output="whole.exr")
            for ranks, threads in itertools.product(RANKS, THREADS):
                for killed in (False, True):
                    with self.subTest(scene=scene, method=method, ranks=ranks, threads=threads, killed=killed):
                        for old in [*self.folder.glob("c.film*"), *self.folder.glob("out.exr")]:
                            old.unlink()
                        start = time.monotonic()
                        done = self.render(self.command(scene, method, threads, ranks),
                                           random.Random(f"{scene}{method}{ranks}{threads}"), seconds if killed else None)
                        seconds = time.monotonic() - start
                        self.assert_identical("whole.exr", "out.exr", f"after {done} kills")
                        self.assertIn("; complete", self.assert_sound("c.film"))
                        renders, kills = renders + 1, kills + done
        print(f"{renders} combinations, {kills} kills, all identical")
        self.assertEqual(renders, len(ALL_SCENES) * len(METHODS) * len(THREADS) * len(RANKS) * 2)


if __name__ == "__main__":
    unittest.main()
