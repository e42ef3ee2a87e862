"""Checkpoints: a render that was ended, in whatever way and moment, goes on to the same bits."""

import math
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest

import exr
from films import METHODS, SCENES, FilmTest, render_killed, textured_glb
from support import DONE, INTERRUPTED, IO, PROGRAM, SCENE, SLOWER, USAGE, limits

# Least kills of each scene and method; the nightly test wants more.
KILLS = int(os.environ.get("COVTRACE_KILLS", "3"))


class Killed(FilmTest):
    def test_killed_renders_end_the_same(self):
        all_renders = all_kills = 0
        for method in METHODS:
            for i, scene in enumerate(SCENES):
                with self.subTest(method=method, scene=scene):
                    spp = ["--spp", "48"]
                    start = time.monotonic()
                    self.run_render(scene, method, *spp, output="whole.exr")
                    seconds = time.monotonic() - start
                    film = f"{method}-{scene}.film"
                    arguments = ["render", f"{scene}.pbrt", "--method", method, "-o", "out.exr", *spp, "--quiet",
                                 "--checkpoint", film, "--every", "0.02", "--resume", "--threads", 1 + i]
                    kills, renders = 0, 0
                    while kills < KILLS:
                        for old in self.folder.glob(film + "*"):
                            old.unlink()
                        kills += render_killed(self, self.folder, arguments, f"{method}{scene}{renders}", 0.7 * seconds)
                        renders += 1
                        self.assert_identical("whole.exr", "out.exr", f"after {kills} kills, {renders} renders")
                        self.assertIn("; complete", self.assert_sound(film))
                        self.assert_no_leftovers()
                    all_renders, all_kills = all_renders + renders, all_kills + kills
        print(f"{all_renders} renders, {all_kills} kills, all identical")

    def test_something_is_kept_between_two_kills(self):
        """A render that is killed each time after a while that is too short for the whole ends nevertheless."""
        start = time.monotonic()
        self.run_render("moving", "hybrid", "--spp", "128", output="whole.exr")
        seconds = time.monotonic() - start
        arguments = ["render", "moving.pbrt", "-o", "out.exr", "--spp", "128", "--quiet",
                     "--checkpoint", "c.film", "--every", "0.02", "--resume"]
        for _ in range(60):
            try:
                done = subprocess.run([PROGRAM, *arguments], cwd=self.folder, timeout=0.6 * seconds, capture_output=True)
                self.assertEqual(done.returncode, DONE, done)
                break
            except subprocess.TimeoutExpired:
                pass
        else:
            self.fail("it never came to its end")
        self.assert_identical("whole.exr", "out.exr")


class Interrupted(FilmTest):
    def interrupt(self, arguments, number, after):
        program = subprocess.Popen(
            [PROGRAM, *arguments, "--progress", "json"], cwd=self.folder, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )
        try:
            for line in program.stderr:
                match = re.search(r'"fraction":\s*([0-9.e-]+)', line)
                if match and float(match[1]) >= after:
                    break
            sent = time.monotonic()
            # SIGHUP comes twice: the system and the shell both tell of a terminal that is closed.
            for _ in range(2 if number == signal.SIGHUP else 1):
                program.send_signal(number)
                time.sleep(0.01)
            program.communicate(timeout=60 * SLOWER)
            return program.returncode, time.monotonic() - sent
        finally:
            program.kill()
            program.communicate()

    def test_signals_leave_a_checkpoint_and_an_image(self):
        for method in METHODS:
            for number, after in ((signal.SIGINT, 0.001), (signal.SIGTERM, 0.3), (signal.SIGHUP, 0.1)):
                with self.subTest(method=method, signal=number.name):
                    # A render that was done before the signal came is tried again with more samples.
                    for spp in ("200", "800", "3200", "12800"):
                        common = ["render", "moving.pbrt", "--method", method, "--spp", spp, "--checkpoint", "c.film"]
                        for film in self.folder.glob("c.film*"):
                            film.unlink()
                        code, seconds = self.interrupt([*common, "-o", "part.exr"], number, after)
                        if code == INTERRUPTED:
                            break
                    self.assertEqual(code, INTERRUPTED)
                    self.assertLess(seconds, 3 * SLOWER)  # one second, and what a loaded machine adds
                    image = exr.read(self.folder / "part.exr")
                    self.assertEqual(image.value("complete"), 0)
                    self.assertTrue(all(map(math.isfinite, image.pixels["R"])))
                    self.assertGreater(sum(image.pixels["samples.Y"]), 0)
                    self.assertIn("not complete", self.assert_sound("c.film"))
                    self.run_render("moving", method, *common[4:], "--resume")
                    self.run_render("moving", method, "--spp", spp, output="whole.exr")
                    self.assert_identical("whole.exr", "out.exr")

    def test_nohup_goes_on(self):
        arguments = ["render", "moving.pbrt", "--method", "uniform", "--spp", "800", "-o", "out.exr"]
        ignored = signal.signal(signal.SIGHUP, signal.SIG_IGN)
        try:
            code, _ = self.interrupt(arguments, signal.SIGHUP, 0.001)
        finally:
            signal.signal(signal.SIGHUP, ignored)
        self.assertEqual(code, DONE)
        self.assertEqual(exr.read(self.folder / "out.exr").value("complete"), 1)


