"""The engine: layers, cancelling, failures."""

import os
import subprocess
import tempfile
import time
import unittest.mock

import bpy
from addon_support import SOURCE, BlenderTest, HEIGHT, WIDTH, material, mean, render
from covtrace_blender import engine


class EngineTest(BlenderTest):
    def test_layers_come_back(self):
        self.plane(material(Base_Color=(0.2, 0.4, 0.6, 1), Roughness=1.0))
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        image = render("COVTRACE", 16)
        centre = HEIGHT // 2 * WIDTH + WIDTH // 2
        self.assertAlmostEqual(image["Depth.Z"][centre], 5, delta=0.05)
        self.assertAlmostEqual(image["Denoising Normal.Z"][centre], 1, delta=1e-3)
        self.assertAlmostEqual(image["Denoising Albedo.B"][centre], 0.6, delta=0.05)
        self.assertGreater(image["Debug Sample Count.X"][centre], 0)
        for name in ("Noisy Image.R", "variance.R", "error.X", "density.X", "filter.X"):
            self.assertIn(name, image)

    def test_names_of_view_layers_are_free(self):
        self.scene.view_layers[0].name = "Another"
        self.plane(material(**self.MATT))
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        image = render("COVTRACE", 16)
        self.assertGreater(mean(image)[0], 0.3)
        self.assertEqual(set(image["Combined.A"]), {1.0})

    def test_escape_ends_the_render(self):
        self.plane(material(**self.MATT))
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        start, is_stopped = time.time(), engine.CovtraceEngine._is_stopped
        engine.CovtraceEngine._is_stopped = lambda self: time.time() > start + 2
        try:
            render("COVTRACE", 1e6)
        finally:
            engine.CovtraceEngine._is_stopped = is_stopped
        self.assertLess(time.time() - start, 15)

    def test_a_render_that_ends_before_its_first_sample_is_blank(self):
        """Blender 5 crashes where it writes the layers of an engine that hands back nothing."""
        self.plane(material(**self.MATT))
        with unittest.mock.patch.object(engine.CovtraceEngine, "_run", lambda self, command: 6):
            for border in (False, True):
                self.scene.render.use_border = border
                self.scene.render.border_max_x = 0.5
                self.assertEqual(max(render("COVTRACE", 1)["Combined.R"]), 0)

    def test_progress_is_a_line_a_second(self):
        self.plane(material(**self.MATT))
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        lines, end = [], time.time() + 4
        with unittest.mock.patch.multiple(engine.CovtraceEngine, _tell=lambda self, text: lines.append(text),
                                          _is_stopped=lambda self: time.time() > end):
            start = time.time()
            render("COVTRACE", 1e6)
            seconds = time.time() - start
        lines = [line for line in lines if "samples" in line]
        self.assertGreater(len(lines), 1)
        self.assertLessEqual(len(lines), seconds + 1)

    def region(self, crop):
        self.scene.render.use_border, self.scene.render.use_crop_to_border = True, crop
        render = self.scene.render
        render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.26, 0.72, 0.3, 0.9

    def test_regions_are_where_cycles_has_them(self):
        self.plane(material(**self.MATT), size=1.5)
        self.background.inputs["Color"].default_value = (1, 0.5, 0.2, 1)
        whole = render("COVTRACE", 4)["Noisy Image.R"]
        for crop in (False, True):
            with self.subTest(crop=crop):
                self.region(crop)
                ours, theirs = render("COVTRACE", 4), render("CYCLES", 4)
                self.assertEqual(len(ours["Combined.R"]), len(theirs["Combined.R"]))
                seen = [v > 0 for v in ours["Combined.A"]]
                self.assertEqual(seen, [v > 0 for v in theirs["Combined.A"]])
                self.assertEqual(sum(seen), 15 * 14)
                if not crop:
                    # Samples of the crop are those of the whole frame.
                    for i, is_seen in enumerate(seen):
                        if is_seen:
                            self.assertAlmostEqual(ours["Noisy Image.R"][i], whole[i], delta=1e-5)
                for name in ("Depth.Z", "Denoising Normal.Z", "Debug Sample Count.X"):
                    self.assertEqual(len(ours[name]), len(ours["Combined.R"]))

    def test_every_failure_is_an_error(self):
        """Failures of the add-on itself are errors, too; Blender would go on with a blank picture."""
        self.plane(material(**self.MATT))
        read = engine.layers.read
        engine.layers.read = lambda path: {}["nothing"]
        try:
            with self.assertRaisesRegex(RuntimeError, "KeyError"):
                render("COVTRACE", 1)
        finally:
            engine.layers.read = read

    @unittest.skipUnless(bpy.app.binary_path, "the module bpy has no command line")
    def test_a_failed_command_line_render_has_an_exit_code(self):
        self.plane(material(**self.MATT))
        with tempfile.TemporaryDirectory() as folder:
            scene = os.path.join(folder, "scene.blend")
            self.scene.render.engine = "COVTRACE"
            bpy.ops.wm.save_as_mainfile(filepath=scene)
            register = f"import sys; sys.path.insert(0, {str(SOURCE / 'blender')!r}); import covtrace_blender; covtrace_blender.register()"
            def run(program, frame):
                return subprocess.run([bpy.app.binary_path, "--background", "--factory-startup", "-noaudio", scene, "--python-expr", register,
                                       "-o", folder + "/image_", *frame], env={**os.environ, "COVTRACE": program}, capture_output=True, text=True)
            for frame in (["-f", "1"], ["-s", "1", "-e", "1", "-a"]):
                failed = run("/nonexistent/covtrace", frame)
                self.assertEqual(failed.returncode, 1, failed)
                self.assertIn("was not found", failed.stderr)
                self.assertEqual([name for name in os.listdir(folder) if name.startswith("image_")], [])
            done = run(os.environ["COVTRACE"], ["-f", "1"])
            self.assertEqual(done.returncode, 0, done)
            self.assertTrue(os.path.exists(folder + "/image_0001.png"), done)

    def test_failures_are_errors(self):
        self.plane(material(**self.MATT))
        known = os.environ.get("COVTRACE")
        os.environ["COVTRACE"] = "/nonexistent/covtrace"
        try:
            with self.assertRaisesRegex(RuntimeError, "was not found"):
                render("COVTRACE", 1)
        finally:
            os.environ["COVTRACE"] = known or ""
        self.scene.camera = next(obj for obj in self.scene.objects if obj.type == "MESH")
        with self.assertRaisesRegex(RuntimeError, "is of type MESH; expected a camera"):
            render("COVTRACE", 1)
        self.scene.camera = None
        with self.assertRaises(RuntimeError):
            render("COVTRACE", 1)
