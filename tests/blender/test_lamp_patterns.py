"""Patterns on lamps, against Cycles."""

import unittest
from unittest import mock

import bpy
from addon_support import CyclesTest
from covtrace_blender.lamp_emission import LampEmission


class LampPatternsTest(CyclesTest):
    def patterned(self, kind, coordinate, texture, **values):
        """A lamp whose emission has the colour of a texture on an output of Texture Coordinate."""
        lamp = self.lamp(kind, **values).data
        lamp.use_nodes = True
        tree = lamp.node_tree
        places = self.node(tree, "TexCoord")
        tree.links.new(places.outputs[coordinate], texture(tree).inputs["Vector"])
        tree.links.new(next(n for n in tree.nodes if n.type.startswith("TEX_") and n.type != "TEX_COORD").outputs["Color"],
                       tree.nodes["Emission"].inputs["Color"])
        self.plane(self.shader("BsdfDiffuse", Color=(0.8, 0.8, 0.8, 1)), size=8)
        return lamp

    def picture(self, tree):
        """Its quarters have four colours."""
        image = bpy.data.images.new("quarters", 8, 8, float_buffer=True)
        pixels = []
        for y in range(8):
            for x in range(8):
                pixels += [(0.1, 1.0)[x > 3], (0.05, 0.6)[y > 3], 0.2, 1]
        image.pixels[:] = pixels
        node = self.node(tree, "TexImage")
        node.image = image
        return node

    @unittest.skipIf(bpy.app.version < (4, 0), "Blender before 4.0")
    def test_a_picture_on_an_area_lamp(self):
        self.patterned("AREA", "UV", self.picture, energy=100, size=2, shape="RECTANGLE", size_y=1.2, location=(0.3, 0, 1), color=(1, 0.8, 0.5))
        self.assert_parts_as_cycles(0.05, 64, samples_of_cycles=128)
        self.export()
        self.assertEqual(self.warnings, [])

    SPOT = dict(energy=200, spot_size=1.2, spot_blend=0.2, location=(0, 0, 2))

    @unittest.skipIf(bpy.app.version < (4, 0), "Blender before 4.0")
    def test_a_grey_picture_before_a_spot(self):
        def grey(tree):
            node = self.picture(tree)
            node.image.pixels[:] = [c for pixel in range(64) for c in ((0.1, 0.4, 1.0)[pixel % 8 // 3],) * 3 + (1,)]
            return node

        self.patterned("SPOT", "UV", grey, shadow_soft_size=0, **self.SPOT)
        self.assertEqual(self.export().count('"goniometric"'), 1)
        self.assert_parts_as_cycles(0.05, 64, samples_of_cycles=128)

    @unittest.skipIf(bpy.app.version < (4, 0), "Blender before 4.0")
    def test_a_picture_in_colours_is_three_lights(self):
        self.patterned("SPOT", "UV", self.picture, shadow_soft_size=0.01, **self.SPOT)
        self.assert_parts_as_cycles(0.05, 64, samples_of_cycles=128)
        self.assertEqual(self.export().count("goniometricfilename"), 3)
        self.assertEqual(self.warnings, [])

    def test_a_gradient_around_a_point(self):
        def steps(tree):
            return self.node(tree, "TexGradient")

        self.patterned("POINT", "Normal", steps, energy=100, shadow_soft_size=0, location=(0.2, 0, 1))
        self.assert_parts_as_cycles(0.05, 64, samples_of_cycles=128)

    @unittest.skipIf(bpy.app.version >= (4, 0), "Blender since 4.0")
    def test_pictures_are_told_where_they_lie_otherwise(self):
        self.patterned("AREA", "UV", self.picture, energy=100, size=2, location=(0, 0, 1))
        self.export()
        self.assertTrue(any("is not supported; the socket's own value is used" in w for w in self.warnings), self.warnings)

    def test_lamps_without_extent_are_dark(self):
        self.patterned("AREA", "UV", self.picture, energy=100, shape="RECTANGLE", size=2, size_y=0)
        self.assertNotIn("AreaLightSource", self.export())

    @unittest.skipIf(bpy.app.version < (4, 0), "Blender before 4.0")
    def test_mixtures_have_a_pattern(self):
        lamp = self.patterned("AREA", "UV", self.picture, energy=100, size=2, location=(0.3, 0, 1))
        tree = lamp.node_tree
        places, gradient, mix = (self.node(tree, kind) for kind in ("TexCoord", "TexGradient", "MixShader"))
        tree.links.new(places.outputs["UV"], gradient.inputs["Vector"])
        tree.links.new(gradient.outputs["Fac"], mix.inputs[0])
        tree.links.new(tree.nodes["Emission"].outputs[0], mix.inputs[1])
        tree.links.new(mix.outputs[0], next(n for n in tree.nodes if n.type == "OUTPUT_LIGHT").inputs[0])
        self.assert_parts_as_cycles(0.05, 64, samples_of_cycles=128)

    @unittest.skipIf(bpy.app.version < (4, 0), "Blender before 4.0")
    def test_a_pattern_that_many_lamps_have_is_evaluated_once(self):
        lamp = self.patterned("POINT", "UV", self.picture, energy=100)
        for x in range(3):
            self.scene.collection.objects.link(bpy.data.objects.new("other", lamp))
        with mock.patch.object(LampEmission, "read", autospec=True, side_effect=LampEmission.read) as read:
            self.assertEqual(self.export().count(".pfm"), 12)  # three lights each
        self.assertEqual(read.call_count, 1)
