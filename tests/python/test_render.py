"""covtrace.render: layers without copies, progress, cancelling, threads, errors."""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy

import covtrace
import scenes


class Rendering(unittest.TestCase):
    def test_known_radiance(self):
        image = covtrace.render(covtrace.Scene.from_string(scenes.FURNACE), method="uniform", spp=1)
        self.assertEqual(image.rgb.shape, (6, 8, 3))
        self.assertEqual(image.rgb.dtype, numpy.float32)
        numpy.testing.assert_allclose(image.rgb, 0.25, rtol=1e-5)
        self.assertTrue(image.complete)
        self.assertEqual(image.statistics["spp"], 1)

    def test_layers_are_views(self):
        image = covtrace.render(scenes.builder(), spp=4)
        for name in ("raw", "albedo", "N", "variance", "filter", "spectrum"):
            self.assertEqual(image[name].shape, (27, 48, 3), name)
        for name in ("Z", "samples", "error", "density"):
            self.assertEqual(image[name].shape, (27, 48), name)
        self.assertEqual(image["cov"].shape, (27, 48, 15))
        self.assertTrue(numpy.shares_memory(image["raw"], image["raw.G"]))
        image["raw.G"][3, 5] = 17
        self.assertEqual(image["raw"][3, 5, 1], 17)
        self.assertAlmostEqual(float(image["samples"].mean()), 4, places=3)
        # The views keep the memory alive.
        raw = image["raw"]
        mean = raw.mean()
        del image
        self.assertEqual(raw.mean(), mean)

    def test_matrices_are_written_out(self):
        image = covtrace.render(scenes.builder(), spp=4)
        cov, full = image["cov"], image.matrices("cov")
        self.assertEqual(full.shape, (27, 48, 5, 5))
        numpy.testing.assert_array_equal(full, full.swapaxes(2, 3))
        numpy.testing.assert_array_equal(full[..., 1, 3], cov[..., 7])
        numpy.testing.assert_array_equal(image["cov.13"], full[..., 3, 1])
        with self.assertRaises(ValueError):
            image.matrices("Z")

    def test_same_image_as_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            path = scenes.builder().write(folder)
            out = os.path.join(folder, "program.exr")
            subprocess.run([os.environ["COVTRACE"], "render", path, "-o", out, "--spp", "4",
                            "--seed", "7", "--layers", "all,share", "--progress", "none"], check=True, capture_output=True)
            image = covtrace.render(path, spp=4, seed=7, threads=1)
            self.assertTrue(covtrace.compare(image, out).identical)
            subprocess.run([os.environ["COVTRACE"], "render", path, "-o", out, "--spp", "4", "--method",
                            "covariance", "--progressive", "--texture-bandwidth", "highest", "--quiet",
                            "--layers", "all,inview,inviewfilter,scatteredcov,scatteredcovweight"],
                           check=True)
            image = covtrace.render(path, spp=4, method="covariance", progressive=True,
                                    texture_bandwidth="highest")
            self.assertTrue(covtrace.compare(image, out).identical)

    def test_denoiser(self):
        def fake(name):
            return pathlib.Path(os.environ["COVTRACE_FAKE_DENOISERS"], name, "libOpenImageDenoise.so.2")

        scene = scenes.builder()
        plain = covtrace.render(scene, spp=4, denoiser="none")
        self.assertEqual(plain.statistics["denoiser"], {"why_none": "not asked for"})
        image = covtrace.render(scene, spp=4, denoiser="oidn", denoiser_library=fake("good"))
        self.assertEqual(image.statistics["denoiser"],
                         {"name": "Open Image Denoise 2.3.99", "file": str(fake("good")), "quality": "high"})
        fast = covtrace.render(scene, spp=4, denoiser_library=fake("good"), denoiser_quality="fast")
        self.assertEqual(fast.statistics["denoiser"]["quality"], "fast")
        self.assertFalse(numpy.array_equal(fast.rgb, image.rgb))
        with self.assertRaisesRegex(covtrace.UsageError, "denoiser_quality"):
            covtrace.render(scene, spp=4, denoiser_quality="low")
        self.assertEqual(image.metadata["covtrace:denoiser"], "Open Image Denoise 2.3.99")
        self.assertGreater(image.statistics["seconds"]["denoise"], 0)
        self.assertFalse(numpy.array_equal(image.rgb, plain.rgb))
        for name, fragment in (("version-one", "version 1.4.3"), ("execute-fails", "out of order")):
            with self.assertWarnsRegex(covtrace.SceneWarning, fragment):
                image = covtrace.render(scene, spp=4, denoiser_library=str(fake(name)))
            self.assertIn(fragment, image.statistics["denoiser"]["why_none"])
            self.assertTrue(numpy.array_equal(image.rgb, plain.rgb))
        with self.assertRaisesRegex(covtrace.UsageError, "version 1.4.3"):
            covtrace.render(scene, denoiser="oidn", denoiser_library=fake("version-one"))
        with self.assertRaisesRegex(covtrace.UsageError, "denoiser is 'optix'"):
            covtrace.render(scene, denoiser="optix")
        with self.assertRaisesRegex(covtrace.UsageError, "denoiser is True; expected one of 'auto', 'oidn', 'none'"):
            covtrace.render(scene, denoiser=True)
        uniform = covtrace.render(scene, spp=1, method="uniform", denoiser_library=fake("version-one"))
        self.assertIsNone(uniform.statistics["denoiser"])

    def test_progress_and_exceptions_in_it(self):
        seen = []
        covtrace.render(scenes.builder((160, 90)), spp=64, progress=seen.append)
        self.assertTrue(seen)
        self.assertTrue(all(0 <= p.fraction <= 1 for p in seen))
        self.assertLessEqual({p.phase for p in seen},
                             {"covariance", "plan", "radiance", "reconstruction"})

        class Stop(Exception):
            pass

        def fail(progress):
            raise Stop(progress.phase)

        with self.assertRaises(Stop):
            covtrace.render(scenes.builder((160, 90)), spp=4096, progress=fail)

    def test_cancel_gives_what_is_there(self):
        stop = threading.Event()

        def stop_once_sampled(progress):
            if progress.samples_per_pixel > 0.5:
                stop.set()

        image = covtrace.render(scenes.builder((160, 90)), method="uniform", spp=1 << 20,
                                cancel=stop, progress=stop_once_sampled)
        self.assertFalse(image.complete)
        self.assertGreater(image["samples"].max(), 0)
        self.assertTrue(numpy.isfinite(image.rgb).all())

    def test_cancel_that_fails_or_returns_anything(self):
        class Cancel:
            def __init__(self, answer):
                self.answer = answer

            def is_set(self):
                return self.answer()

        # A text is true unless it is empty, as in an `if`.
        image = covtrace.render(scenes.builder(), method="uniform", spp=1 << 20,
                                cancel=Cancel(lambda: "yes"))
        self.assertFalse(image.complete)

        class Unclear:
            def __bool__(self):
                raise ArithmeticError("neither")

        for answer in (lambda: 1 / 0, Unclear):
            with self.assertRaises(ArithmeticError):
                covtrace.render(scenes.builder(), method="uniform", spp=1 << 20,
                                cancel=Cancel(answer))

    def test_values_that_are_no_numbers(self):
        scene = covtrace.Scene.from_string('''
            Film "rgb" "integer xresolution" 24 "integer yresolution" 16
            LookAt 0 1 6  0 0 0  0 1 0
            Camera "perspective" "float fov" 40
            WorldBegin LightSource "infinite" "float scale" 1e25 Shape "sphere"''')
        for method in ("uniform", "covariance", "hybrid"):
            with self.assertWarnsRegex(covtrace.SceneWarning, "pixels have values that single precision cannot hold"):
                image = covtrace.render(scene, method=method, spp=4)
            for name in ("variance", "error"):
                self.assertTrue(numpy.isfinite(image[name]).all(), name)
            told = image.statistics["replaced_pixels"]
            self.assertGreater(told["count"], 0)
            self.assertIn("variance", told["layers"])
            x, y = told["first"]
            self.assertGreater(max(image["variance"][y, x].max(), image["error"][y, x].max()), 1e38)

    def test_interrupt(self):
        signal.signal(signal.SIGALRM, signal.default_int_handler)
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with self.assertRaises(KeyboardInterrupt):
            covtrace.render(scenes.builder((160, 90)), method="uniform", spp=1 << 20)

    def test_lock_is_released(self):
        # Another thread goes on counting while this one renders.
        counted, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        start = time.monotonic()
        covtrace.render(scenes.builder((160, 90)), spp=64)
        seconds = time.monotonic() - start
        stop.set()
        thread.join()
        # The thread would count once or twice if the lock were held.
        self.assertGreater(counted[0], min(20, 50 * seconds))

    def test_threads_do_not_change_the_image(self):
        one = covtrace.render(scenes.builder(), spp=4, threads=1)
        three = covtrace.render(scenes.builder(), spp=4, threads=3)
        self.assertTrue(covtrace.compare(one, three).identical)