class MoreSamples(FilmTest):
    def test_a_finished_film_takes_more_samples(self):
        """A film goes on from the end of one round to that of another, as in one call."""
        on_demand = ("covariance", "--progressive", "--density", "thesis")
        for method, *options in [*([m] for m in METHODS), on_demand]:
            for first in ("16", "32"):
                with self.subTest(method=method, options=options, first=first):
                    film = f"{method}{len(options)}{first}.film"
                    self.run_render("sky", method, *options, "--spp", first, "--film", film)
                    self.run_render("sky", method, *options, "--spp", "64", "--checkpoint", film, "--resume")
                    self.run_render("sky", method, *options, "--spp", "64", output="whole.exr")
                    self.assert_identical("whole.exr", "out.exr")
                    self.assertAlmostEqual(exr.read(self.folder / "out.exr").value("spp"), 64, delta=0.1)

    def test_counts_within_the_pilot_are_those_of_one_call(self):
        """The first rounds of hybrid are even: 1, 2 and 3 samples are its beginning, whatever comes later."""
        self.run_render("sky", "hybrid", "--spp", "1", "--film", "steps.film")
        for spp in ("2", "3", "16"):
            with self.subTest(spp=spp):
                self.run_render("sky", "hybrid", "--spp", spp, "--checkpoint", "steps.film", "--resume")
                self.run_render("sky", "hybrid", "--spp", spp, output="whole.exr")
                self.assert_identical("whole.exr", "out.exr")

    def test_a_pilot_that_time_cut_short_is_the_beginning_of_one_call(self):
        cut = 0
        for seconds in ("0.1", "0.4", "1"):
            with self.subTest(seconds=seconds):
                film = f"{seconds}.film"
                large = ["--resolution", "300x200", "--denoiser", "none"]
                self.run_render("sky", "hybrid", *large, "--time", seconds, "--film", film)
                if exr.read(self.folder / "out.exr").value("spp") > 4:
                    continue  # beyond the pilot the plan knows of the samples so far
                self.run_render("sky", "hybrid", *large, "--spp", "8", "--checkpoint", film, "--resume")
                self.run_render("sky", "hybrid", *large, "--spp", "8", output="whole.exr")
                self.assert_identical("whole.exr", "out.exr")
                cut += 1
        self.assertGreater(cut, 0)

    def test_a_time_that_is_not_reached_changes_nothing(self):
        for method in METHODS:
            for options in (["--spp", "16"], ["--spp", "16", "--cov-spp", "0.3"], ["--spp", "16", "--cov-spp", "3"]):
                if method == "uniform":
                    options = options[:2]
                with self.subTest(method=method, options=options):
                    options = [*options, "--denoiser", "none"]
                    self.run_render("sky", method, *options, "--time", "1h")
                    self.run_render("sky", method, *options, output="whole.exr")
                    self.assert_identical("whole.exr", "out.exr")

    def test_any_other_count_is_reached_too(self):
        for method in METHODS:
            with self.subTest(method=method):
                self.run_render("plain", method, "--spp", "3", "--film", f"{method}.film")
                self.run_render("plain", method, "--spp", "20", "--checkpoint", f"{method}.film", "--resume")
                image = exr.read(self.folder / "out.exr")
                self.assertAlmostEqual(image.value("spp"), 20, delta=0.1)
                self.assertEqual(image.value("complete"), 1)

    def test_the_same_again_gives_the_same_image(self):
        for method in METHODS:
            with self.subTest(method=method):
                film = f"{method}.film"
                self.run_render("sky", method, "--spp", "12", "--film", film, output="1.exr")
                self.run_render("sky", method, "--spp", "12", "--checkpoint", film, "--resume", output="2.exr")
                self.run_program("merge", film, "-o", "3.exr")
                self.assert_identical("1.exr", "2.exr")
                self.assert_identical("1.exr", "3.exr")


