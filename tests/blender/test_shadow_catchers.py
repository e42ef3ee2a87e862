"""Transparent films and shadow catchers, against Cycles."""

import unittest.mock

import bpy
import numpy as np
from addon_support import BlenderTest, material, render
from covtrace_blender import engine

WIDTH, HEIGHT = 96, 72  # of fewer pixels more are edges, about which the pictures are filtered apart


def picture(engine, samples=128):
    """(h, w, 4)."""
    image = render(engine, samples)
    return np.stack([np.reshape(image[f"Combined.{letter}"], (HEIGHT, WIDTH)) for letter in "RGBA"], axis=-1)


class ShadowCatchersTest(BlenderTest):
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

    def test_films_are_transparent_where_the_sky_is(self):
        ours = self.assert_quarters()
        self.assertEqual(ours[0, 0].tolist(), [0, 0, 0, 0])
        self.assertGreater(ours[..., 3].max(), 0.99)

    def test_shadows_are_caught(self):
        self.plane(material(**self.MATT), size=6).is_shadow_catcher = True
        ours = self.assert_quarters()
        self.assertLess(ours[-1, 0, 3], 0.05)
        self.assertGreater((ours[..., 3] - (ours[..., 0] > 0.05)).max(), 0.3)  # where the shadow is alone

    def test_shadows_lie_on_what_is_behind(self):
        self.scene.render.film_transparent = False
        self.plane(material(**self.MATT), size=6).is_shadow_catcher = True
        self.assert_quarters()
        self.assertEqual(picture("COVTRACE", 16)[..., 3].min(), 1)

    def test_catchers_end_before_the_sky(self):
        self.camera.location, self.camera.rotation_euler = (0, -5, 2.2), (1.3, 0, 0)
        self.plane(material(**self.MATT), size=12).is_shadow_catcher = True
        # Rough surfaces are brighter from the side in Cycles 3.4, as it sends back more light than falls on them.
        ours = self.assert_quarters(channels=slice(3, 4) if bpy.app.version < (4, 0, 0) else slice(0, 4))
        self.assertLess(ours[:HEIGHT // 4, :, 3].max(), 0.01)

    def test_films_are_transparent_before_black_worlds(self):
        for color in ((0, 0, 0, 1), None):
            if color:
                self.background.inputs["Color"].default_value = color
            else:
                self.scene.world.node_tree.links.remove(self.background.outputs[0].links[0])
            self.assertEqual(picture("COVTRACE", 16)[0, 0].tolist(), [0, 0, 0, 0])

    def test_what_is_cancelled_shows_what_there_is(self):
        self.plane(material(**self.MATT), size=6).is_shadow_catcher = True
        run, commands = engine.CovtraceEngine._run, []

        def run_first(self, command):
            commands.append(command)
            return run(self, command) if len(commands) == 1 else 6

        self.scene.covtrace.seconds = 30
        with unittest.mock.patch.object(engine.CovtraceEngine, "_run", run_first):
            self.assertGreater(picture("COVTRACE", 4)[..., 0].max(), 0.1)
        self.assertEqual([command[command.index("--time") + 1] for command in commands], ["10.000", "10.000"])

    def test_transparent_glass_is_told(self):
        self.scene.cycles.film_transparent_glass = True
        self.export()
        self.assertIn("Transparent Glass", " ".join(self.warnings))
