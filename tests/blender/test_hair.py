"""Principled Hair of the add-on against Cycles."""

import bpy
from addon_support import BlenderTest, mean, render


class HairTest(BlenderTest):
    def test_strands_are_as_bright_as_in_cycles(self):
        m = bpy.data.materials.new("hair")
        m.use_nodes = True
        hair = m.node_tree.nodes.new("ShaderNodeBsdfHairPrincipled")
        m.node_tree.links.new(hair.outputs[0], m.node_tree.nodes["Material Output"].inputs["Surface"])
        sheet = self.plane(m, size=3)
        sheet.modifiers.new("hair", "PARTICLE_SYSTEM")
        settings = sheet.particle_systems[0].settings
        settings.type, settings.count, settings.hair_length = "HAIR", 3000, 0.4
        settings.root_radius, settings.tip_radius, settings.radius_scale, settings.brownian_factor = 1.0, 1.0, 0.01, 0.2
        settings.use_close_tip, sheet.show_instancer_for_render = False, False
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        cycles = self.scene.cycles
        for kind in ("max", "diffuse", "glossy", "transmission"):
            setattr(cycles, f"{kind}_bounces", 32)
        self.scene.covtrace.max_depth = 64  # a strand takes two of them, its wall's
        self.scene.cycles_curves.shape = "THICK"
        for kind, settings in (("COLOR", {"Color": (0.8, 0.5, 0.2, 1)}), ("MELANIN", {"Melanin": 0.8, "Melanin Redness": 1.0}),
                               ("ABSORPTION", {"Absorption Coefficient": (0.1, 0.3, 1)})):
            hair.parametrization = kind
            for name, value in settings.items():
                hair.inputs[name].default_value = value
            with self.subTest(kind):
                ours, theirs = (mean(render(engine, 64), 8, 6, 24, 18) for engine in ("COVTRACE", "CYCLES"))
                for a, b in zip(ours, theirs):
                    self.assertAlmostEqual(a, b, delta=0.05, msg=f"{ours} against {theirs}")
        self.export()
        self.assertTrue(any("without their highlights" in w for w in self.warnings), self.warnings)
