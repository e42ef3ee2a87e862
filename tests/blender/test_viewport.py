"""The preview in viewports: its session by itself, and Blender with a window on a display of Xvfb."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest
import unittest.mock

import bpy
import addon_support  # makes the add-on known
from covtrace_blender import preview_session

BALL = """WorldBegin
AreaLightSource "diffuse" "rgb L" [1 1 1]
Shape "sphere" "float radius" 1
"""


def view_text(fov):
    return (f'LookAt 0 0 5  0 0 0  0 1 0\nCamera "perspective" "float fov" {fov}\n'
            'Film "rgb" "integer xresolution" 64 "integer yresolution" 48\n')


class SessionTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        pathlib.Path(self.folder, "content.pbrt").write_text(BALL)
        self.session = preview_session.PreviewSession(os.environ["COVTRACE"])
        self.addCleanup(self.session.stop)

    def view(self, fov, samples):
        return preview_session.View(view_text(fov), self.folder, "content.pbrt", (64, 48), ["--spp", str(samples)])

    def wait(self, condition, seconds=60):
        end = time.time() + seconds
        while not condition():
            self.assertLess(time.time(), end, "it never came")
            time.sleep(0.01)

    def test_images_come_coarse_and_then_fine(self):
        shapes = []
        self.session._set, set_image = lambda image: (shapes.append(image.shape), set_image(image)), self.session._set
        self.session.show(self.view(30, 16))
        self.wait(lambda: not self.session.is_busy)
        self.assertEqual(shapes[0], (12, 16, 4))
        self.assertEqual(shapes[-1], (48, 64, 4))
        self.assertGreater(len(shapes), 2)  # images on the way, too
        self.assertAlmostEqual(self.session.image[24, 32, 0], 1, delta=0.01)
        self.assertEqual(self.session.image[2, 2].tolist(), [0, 0, 0, 0])
        self.assertEqual(self.session.image[24, 32, 3], 1)

    def test_newer_views_end_older_ones(self):
        self.session.show(self.view(30, 1e6))
        self.wait(lambda: self.session.image is not None and len(self.session.image) == 48)
        process = self.session._process
        wide = (self.session.image[..., :3] > 0.5).mean()
        self.session.show(self.view(90, 4))
        self.wait(lambda: not self.session.is_busy)
        self.assertIsNotNone(process.returncode)
        self.assertLess((self.session.image[..., :3] > 0.5).mean(), 0.3 * wide)

    def test_stopping_ends_the_program(self):
        self.session.show(self.view(30, 1e6))
        self.wait(lambda: self.session.image is not None and len(self.session.image) == 48)
        process = self.session._process
        self.session.stop()
        self.assertIsNotNone(process.poll())

    def test_programs_that_are_ended_by_others_are_told(self):
        self.session.show(self.view(30, 1e6))
        self.wait(lambda: self.session.image is not None and len(self.session.image) == 48)
        self.session._process.kill()
        self.wait(lambda: not self.session.is_busy)
        self.assertIn("signal 9", self.session.failure)

    def test_what_is_no_image_ends_the_program_and_not_the_session(self):
        for broken in (MemoryError(), IndexError("no such channel")):
            self.session.image = None
            self.session.show(self.view(30, 1e6))
            self.wait(lambda: self.session.image is not None and len(self.session.image) == 48)
            process = self.session._process

            def understand(receiver, message):
                raise broken

            with unittest.mock.patch.object(preview_session.TevReceiver, "_understand", understand):
                self.wait(lambda: not self.session.is_busy)
            self.assertIsNotNone(process.returncode)
            self.assertIn(str(broken) or "MemoryError", self.session.failure)
        self.session.show(self.view(30, 4))
        self.wait(lambda: not self.session.is_busy)
        self.assertEqual(self.session.failure, "")

    def test_failures_are_told_and_overcome(self):
        pathlib.Path(self.folder, "content.pbrt").write_text("WorldBegin\nNonsense\n")
        self.session.show(self.view(30, 4))
        self.wait(lambda: not self.session.is_busy)
        self.assertIn("Nonsense", self.session.failure)
        pathlib.Path(self.folder, "content.pbrt").write_text(BALL)
        self.session.show(self.view(30, 4))
        self.wait(lambda: not self.session.is_busy)
        self.assertEqual(self.session.failure, "")
        self.assertIsNotNone(self.session.image)


@unittest.skipUnless(shutil.which("Xvfb") and bpy.app.binary_path, "no Xvfb")
class WindowTest(unittest.TestCase):
    def test_viewports_show_what_they_look_at(self):
        ready, number = os.pipe()
        screen = subprocess.Popen(["Xvfb", "-displayfd", str(number), "-screen", "0", "800x600x24"], pass_fds=[number],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(number)
        self.addCleanup(lambda: (screen.terminate(), screen.wait()))
        with os.fdopen(ready) as line:
            display = line.readline().strip()
        script = pathlib.Path(__file__).with_name("viewport_in_window.py")
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([bpy.app.binary_path, "--factory-startup", "-noaudio", "--window-geometry", "0", "0", "640", "480",
                                   "--python", str(script), "--", folder],
                                  env={**os.environ, "DISPLAY": f":{display}", "LIBGL_ALWAYS_SOFTWARE": "1"}, capture_output=True, text=True)
        lines = [line for line in done.stdout.splitlines() if line.startswith("FOUND ")]
        self.assertTrue(lines, done)
        found = json.loads(lines[0][6:])
        self.assertEqual(set(found["views"]), {"perspective", "nearer", "moved", "ortho", "camera", "edited", "opaque", "clear"})
        for name, view in found["views"].items():
            with self.subTest(name):
                self.assertEqual(view["failure"], "")
                self.assertEqual(view["size"][:2], view["region"][::-1])
                for shown in ("image", "screen"):
                    self.assertIsNotNone(view[shown], shown)
                    for a, b in zip(view[shown], view["expected"]):
                        self.assertAlmostEqual(a, b, delta=0.02, msg=f"{shown} {view}")
        places = [tuple(view["expected"]) for view in found["views"].values()]
        self.assertEqual(len(set(places)), 6)
        # Blender's own grey is behind transparent films.
        for name, alpha in (("opaque", [1, 1]), ("clear", [0, 1])):
            red, green, blue = found["views"][name]["corner"]
            self.assertEqual(found["views"][name]["alpha"], alpha)
            self.assertEqual(red > 0.5 and green < 0.05, name == "opaque", found["views"][name])
            self.assertEqual(abs(red - green) < 0.02 and 0.1 < red < 0.5, name == "clear", found["views"][name])
        self.assertTrue(found["runs"])
        self.assertFalse(found["left"])
        self.assertEqual(found["sessions"], 0)