class Gltf(unittest.TestCase):
    """A square of the radiance 2, a quarter as wide as the picture and half as high."""

    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", covtrace.SceneWarning)
        cls.folder = tempfile.TemporaryDirectory()
        cls.file = pathlib.Path(cls.folder.name) / "square.gltf"
        cls.file.write_text(scenes.gltf())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @staticmethod
    def render(scene, **options):
        return covtrace.render(scene, method="uniform", spp=64, resolution=(64, 32), **options)

    def test_at_rest(self):
        image = self.render(self.file)
        self.assertAlmostEqual(float(image.rgb.mean()), 2 / 4 / 2, delta=0.01)
        self.assertAlmostEqual(float(image.rgb[16, 16, 1]), 2, delta=1e-3)  # at (-1, 0)
        self.assertEqual(image.rgb[16, 32, 1], 0)

    def test_shutter_moves_what_is_animated(self):
        for shutter in ((0.5, 0.50001), (0.0, 1.0), (0.0, 0.02)):
            rgb = self.render(self.file, shutter=shutter).rgb
            # The light is the same however long it shines.
            self.assertAlmostEqual(float(rgb.mean()), 2 / 4 / 2, delta=0.01, msg=str(shutter))
            centre = {0.5: 2, 0.0: 1 if shutter[1] == 1 else 0}[shutter[0]]
            self.assertAlmostEqual(float(rgb[12:20, 31:33, 1].mean()), centre, delta=0.1,
                                   msg=str(shutter))

    def test_shutter_of_a_scene(self):
        scene = covtrace.Scene(self.file, shutter=(0.5, 0.6))
        once = self.render(self.file, shutter=(0.5, 0.6))
        for image in (self.render(scene), self.render(scene, shutter=(0.5, 0.6))):
            self.assertTrue(covtrace.compare(image, once).identical)
        for wrong in (scene, covtrace.Scene(self.file)):
            with self.assertRaisesRegex(covtrace.UsageError, "expected Scene"):
                self.render(wrong, shutter=(0, 1))
        with self.assertRaises(covtrace.UsageError):
            covtrace.Scene(self.file, shutter=(1, 0))

    def test_same_image_as_the_program(self):
        out = os.path.join(self.folder.name, "program.exr")
        subprocess.run([os.environ["COVTRACE"], "render", self.file, "-o", out, "--spp", "4", "--shutter",
                        "0,0.5", "--resolution", "64x32", "--layers", "all,share", "--progress", "none", "--quiet"], check=True)
        image = covtrace.render(self.file, spp=4, shutter=(0, 0.5), resolution=(64, 32))
        self.assertTrue(covtrace.compare(image, out).identical)

    def test_place_of_errors(self):
        broken = pathlib.Path(self.folder.name) / "broken.gltf"
        broken.write_text(scenes.gltf().replace('"POSITION": 0', '"POSITION": 17'))
        with self.assertRaisesRegex(covtrace.SceneError, r"meshes\[0\]\.primitives\[0\]"):
            covtrace.render(broken)


