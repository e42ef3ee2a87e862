"""Animations of the command line: a file per frame, blurred by motion, and their end where they are interrupted."""

import os
import signal
import subprocess
import tempfile
import time
import unittest

import bpy
import numpy as np
from addon_support import SOURCE, BlenderTest, curves_of

REGISTER = f"import sys; sys.path.insert(0, {str(SOURCE / 'blender')!r}); import covtrace_blender; covtrace_blender.register()"


@unittest.skipUnless(bpy.app.binary_path, "the module bpy has no command line")
class AnimationTest(BlenderTest):
    def setUp(self):
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        plane = self.plane(self.shining(), size=0.4)
        for frame, x in ((0, -1.5), (4, 1.5)):
            plane.location.x = x
            plane.keyframe_insert("location", frame=frame)
        for curve in curves_of(plane):
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 1.0
        self.scene.render.engine, self.scene.covtrace.samples = "COVTRACE", 64
        settings = self.scene.render.image_settings
        settings.file_format, settings.color_depth = "OPEN_EXR", "32"

    def command(self, *options):
        scene = os.path.join(self.folder, "scene.blend")
        bpy.ops.wm.save_as_mainfile(filepath=scene)
        return [bpy.app.binary_path, "--background", "--factory-startup", "-noaudio", scene, "--python-expr", REGISTER,
                "-o", self.folder + "/image_", *options]

    def images(self):
        return sorted(name for name in os.listdir(self.folder) if name.startswith("image_"))

    def columns(self, name):
        """Light in each column of a file's picture."""
        image = bpy.data.images.load(os.path.join(self.folder, name))
        values = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(values)
        return values.reshape(*tuple(image.size)[::-1], -1)[..., 0].sum(0)

    def test_every_frame_has_its_file_and_its_blur(self):
        done = subprocess.run(self.command("-s", "1", "-e", "3", "-a"), capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done)
        self.assertEqual(self.images(), ["image_0001.exr", "image_0002.exr", "image_0003.exr"])
        place = np.arange(32) + 0.5
        pixel = 5 * 36 / 50 / 32  # metres, at 5 m from a lens of 50 mm on a sensor of 36 mm
        for name, x in zip(self.images(), (-0.75, 0, 0.75)):
            light = self.columns(name)
            middle = (place * light).sum() / light.sum()
            # A square of 0.4 that moves 0.75 spreads by the root of (0.75^2 + 0.4^2) / 12.
            spread = np.sqrt((light * (place - middle) ** 2).sum() / light.sum())
            self.assertAlmostEqual((middle - 16) * pixel, x, delta=0.02, msg=name)
            self.assertAlmostEqual(spread * pixel, 0.245, delta=0.03, msg=name)

    def test_an_interrupt_ends_the_animation(self):
        self.scene.covtrace.samples = 1e6
        running = subprocess.Popen(self.command("-s", "1", "-e", "50", "-a"), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True)
        for line in running.stdout:
            if "samples" in line:
                break
        running.send_signal(signal.SIGINT)
        start = time.time()
        rest = running.communicate(timeout=120)[0]
        self.assertLess(time.time() - start, 60)
        self.assertLessEqual(len(self.images()), 1, rest)
        left = subprocess.run(["ps", "--ppid", str(running.pid), "-o", "args="], capture_output=True, text=True).stdout
        self.assertEqual(left.strip(), "")
