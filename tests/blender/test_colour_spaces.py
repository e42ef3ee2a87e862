"""Working spaces of Blender 5, against Cycles."""

import unittest

import bpy
from addon_support import CyclesTest

SRGB = (200, 60, 30, 255)


@unittest.skipIf(bpy.app.version < (5, 0), "Blender before 5.0")
class ColourSpacesTest(CyclesTest):
    def setUp(self):
        super().setUp()
        self.addCleanup(bpy.ops.wm.read_factory_settings, use_empty=True)

    def textured(self):
        """A material of an image of one sRGB colour, whose grey is the share of it beside black."""
        image = bpy.data.images.new("colour", 2, 2)
        image.pixels = [c / 255 for c in SRGB] * 4
        image.pack()
        m = bpy.data.materials.new("textured")
        tree = m.node_tree
        texture, mixed = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeMixShader")
        matt, black = self.node(tree, "BsdfDiffuse"), self.node(tree, "BsdfDiffuse", Color=(0, 0, 0, 1))
        texture.image = image
        tree.links.new(texture.outputs["Color"], matt.inputs["Color"])
        tree.links.new(texture.outputs["Color"], mixed.inputs[0])
        tree.links.new(black.outputs[0], mixed.inputs[1])
        tree.links.new(matt.outputs[0], mixed.inputs[2])
        tree.links.new(mixed.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        return m

    def test_colours_are_those_of_cycles(self):
        for space in ("Linear Rec.709", "Linear Rec.2020", "ACEScg"):
            bpy.ops.wm.set_working_color_space(working_space=space)
            self.assertEqual(bpy.data.colorspace.working_space, space)
            things = [self.thing("plane", self.textured(), size=20), self.lamp("POINT", energy=300, use_temperature=True, temperature=3500)]
            self.background.inputs["Color"].default_value = (0.2, 0.3, 0.5, 1)
            for blackbody in (False, True):
                if blackbody:
                    tree = self.scene.world.node_tree
                    node = tree.nodes.new("ShaderNodeBlackbody")
                    node.inputs["Temperature"].default_value = 8000
                    link = tree.links.new(node.outputs["Color"], self.background.inputs["Color"])
                with self.subTest(space=space, blackbody=blackbody):
                    self.assert_parts_as_cycles(0.03)
            self.scene.world.node_tree.links.remove(link)
            for thing in things:
                bpy.data.objects.remove(thing)
            bpy.data.images.remove(bpy.data.images["colour"])