class Errors(unittest.TestCase):
    def test_place_in_the_scene(self):
        with self.assertRaises(covtrace.SceneError) as caught:
            covtrace.Scene.from_string('WorldBegin\n\n   Shape "spere"\n', name="ball.pbrt")
        e = caught.exception
        self.assertEqual((e.file, e.line, e.column), ("ball.pbrt", 3, 4))
        self.assertIn("spere", e.message)
        self.assertNotIn("ball.pbrt", e.message)
        self.assertEqual(e.exit_code, 3)

    def test_missing_file(self):
        with self.assertRaises(covtrace.SceneError):
            covtrace.render("no/such/scene.pbrt")

    def test_arguments(self):
        scene = covtrace.Scene.from_string(scenes.FURNACE)
        for wrong in ({"method": "best"}, {"spp": -1}, {"spp": "many"}, {"threads": -2},
                      {"crop": (0, 0, 100, 100)}, {"error": 0.1, "method": "covariance"},
                      {"texture_memory": "much"}, {"texture_memory": "2b"}, {"texture_memory": -1}, {"texture_memory": 1.5},
                      {"voxels": 0}, {"voxels": "wide"}, {"seed": -1}, {"threads": "all"},
                      {"isa": "mmx"}, {"method": 3}, {"progressive": "now"},
                      {"texture_bandwidth": "low"}, {"resolution": (-5, 4)}, {"resolution": (0, 4)},
                      {"resolution": 5}, {"crop": (1, 2)}, {"shutter": (1, 0)},
                      {"shutter": (0, float("nan"))}, {"shutter": "open"}, {"fstop": 1e-50},
                      {"fstop": 1e-38}, {"focus": 1e-20}, {"spp": float("inf")}):
            with self.subTest(wrong), self.assertRaises(covtrace.UsageError):
                covtrace.render(scene, **wrong)
        with self.assertRaises(TypeError):
            covtrace.render(scene, samples=4)

    def test_arguments_of_other_kinds(self):
        """Whatever stands where something else is expected: nothing but UsageError comes out."""
        kinds = (0, -1, 1.5, True, float("nan"), 10**30, "", "x", "01", "\0", "\ud800", b"\0", (), (1,), [1, "a"], ("a",) * 4, {},
                 object())
        right = {"search_paths": [(), {}, ("a",) * 4], "denoiser_library": ["x", "01"], "environment": [0, 1.5, True, 10**30, "01"]}
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "scene.pbrt"
            file.write_text(scenes.FURNACE)
            scene = covtrace.Scene(file)
            for name in ("shutter", "search_paths", "progress", "cancel", "denoiser_library", "resolution", "crop", "camera", "environment", "scene"):
                for kind in kinds:
                    if any(kind is k or (type(kind) is type(k) and kind == k) for k in right.get(name, [])):
                        continue
                    arguments = {"spp": 1, "denoiser": "none", name: kind}
                    given = arguments.pop("scene", file if name in ("shutter", "search_paths") else scene)
                    with self.subTest(name, kind=kind):
                        try:
                            covtrace.render(given, **arguments)
                        except covtrace.UsageError as e:
                            self.assertIn(name, str(e))
                        except covtrace.SceneError:
                            self.assertIsInstance(kind, str)  # a path to a file that is not there
                        else:
                            self.fail("it renders")
            with self.assertRaisesRegex(covtrace.UsageError, "search_paths is .* when it is read"):
                covtrace.render(scene, spp=1, search_paths=[folder])  # its files have been found
            for kind in (0, (), object(), "\ud800"):
                for argument in ("text", "name", "folder", "search_paths"):
                    with self.subTest(argument, kind=kind):
                        if (argument, kind) == ("search_paths", ()):
                            continue
                        with self.assertRaisesRegex(covtrace.UsageError, argument):
                            covtrace.Scene.from_string(**{"text": scenes.FURNACE, argument: kind})

    def test_warnings(self):
        text = scenes.FURNACE + 'Shape "cylinder"\n'
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            scene = covtrace.Scene.from_string(text)
        self.assertTrue(scene.warnings)
        self.assertEqual([str(w.message) for w in caught], scene.warnings)
        self.assertTrue(all(w.category is covtrace.SceneWarning for w in caught))

    def test_unwritable_file(self):
        image = covtrace.Image.from_arrays(numpy.zeros((2, 2, 3)))
        with self.assertRaises(covtrace.FileError):
            image.write("/no/such/folder/x.exr")
        with self.assertRaisesRegex(covtrace.UsageError, r"x\.tiff.*\.exr.*\.png.*\.pfm.*\.hdr"):
            image.write("x.tiff")


