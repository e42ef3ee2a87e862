"""Films, shards, merging and chosen layers: the same bits as the program's."""

import os
import pathlib
import subprocess
import tempfile
import threading
import unittest
import warnings

import numpy

import covtrace
import scenes

RESOLUTION, SPP, SEED = (48, 32), 8, 5


class Films(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.scene = scenes.builder().write(folder.name)

    def render(self, **options):
        return covtrace.render(self.scene, resolution=RESOLUTION, seed=SEED, denoiser="none", **{"spp": SPP, **options})

    def program(self, *arguments):
        subprocess.run([os.environ["COVTRACE"], *map(str, arguments), "--quiet"], check=True, capture_output=True)

    def program_render(self, *arguments):
        self.program("render", self.scene, "--resolution", "48x32", "--seed", SEED, "--spp", SPP, "--denoiser", "none",
                     "--progress", "none", *arguments)

    def test_merged_shards_are_the_image_of_one_render(self):
        whole = self.render(layers="all")
        films, rounds = [self.folder / f"{k}.film" for k in (1, 2, 3)], 0
        joined = None
        while joined is None or not joined.complete:
            for k, film in enumerate(films):
                part = self.render(shard=(k + 1, 3), film=film, checkpoint=self.folder / "all.film", resume=True)
                self.assertTrue(part.complete)
                self.assertEqual(list(part.channels), [])
            joined = covtrace.merge(reversed(films), film=self.folder / "all.film", image=False)
            self.assertEqual(list(joined.channels), [])
            rounds += 1
        self.assertGreater(rounds, 1)  # a pilot, and what is planned by it
        merged = covtrace.merge([self.folder / "all.film"], layers="all", denoiser="none")
        self.assertTrue(merged.complete)
        self.assertAlmostEqual(merged.statistics["spp"], SPP, places=3)
        self.assertTrue(covtrace.compare(merged, whole).identical)

    def test_the_program_s_films_and_python_s_are_the_same(self):
        self.render(method="uniform", shard=(1, 2), film=self.folder / "p1.film")
        self.program_render("--method", "uniform", "--shard", "1/2", "--film", self.folder / "c1.film")
        self.program_render("--method", "uniform", "--shard", "2/2", "--film", self.folder / "c2.film")
        self.program("merge", self.folder / "c1.film", self.folder / "c2.film", "-o", self.folder / "c.exr",
                     "--denoiser", "none")
        merged = covtrace.merge([self.folder / "p1.film", self.folder / "c2.film"], layers="all", denoiser="none")
        self.assertTrue(covtrace.compare(merged, self.folder / "c.exr").identical)

    def test_a_missing_shard_is_told(self):
        self.render(method="uniform", shard=(2, 3), film=self.folder / "2.film")
        with self.assertWarnsRegex(covtrace.SceneWarning, "2 of its 3 shards are missing"):
            image = covtrace.merge([self.folder / "2.film"], denoiser="none")
        self.assertFalse(image.complete)
        self.assertEqual(image.statistics["present"], 1)

    def test_a_cancelled_render_goes_on_to_the_same_image(self):
        checkpoint = self.folder / "state.film"
        stop = threading.Event()

        def stop_once_sampled(progress):
            if progress.samples_per_pixel > 0:
                stop.set()

        options = {"spp": 2048, "method": "uniform", "checkpoint": checkpoint}
        part = self.render(cancel=stop, progress=stop_once_sampled, **options)
        self.assertFalse(part.complete)
        begun = part.statistics["radiance"]["samples"]
        rest = self.render(resume=True, **options)
        self.assertTrue(rest.complete)
        self.assertTrue(covtrace.compare(rest, self.render(**{**options, "checkpoint": None})).identical)
        self.assertGreater(begun, 0)

    def test_a_changed_scene_is_another_render(self):
        film = self.folder / "state.film"
        scene = covtrace.Scene(self.scene)
        options = {"denoiser": "none", "resolution": (8, 6), "method": "uniform", "checkpoint": film}
        covtrace.render(scene, spp=1, **options)
        turned = numpy.diag([2.0, 2.0, 2.0, 1.0])
        material = scene.shapes[0].material
        changes = {"fov": lambda s: s.camera.__setitem__("fov", 20),
                   "view": lambda s: s.camera.look_at((1, 1, 5), (0, 0, 0)),
                   "material": lambda s: s.materials[0].__setitem__("reflectance", 0.11),
                   "light": lambda s: s.lights[0].__setitem__("L", 3),
                   "no light": lambda s: s.remove_light(0),
                   "place": lambda s: s.shapes[0].place(turned),
                   "motion": lambda s: s.shapes[0].place(s.shapes[0].to_world, turned),
                   "assignment": lambda s: setattr(s.shapes[0], "material", (material + 1) % len(s.materials))}
        for name, change in changes.items():
            with self.subTest(name), self.assertRaisesRegex(covtrace.UsageError, "another render: scene"):
                other = scene.copy()
                change(other)
                covtrace.render(other, spp=2, resume=True, **options)
        # The values count, not the way to them.
        same = scene.copy()
        fov = same.camera["fov"]
        for change in changes["fov"], changes["assignment"]:
            change(same)
        same.shapes[0].material = material
        same.camera["fov"] = fov
        covtrace.render(same, spp=2, resume=True, **options)

    def test_what_does_not_fit(self):
        film = self.folder / "a.film"
        for options, message in [({"shard": (1, 2)}, "shard: expected a film"),
                                 ({"shard": (3, 2), "film": film}, "1 <= k <= n"),
                                 ({"shard": "12", "film": film}, "1 <= k <= n"),
                                 ({"shard": (1, 2), "film": film, "checkpoint": film}, "must differ"),
                                 ({"resume": True}, "resume: expected a checkpoint"),
                                 ({"every": 5}, "every: expected a checkpoint"),
                                 ({"film": 3}, "film is 3"), ({"film": ""}, "film is ''"),
                                 ({"checkpoint": ""}, "checkpoint is ''")]:
            with self.subTest(options), self.assertRaisesRegex(covtrace.UsageError, message):
                self.render(**options)
        with self.assertRaisesRegex(covtrace.UsageError, "films is empty"):
            covtrace.merge([])
        with self.assertRaisesRegex(covtrace.UsageError, "one of the films that are read"):
            covtrace.merge([film], film=film)
        with self.assertRaises(covtrace.SceneError):
            covtrace.merge([self.scene])
        self.render(method="uniform", film=film)
        self.render(method="uniform", film=self.folder / "b.film", spp=2 * SPP)
        with self.assertRaises(covtrace.UsageError):
            covtrace.merge([film, self.folder / "b.film"])


class Layers(unittest.TestCase):
    def layers(self, **options):
        return covtrace.render(scenes.builder(), spp=4, denoiser="none", **options).layers

    def test_chosen_layers(self):
        made = self.layers()
        self.assertIn("share", made)
        self.assertEqual(set(made) - set(self.layers(layers="all")), {"share"})
        self.assertNotIn("raw", self.layers(layers="none"))
        chosen = self.layers(layers=["raw", "featurealbedo"])
        self.assertEqual({"raw", "featurealbedo"}, set(chosen) & {"raw", "featurealbedo", "albedo", "Z", "error", "cov"})
        self.assertIn("P", self.layers(layers="all,P"))

    def test_layers_as_the_program_s(self):
        with tempfile.TemporaryDirectory() as folder:
            path = scenes.builder().write(folder)
            out = os.path.join(folder, "program.exr")
            subprocess.run([os.environ["COVTRACE"], "render", path, "-o", out, "--spp", "4", "--layers", "Z,featureN,uv",
                            "--quiet"], check=True)
            image = covtrace.render(path, spp=4, layers="Z,featureN,uv")
            self.assertTrue(covtrace.compare(image, out).identical)
            numpy.testing.assert_array_equal(image["Z"], covtrace.Image.read(out)["Z"])

    def test_unknown_and_absent_layers(self):
        with self.assertRaisesRegex(covtrace.UsageError, "layers: there is no layer 'colour'"):
            self.layers(layers="colour")
        with self.assertRaisesRegex(covtrace.UsageError, "layers is 3"):
            self.layers(layers=3)
        with self.assertWarnsRegex(covtrace.SceneWarning, "no layer 'cov'"):
            self.layers(method="uniform", layers=["cov"])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.layers(layers=["cov"])


if __name__ == "__main__":
    unittest.main()
