"""Transparent films and shadow catchers, against Cycles."""

import unittest.mock

import bpy
from addon_support import material
from covtrace_blender import engine
from transparent_films import HEIGHT, TransparentFilmTest, picture


class ShadowCatchersTest(TransparentFilmTest):
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

    def test_smoke_before_caught_shadows(self):
        """Its opacity before the catchers is not their shadow."""
        self.plane(material(**self.MATT), size=6, z=-1).is_shadow_catcher = True
        self.smoke()
        ours = self.assert_quarters()
        self.assertGreater(ours[..., 3].max(), 0.9)
        self.export()
        self.assertFalse([text for text in self.warnings if "opacity" in text], self.warnings)