class Package(unittest.TestCase):
    def test_stubs_name_everything(self):
        import ast
        from covtrace import _covtrace
        stub = pathlib.Path(covtrace.__file__).with_name("_covtrace.pyi").read_text()
        classes = {n.name: n for n in ast.walk(ast.parse(stub)) if isinstance(n, ast.ClassDef)}
        for name in ("Planes", "SceneDescription"):
            declared = {n.name for n in classes[name].body if isinstance(n, ast.FunctionDef)}
            declared |= {n.target.id for n in classes[name].body if isinstance(n, ast.AnnAssign)}
            present = {n for n in vars(getattr(_covtrace, name)) if not n.startswith("_")}
            self.assertEqual(declared, present)
        self.assertTrue(pathlib.Path(covtrace.__file__).with_name("py.typed").exists())

    def test_keywords_are_the_options_of_the_program(self):
        """All that change the image and its state; other files, messages and terminals are the program's alone."""
        import inspect
        of_program_alone = {
            "debug_pixel", "exposure", "fps", "frames", "help", "layer_names", "max_memory", "ocio_config", "ocio_display",
            "ocio_look", "ocio_source", "output", "png", "quiet", "reproducible", "stats", "tev", "tev_layers", "view"}
        text = subprocess.run([os.environ["COVTRACE"], "render", "--help"], capture_output=True,
                              text=True, check=True).stdout
        options = {name.replace("-", "_") for name in re.findall(r"(?<=[ ,])--([a-z][a-z-]*)", text)}
        self.assertLess(of_program_alone, options)
        parameters = inspect.signature(covtrace.render).parameters.values()
        keywords = {p.name for p in parameters if p.kind is p.KEYWORD_ONLY}
        keywords = keywords - {"cancel", "preview", "search_paths"} | {"search_path"}
        self.assertEqual(keywords, options - of_program_alone)

    def test_everything_public_is_typed_and_described(self):
        import inspect
        for owner in (covtrace, covtrace.covariance, covtrace.Image, covtrace.Scene,
                      covtrace.SceneBuilder):
            for name, value in vars(owner).items():
                if name.startswith("_") or not inspect.isfunction(value):
                    continue
                signature = inspect.signature(value)
                self.assertIsNot(signature.return_annotation, inspect.Signature.empty, name)
        for name in covtrace.__all__:
            self.assertTrue(getattr(covtrace, name).__doc__, name)

    def test_version(self):
        program = subprocess.run([os.environ["COVTRACE"], "--version"], capture_output=True,
                                 text=True, check=True)
        self.assertIn(covtrace.__version__, program.stdout)

    def test_example_runs(self):
        source = pathlib.Path(os.environ["COVTRACE_SOURCE"]) / "python/examples/why_is_it_noisy.py"
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, str(source), "--size", "96x54", "-o", folder],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(list(pathlib.Path(folder).glob("*.png")))


if __name__ == "__main__":
    unittest.main()
