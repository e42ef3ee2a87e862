"""Principled Hair of the add-on against Cycles."""

import math
import unittest

import bpy
import numpy as np
from addon_support import BlenderTest, CyclesTest, mean, render
from mathutils import Vector


class HairTest(BlenderTest):
    def setUp(self):
        super().setUp()
        m = bpy.data.materials.new("hair")
        m.use_nodes = True
        self.hair = m.node_tree.nodes.new("ShaderNodeBsdfHairPrincipled")
        if hasattr(self.hair, "model"):
            self.hair.model = "CHIANG"
        m.node_tree.links.new(self.hair.outputs[0], m.node_tree.nodes["Material Output"].inputs["Surface"])
        self.sheet = self.plane(m, size=3)
        self.sheet.modifiers.new("hair", "PARTICLE_SYSTEM")
        settings = self.sheet.particle_systems[0].settings
        settings.type, settings.count, settings.hair_length = "HAIR", 3000, 0.4
        settings.root_radius, settings.tip_radius, settings.radius_scale, settings.brownian_factor = 1.0, 1.0, 0.01, 0.2
        settings.use_close_tip, self.sheet.show_instancer_for_render = False, False
        cycles = self.scene.cycles
        for kind in ("max", "diffuse", "glossy", "transmission"):
            setattr(cycles, f"{kind}_bounces", 32)
        self.scene.covtrace.max_depth = 32
        self.scene.cycles_curves.shape = "THICK"

    def set(self, parametrization, inputs):
        self.hair.parametrization = parametrization
        for name, value in inputs.items():
            self.hair.inputs[name].default_value = value

    def expect_as_bright(self, samples):
        ours, theirs = (mean(render(engine, samples), 8, 6, 24, 18) for engine in ("COVTRACE", "CYCLES"))
        for a, b in zip(ours, theirs):
            self.assertAlmostEqual(a / b, 1, delta=0.05, msg=f"{ours} against {theirs}")

    def test_strands_are_as_bright_as_in_cycles_below_an_even_sky(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        for kind, inputs in (("COLOR", {"Color": (0.8, 0.5, 0.2, 1)}), ("MELANIN", {"Melanin": 0.8, "Melanin Redness": 1.0}),
                             ("ABSORPTION", {"Absorption Coefficient": (0.1, 0.3, 1)})):
            self.set(kind, inputs)
            with self.subTest(kind):
                self.expect_as_bright(64)

    def test_curves_info_tells_of_strands(self):
        """Colours by the place along strands and by the strand, and those of the mesh that they are on."""
        m = bpy.data.materials.new("by place")
        m.use_nodes = True
        tree = m.node_tree
        info, matt, both = (tree.nodes.new("ShaderNode" + kind) for kind in ("HairInfo", "BsdfDiffuse", "CombineXYZ"))
        outputs = {output.identifier: output for output in info.outputs}
        for identifier, component in (("Intercept", "X"), ("Random", "Y"), ("Is Strand", "Z")):
            tree.links.new(outputs[identifier], both.inputs[component])
        tree.links.new(both.outputs[0], matt.inputs["Color"])
        tree.links.new(matt.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        self.sheet.data.materials[0] = m
        settings = self.sheet.particle_systems[0].settings
        settings.count, settings.radius_scale = 40, 0.1
        self.camera.location, self.camera.rotation_euler = (0, -4, 0.4), (1.5, 0, 0)
        self.lamp("SUN", energy=3).rotation_euler = (1.2, 0, 0.3)
        for kind in ("max", "diffuse"):
            setattr(self.scene.cycles, f"{kind}_bounces", 0)
        self.scene.covtrace.max_depth = 1
        ours, theirs = ({c: np.array(image[f"Combined.{c}"]) for c in "RGB"} for image in (render("COVTRACE", 64), render("CYCLES", 64)))
        shown = (ours["B"] > 0.1) & (theirs["B"] > 0.1)
        self.assertGreater(shown.sum(), 50)
        for channel in "RG":
            a, b = (image[channel][shown] / image["B"][shown] for image in (ours, theirs))
            self.assertGreater(np.std(b), 0.1)
            self.assertLess(np.abs(a - b).mean(), 0.03, channel)
        self.sheet.show_instancer_for_render = True  # black, as it is no strand
        self.assertLess(mean(render("COVTRACE", 16))[2], 1.1 * ours["B"].mean())
        self.export()
        self.assertEqual([], self.warnings)
        tree.links.new(outputs["Thickness"], both.inputs["Z"])
        self.export()
        self.assertTrue(any("its thickness has no counterpart" in w for w in self.warnings), self.warnings)

    def test_other_models_are_told(self):
        self.export()
        self.assertEqual([], self.warnings)
        if not hasattr(self.hair, "model"):
            self.skipTest("this Blender has one model only")
        self.hair.model = "HUANG"
        self.export()
        self.assertTrue(any("Huang" in w and "Chiang" in w for w in self.warnings), self.warnings)


@unittest.skipIf(bpy.app.version < (4, 2, 0), "no curves by script before Blender 4.2")
class StrandTest(CyclesTest):
    """One thick strand along z, and light that is scattered once."""

    def setUp(self):
        super().setUp()
        hair = self.shader("BsdfHairPrincipled")
        node = next(n for n in hair.node_tree.nodes if n.type == "BSDF_HAIR_PRINCIPLED")
        node.parametrization, node.model = "ABSORPTION", "CHIANG"
        node.inputs["Absorption Coefficient"].default_value = (0.1, 0.3, 1)
        self.offset = node.inputs["Offset"]
        curves = bpy.data.hair_curves.new("strand")
        curves.add_curves([2])
        for point, z in zip(curves.points, (-3, 3)):
            point.position, point.radius = (0, 0, z), 0.3
        curves.materials.append(hair)
        self.scene.collection.objects.link(bpy.data.objects.new("strand", curves))
        self.camera.location, self.camera.rotation_euler = (0, -5, 0), (math.pi / 2, 0, 0)
        self.camera.data.type, self.camera.data.ortho_scale = "ORTHO", 1
        for kind in ("max", "diffuse", "glossy", "transmission"):
            setattr(self.scene.cycles, f"{kind}_bounces", 0)
        self.scene.covtrace.max_depth = 1
        self.scene.cycles_curves.shape = "THICK"
        self.sun = self.lamp("SUN", energy=1, angle=math.radians(2))

    def test_is_as_bright_as_in_cycles_from_all_sides(self):
        for degrees in (0, 5):  # of the scales, whose sign the light from above and below tells
            self.offset.default_value = math.radians(degrees)
            for place in ((0, -1, 0), (1, -1, 0), (1, 0, 0), (0, 1, 1e-4), (0, -1, 1), (0, -1, -1), (0.5, 1, 0.7), (0.5, 1, -0.7)):
                self.sun.rotation_euler = Vector(place).to_track_quat("Z", "Y").to_euler()
                ours, theirs = (mean(render(engine, 64)) for engine in ("COVTRACE", "CYCLES"))
                with self.subTest(degrees=degrees, place=place):
                    for a, b in zip(ours, theirs):
                        self.assertAlmostEqual(a / b, 1, delta=0.04, msg=f"{ours} against {theirs}")
