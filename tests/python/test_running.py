"""covtrace.start: renders beside the program that started them, and images between rounds."""

import asyncio
import pathlib
import tempfile
import threading
import unittest
import warnings

import numpy

import covtrace
import scenes

LONG = {"method": "hybrid", "spp": 1e6, "resolution": (96, 64)}


class Running(unittest.TestCase):
    def scene(self):
        return covtrace.Scene.from_string(scenes.LIT)

    def test_the_result_is_that_of_render(self):
        options = {"spp": 8, "resolution": (40, 30), "seed": 3}
        running = covtrace.start(self.scene(), **options)
        image = running.result(timeout=60)
        self.assertTrue(running.done())
        self.assertIs(running.image, image)
        self.assertTrue(covtrace.compare(image, covtrace.render(self.scene(), **options)).identical)
        self.assertIn("done", repr(running))
        with self.assertRaisesRegex(AttributeError, r"no attribute 'wait'; result\(\) waits"):
            running.wait()
        self.assertEqual((running.progress.fraction, running.progress.remaining), (1, 0))
        self.assertAlmostEqual(running.progress.samples_per_pixel, image.statistics["spp"])
        self.assertEqual(running.progress.elapsed, image.statistics["seconds_total"])

    def test_images_and_progress_until_it_is_cancelled(self):
        seen, told, several = [], [], threading.Event()

        def preview(image):
            seen.append(image)
            if len(seen) > 2:
                several.set()

        running = covtrace.start(self.scene(), **LONG, preview=preview, progress=told.append)
        self.assertTrue(several.wait(60))
        self.assertFalse(running.done())
        with self.assertRaises(TimeoutError):
            running.result(timeout=0.01)
        self.assertIn(running.progress.phase, repr(running))
        self.assertIsInstance(running.image, covtrace.Image)
        running.cancel()
        image = running.result(timeout=60)
        self.assertFalse(image.complete)
        self.assertLess(running.progress.fraction, 1)
        self.assertGreater(len(told), 0)
        # Each image has more samples than the one before, and shows the same scene
        counts = [float(i["samples"].mean()) for i in (*seen, image)]
        self.assertEqual(counts, sorted(counts))
        self.assertLess(counts[0], counts[2])
        for so_far in seen:
            self.assertFalse(so_far.complete)
            self.assertEqual(so_far.metadata["complete"], 0)
            self.assertAlmostEqual(so_far.metadata["spp"], float(so_far["samples"].mean()), places=3)
        self.assertEqual(seen[0].rgb.shape, (64, 96, 3))
        self.assertAlmostEqual(float(seen[0].rgb.mean() / image.rgb.mean()), 1, delta=0.2)

    def test_coroutines(self):
        async def both():
            first, second = (covtrace.start(self.scene(), spp=2, resolution=(16, 12), seed=s) for s in (1, 2))
            return await first, await second

        first, second = asyncio.run(both())
        self.assertFalse(covtrace.compare(first, second).identical)

        async def given_up():
            running = covtrace.start(self.scene(), **LONG)
            with self.assertRaises(asyncio.TimeoutError):
                await asyncio.wait_for(running, 0.2)
            return running

        # Who gives up waiting ends the render, too
        self.assertFalse(asyncio.run(given_up()).result(timeout=60).complete)

    def test_errors_come_with_the_result(self):
        with self.assertRaises(covtrace.SceneError):
            covtrace.start("no-such-file.pbrt").result(timeout=60)
        with self.assertRaises(covtrace.UsageError):
            covtrace.start(self.scene(), spp=-1).result(timeout=60)
        with self.assertRaises(TypeError):
            covtrace.start(self.scene(), cancel=threading.Event())

        def failing(image):
            raise ZeroDivisionError

        with self.assertRaises(ZeroDivisionError):
            covtrace.start(self.scene(), **LONG, preview=failing).result(timeout=60)

    def test_warnings_are_of_the_line_that_began_it(self):
        replaced = scenes.LIT.replace("WorldBegin", 'Integrator "sppm"\nWorldBegin', 1)
        options = {"method": "uniform", "spp": 1, "resolution": (8, 6)}
        built = covtrace.SceneBuilder()  # shapes without lights
        built.camera(eye=(0, 0, 4), target=(0, 0, 0), fov=40, resolution=(8, 6))
        built.mesh(numpy.eye(3), [[0, 1, 2]])
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "scene.pbrt")
            file.write_text(replaced)
            begin = {"start": lambda: covtrace.start(file, **options).result(60), "render": lambda: covtrace.render(file, **options),
                     "of a builder": lambda: covtrace.start(built, **options).result(60)}
            for name, function in begin.items():
                with self.subTest(name), warnings.catch_warnings(record=True) as told:
                    warnings.simplefilter("always")
                    function()
                    self.assertTrue(told)
                    for warning in told:
                        self.assertIs(warning.category, covtrace.SceneWarning)
                        self.assertEqual((warning.filename, warning.lineno), (function.__code__.co_filename, function.__code__.co_firstlineno))

    def test_done_callbacks(self):
        called = threading.Event()
        running = covtrace.start(self.scene(), spp=1, resolution=(8, 8))
        running.add_done_callback(lambda r: called.set() if r is running else None)
        self.assertTrue(called.wait(60))


class Previews(unittest.TestCase):
    def test_the_calling_thread_gets_images_of_every_method(self):
        for method in ("uniform", "covariance", "hybrid"):
            with self.subTest(method):
                stop, threads, images = threading.Event(), set(), []

                def preview(image):
                    threads.add(threading.get_ident())
                    images.append(image)
                    stop.set()

                options = {**LONG, "method": method, "max_spp": 10**6} if method == "covariance" else {**LONG, "method": method}
                covtrace.render(covtrace.Scene.from_string(scenes.LIT), **options, preview=preview, cancel=stop)
                self.assertEqual(threads, {threading.get_ident()})
                self.assertTrue(numpy.isfinite(images[0].rgb).all())

    def test_they_do_not_change_the_image(self):
        scene, options = covtrace.Scene.from_string(scenes.LIT), {"spp": 64, "resolution": "40x30"}
        images = []
        watched = covtrace.render(scene, **options, preview=images.append)
        self.assertTrue(covtrace.compare(watched, covtrace.render(scene, **options)).identical)

    def test_only_functions(self):
        with self.assertRaises(covtrace.UsageError):
            covtrace.render(covtrace.Scene.from_string(scenes.LIT), preview=3)


if __name__ == "__main__":
    unittest.main()
