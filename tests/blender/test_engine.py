"""The engine: layers, cancelling, failures."""

import os
import time

from covtrace_blender import engine
from addon_support import BlenderTest, HEIGHT, WIDTH, material, mean, render


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

    def test_failures_are_errors(self):
        self.plane(material(**self.MATT))
        known = os.environ.get("COVTRACE")
        os.environ["COVTRACE"] = "/nonexistent/covtrace"
        try:
            with self.assertRaisesRegex(RuntimeError, "was not found"):
                render("COVTRACE", 1)
        finally:
            os.environ["COVTRACE"] = known or ""
        self.scene.camera = None
        with self.assertRaises(RuntimeError):
            render("COVTRACE", 1)
