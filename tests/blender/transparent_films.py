"""Support for tests of transparent films: a cube with its alpha, against Cycles."""

import os
import tempfile

import bpy
import numpy as np
import test_volume_objects
from addon_support import BlenderTest, material, render

WIDTH, HEIGHT = 96, 72  # of fewer pixels more are edges, about which the pictures are filtered apart


def picture(engine, samples=128):
    """(h, w, 4)."""
    image = render(engine, samples)
    return np.stack([np.reshape(image[f"Combined.{letter}"], (HEIGHT, WIDTH)) for letter in "RGBA"], axis=-1)


class TransparentFilmTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.scene.render.film_transparent = True
        self.scene.render.resolution_x, self.scene.render.resolution_y = WIDTH, HEIGHT
        self.background.inputs["Color"].default_value = (0.3, 0.35, 0.4, 1)
        self.camera.location, self.camera.rotation_euler = (0, -4, 4), (0.78, 0, 0)
        bpy.ops.mesh.primitive_cube_add(size=0.9, location=(0.2, 0, 0.45))
        bpy.context.object.data.materials.append(material(Base_Color=(0.8, 0.2, 0.1, 1), Specular=0.0, Roughness=1.0))
        self.lamp("SUN", energy=3, angle=0.2).rotation_euler = (0.6, 0.5, 0)

    def assert_quarters(self, delta=0.005, channels=slice(0, 4)):
        """The means of the quarters of these channels agree."""
        ours, theirs = picture("COVTRACE"), picture("CYCLES", 256)
        for y in (slice(0, HEIGHT // 2), slice(HEIGHT // 2, HEIGHT)):
            for x in (slice(0, WIDTH // 2), slice(WIDTH // 2, WIDTH)):
                a, b = ours[y, x].mean((0, 1))[channels], theirs[y, x].mean((0, 1))[channels]
                self.assertLess(np.abs(a - b).max(), delta, f"{a}, {b}")
        return ours

    def smoke(self):
        """The volume object of test_volume_objects, whose light bounces as often in Cycles."""
        maker = test_volume_objects.VolumeObjectsTest
        if test_volume_objects.VDB is None:
            self.skipTest("there is no Python module of OpenVDB")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path, self.places, self.grid = os.path.join(folder.name, "smoke.vdb"), maker.places, maker.grid.__get__(self)
        self.scene.cycles.max_bounces = self.scene.cycles.volume_bounces = self.scene.covtrace.max_depth
        return maker.volume(self, maker.smoke(self))[0]
