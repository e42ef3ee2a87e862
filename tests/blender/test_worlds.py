"""Worlds of the add-on against Cycles: images of any shape, and nodes that Cycles bakes."""

import math
import os
import tempfile
import unittest.mock

import bpy
import numpy as np
from addon_support import BlenderTest, material, mean, render
from covtrace_blender import world_baking


# Skies of the atmosphere, which can have a sun: Nishita's is one of two in Blender 5.
SKIES_WITH_SUN = ("SINGLE_SCATTERING", "MULTIPLE_SCATTERING") if bpy.app.version >= (5, 0) else ("NISHITA",)


class WorldsTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.tree = self.scene.world.node_tree
        world_baking._known.clear()
        rows = unittest.mock.patch.object(world_baking, "ROWS", 256)
        rows.start()
        self.addCleanup(rows.stop)

    def shown(self, node, output=0):
        self.tree.links.new(node.outputs[output], self.background.inputs["Color"])

    def node(self, kind, **settings):
        node = self.tree.nodes.new("ShaderNode" + kind)
        for key, value in settings.items():
            setattr(node, key, value)
        return node

    VIEWS = ((math.pi / 2, 0, 0.3), (math.pi / 2, 0, 2.5), (0.4, 0, 0))

    def assert_seen_as_in_cycles(self, share=0.03):
        """The world itself, in a wide view, per channel: its means, and those of its left and right half."""
        self.camera.data.lens = 10
        for turn in self.VIEWS:
            self.camera.rotation_euler = turn
            ours, theirs = render("COVTRACE", 16), render("CYCLES", 64)
            for part in ((0, 0, 32, 24), (0, 0, 16, 24), (16, 0, 32, 24)):
                for a, b in zip(mean(ours, *part), mean(theirs, *part)):
                    self.assertGreater(b, 1e-4)
                    self.assertAlmostEqual(a / b, 1, delta=share, msg=f"{turn} {part}")

    def test_images_of_any_shape_lie_around_the_scene(self):
        for width, height in ((16, 16), (48, 8), (9, 7)):
            with self.subTest((width, height)):
                image = bpy.data.images.new("sky", width, height, float_buffer=True)
                x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
                # Smooth at the seam, and at the poles, beyond which Cycles interpolates otherwise.
                colours = np.stack([1 + np.sin(2 * math.pi * x), 0.2 + y * (1 - y), 1.2 + np.cos(2 * math.pi * x), np.ones_like(x)], axis=-1)
                image.pixels = colours.ravel()
                self.shown(self.node("TexEnvironment", image=image))
                self.assert_seen_as_in_cycles()
                self.export()
                self.assertEqual(self.warnings, [])

    def test_gradients_and_mixtures_are_baked(self):
        noise = self.node("TexNoise")
        noise.inputs["Scale"].default_value = 2.0
        mixed, second = self.node("MixShader"), self.node("Background")
        second.inputs["Color"].default_value, second.inputs["Strength"].default_value = (0.2, 0.5, 0.9, 1), 2.0
        self.shown(noise, 1)
        strength = self.node("Value")
        strength.outputs[0].default_value = 1.5
        self.tree.links.new(strength.outputs[0], self.background.inputs["Strength"])
        self.tree.links.new(self.background.outputs[0], mixed.inputs[1])
        self.tree.links.new(second.outputs[0], mixed.inputs[2])
        self.tree.links.new(mixed.outputs[0], self.tree.nodes["World Output"].inputs["Surface"])
        self.assert_seen_as_in_cycles()
        self.export()
        self.assertEqual(self.warnings, [])

    def test_skies_without_a_sun_are_baked(self):
        for kind in ("PREETHAM", "HOSEK_WILKIE", *SKIES_WITH_SUN):
            with self.subTest(kind):
                sky = self.node("TexSky", sky_type=kind, sun_disc=False, sun_elevation=0.5)
                self.background.inputs["Strength"].default_value = 0.3
                self.shown(sky)
                self.assert_seen_as_in_cycles()

    def test_suns_of_skies_light_as_in_cycles(self):
        """A matt plane with a cube on it."""
        self.plane(material(**self.MATT))
        bpy.ops.mesh.primitive_cube_add(size=0.6, location=(0, 0, 0.3))
        bpy.context.object.data.materials.append(bpy.context.scene.objects["Plane"].data.materials[0])
        self.background.inputs["Strength"].default_value = 0.1
        for kind in SKIES_WITH_SUN:
            with self.subTest(kind):
                self.shown(self.node("TexSky", sky_type=kind, sun_elevation=0.9, sun_rotation=1.0))
                self.assert_as_cycles(0.03, 256)

    def test_worlds_are_baked_again_where_they_change(self):
        sky = self.node("TexSky", sky_type="HOSEK_WILKIE")
        self.shown(sky)
        rendered = world_baking._render
        with unittest.mock.patch.object(world_baking, "_render", side_effect=rendered) as counted:
            self.export()
            self.export()
            self.assertEqual(counted.call_count, 1)
            sky.turbidity = 5
            self.export()
            self.assertEqual(counted.call_count, 2)
            self.background.inputs["Strength"].default_value = 0.5
            self.export()
            self.assertEqual(counted.call_count, 3)

    def test_worlds_that_cannot_be_baked_are_told(self):
        self.shown(self.node("TexSky", sky_type="HOSEK_WILKIE"))
        with tempfile.TemporaryDirectory() as folder:
            script = os.path.join(folder, "fails.py")
            with open(script, "w", encoding="utf-8") as out:
                out.write("raise SystemExit('no Cycles here')\n")
            with unittest.mock.patch.object(world_baking, "_PROCESS", script):
                self.background.inputs["Color"].default_value = (0.5, 0.25, 0, 1)
                text = self.export()
        self.assertIn('LightSource "infinite" "rgb L" [0.5 0.25 0]', text)
        self.assertTrue(any("no Cycles here" in w and "own colour" in w for w in self.warnings), self.warnings)

    def test_what_worlds_cannot_tell_apart_is_told(self):
        path, mixed, second = self.node("LightPath"), self.node("MixShader"), self.node("Background")
        self.tree.links.new(path.outputs["Ray Length"], mixed.inputs[0])
        self.tree.links.new(self.background.outputs[0], mixed.inputs[1])
        self.tree.links.new(second.outputs[0], mixed.inputs[2])
        self.tree.links.new(mixed.outputs[0], self.tree.nodes["World Output"].inputs["Surface"])
        self.export()
        self.assertTrue(any("Light Path" in w for w in self.warnings), self.warnings)