class Refused(FilmTest):
    def refuse(self, *arguments, scene="plain", code=USAGE, fragments=()):
        result = self.run_program(
            "render", f"{scene}.pbrt", "-o", "out.exr", "--checkpoint", "c.film", "--resume", "--quiet", *arguments
        )
        self.assert_fails(result, code, *fragments)

    def test_other_renders(self):
        self.run_render("plain", "covariance", "--spp", "2", "--film", "c.film", "--seed", "5", output="first.exr")
        same = ["--method", "covariance", "--seed", "5"]
        for arguments, name in (
            (["--method", "uniform", "--seed", "5"], "--method"),
            (["--method", "covariance", "--seed", "6"], "--seed: 5, not 6"),
            ([*same, "--max-depth", "2"], "--max-depth"),
            ([*same, "--cov-spp", "3"], "--cov-spp"),
            ([*same, "--max-spp", "30"], "--max-spp"),
            ([*same, "--density", "thesis"], "--density"),
            ([*same, "--filter", "thesis"], "--filter"),
            ([*same, "--filter", "matched"], "--filter"),
            ([*same, "--occlusion", "voxels"], "--occlusion"),
            ([*same, "--occlusion", "none"], "--occlusion"),
            ([*same, "--brdf-covariance", "global"], "--brdf-covariance"),
            ([*same, "--resolution", "64x50"], "--resolution"),
            ([*same, "--crop", "0,0,20,20"], "--crop"),
            ([*same, "--focus", "3"], "--focus"),
            ([*same, "--fstop", "3"], "--fstop"),
            ([*same, "--shutter", "0,0.5"], "--shutter"),
            ([*same, "--isa", "sse2"], "instruction set"),
            ([*same, "--guides", "none"], "--guides: auto, not none"),
            ([*same, "--progressive"], "--progressive: not given there, given here"),
        ):
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, fragments=("c.film", name))
                self.assert_no_file()
        self.refuse(*same, scene="sky", fragments=("c.film", "scene: "))
        for arguments in (["--spp", "3"], ["--threads", "1", "--spp", "2"], ["--png", "x.png", "--spp", "1"], ["--time", "0.5"]):
            with self.subTest(changed=arguments):
                self.run_render("plain", "covariance", *same[2:], *arguments, "--checkpoint", "c.film", "--resume")

    def test_damaged_films(self):
        self.run_render("plain", "uniform", "--spp", "1", "--film", "c.film")
        film = (self.folder / "c.film").read_bytes()
        for name, content in {"cut": film[:-30], "changed": film[:3000] + b"x" + film[3001:], "other": b"text"}.items():
            with self.subTest(name=name):
                self.write("c.film", content)
                self.refuse("--method", "uniform", code=SCENE, fragments=("c.film",))
        self.write("c.film.prev", film)
        self.run_render("plain", "uniform", "--spp", "1", "--checkpoint", "c.film", "--resume")

    def test_other_images(self):
        self.run_render("plain", "uniform", "--spp", "1", "--png", "map.png")
        textured = SCENES["plain"].replace(
            'Material "diffuse" "rgb reflectance" [.5 .4 .3]',
            'Texture "map" "spectrum" "imagemap" "string filename" "map.png"\nMaterial "diffuse" "texture reflectance" "map"',
        )
        self.write("textured.pbrt", textured)
        film = ["--spp", "1", "--checkpoint", "t.film", "--resume"]
        self.run_render("textured", "uniform", *film)
        self.run_render("textured", "uniform", *film)
        self.run_render("plain", "uniform", "--spp", "1", "--seed", "3", "--png", "map.png")
        result = self.run_program("render", "textured.pbrt", "-o", "out.exr", "--method", "uniform", *film, "--quiet")
        self.assert_fails(result, USAGE, "images: ")

    def test_images_within_the_scene_file(self):
        """A glTF file that embeds its texture is covered by the hash of the file."""
        self.run_render("plain", "uniform", "--spp", "1", "--png", "map.png")
        spp = ["--spp", "1", "--checkpoint", "t.film", "--resume", "--method", "uniform", "--resolution", "20x10", "--quiet"]
        for seed in ("0", "3"):
            self.run_render("plain", "uniform", "--spp", "1", "--seed", seed, "--png", "map.png")
            self.write("textured.glb", textured_glb((self.folder / "map.png").read_bytes()))
            result = self.run_program("render", "textured.glb", "-o", "out.exr", *spp)
            if seed == "0":
                self.assertEqual(result.code, DONE, result)
            else:
                self.assert_fails(result, USAGE, "scene: ")

    def test_a_checkpoint_behind_a_link_to_another_file_system(self):
        elsewhere = pathlib.Path(tempfile.mkdtemp(dir="/var/tmp"))
        self.addCleanup(shutil.rmtree, elsewhere, ignore_errors=True)
        if elsewhere.stat().st_dev == self.folder.stat().st_dev:
            self.skipTest("there is only one file system")
        (self.folder / "c.film").symlink_to(elsewhere / "real.film")
        (elsewhere / "real.film").touch()
        for spp in ("1", "2", "3"):
            self.run_render("plain", "uniform", "--spp", spp, "--checkpoint", "c.film", *(["--resume"] if spp != "1" else []))
        self.assertTrue((self.folder / "c.film").is_symlink())
        self.assertIn("3 samples per pixel", self.assert_sound("c.film"))
        self.assertIn("2 samples per pixel", self.assert_sound(elsewhere / "real.film.prev"))
        self.write(elsewhere / "real.film", b"damaged")
        self.run_render("plain", "uniform", "--spp", "4", "--checkpoint", "c.film", "--resume")

    def test_a_damaged_film_behind_a_link_is_set_aside_where_it_is(self):
        """The link of a damaged film stays, and the next film goes where it leads to."""
        (self.folder / "elsewhere").mkdir()
        real = self.write("elsewhere/real.film", b"damaged")
        (self.folder / "c.film").symlink_to(real)
        self.run_render("plain", "uniform", "--spp", "1", "--film", "good.film")
        (self.folder / "good.film").rename(self.folder / "elsewhere/real.film.prev")
        self.run_render("plain", "uniform", "--spp", "2", "--checkpoint", "c.film", "--resume")
        self.assertTrue((self.folder / "c.film").is_symlink())
        self.assertEqual((self.folder / "elsewhere/real.film.damaged").read_bytes(), b"damaged")
        self.assertIn("2 samples per pixel", self.assert_sound(real))
        self.assertFalse((self.folder / "c.film.damaged").is_symlink())

    def test_a_damaged_film_never_takes_the_place_of_the_good_one(self):
        for spp in ("1", "2"):
            self.run_render("plain", "uniform", "--spp", spp, "--checkpoint", "c.film", *(["--resume"] if spp != "1" else []))
        self.write("c.film", b"damaged")
        good = (self.folder / "c.film.prev").read_bytes()
        # The disk is full from here on: the good film stays.
        result = self.run_program("render", "plain.pbrt", "-o", "/dev/null", "--method", "uniform", "--spp", "3", "--checkpoint", "c.film",
                                  "--resume", "--progress", "none", before=limits(FSIZE=1000))
        self.assert_fails_in_writing(result)
        self.assertEqual((self.folder / "c.film.prev").read_bytes(), good)
        self.assertEqual((self.folder / "c.film.damaged").read_bytes(), b"damaged")
        self.run_render("plain", "uniform", "--spp", "3", "--checkpoint", "c.film", "--resume")
        self.assertEqual((self.folder / "c.film.damaged").read_bytes(), b"damaged")
        self.assertEqual(len(list(self.folder.glob("c.film*"))), 3)

    def assert_fails_in_writing(self, result):
        self.assertEqual(result.code, IO, result)
        self.assertIn("c.film.damaged", result.stderr)

    def test_temporary_files_of_other_machines_stay(self):
        self.run_render("plain", "uniform", "--spp", "1", "--checkpoint", "c.film")
        dead = subprocess.Popen(["true"])
        dead.wait()
        own, other = (self.folder / f"c.film.part-{host}-{dead.pid}" for host in (socket.gethostname(), "elsewhere"))
        own.touch()
        other.touch()
        shard = ["--shard", "1/2", "--film", "part.film", "--checkpoint", "c.film", "--resume"]
        self.run_render("plain", "uniform", "--spp", "2", *shard, output=None)
        self.assertTrue(own.exists(), "a shard cleaned up after others")
        self.run_render("plain", "uniform", "--spp", "2", "--checkpoint", "c.film", "--resume")
        self.assertFalse(own.exists())
        self.assertTrue(other.exists())

    def test_without_a_checkpoint_it_starts_afresh(self):
        self.run_render("plain", "hybrid", "--spp", "2", "--checkpoint", "c.film", "--resume")
        self.run_render("plain", "hybrid", "--spp", "2", output="whole.exr")
        self.assert_identical("whole.exr", "out.exr")

    def test_options_that_need_others(self):
        for arguments in (["--resume"], ["--every", "5"], ["--shard", "1/2"], ["--shard", "1/2", "--film", "a", "--png", "b"],
                          ["--shard", "1/2", "--film", "a", "--time", "5"], ["--shard", "1/2", "--film", "a", "--tev", "localhost"]):
            with self.subTest(arguments=arguments):
                result = self.run_program("render", "plain.pbrt", *arguments)
                self.assert_fails(result, USAGE, arguments[0])


if __name__ == "__main__":
    unittest.main()
