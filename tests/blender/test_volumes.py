"""Even volumes of materials, against Cycles."""

import bpy
from addon_support import BlenderTest, material, mean, render


class VolumesTest(BlenderTest):
    def body(self, place, size, kind, surface=None, **inputs):
        """A box whose material has a volume shader."""
        bpy.ops.mesh.primitive_cube_add(size=1, location=place)
        box = bpy.context.object
        box.scale = size
        m = bpy.data.materials.new("filled")
        m.use_nodes = True
        m.node_tree.nodes.clear()
        output, node = m.node_tree.nodes.new("ShaderNodeOutputMaterial"), m.node_tree.nodes.new(kind)
        for name, value in inputs.items():
            node.inputs[name.replace("_", " ")].default_value = value
        m.node_tree.links.new(node.outputs["Volume"], output.inputs["Volume"])
        if surface:
            m.node_tree.links.new(m.node_tree.nodes.new(surface).outputs[0], output.inputs["Surface"])
        box.data.materials.append(m)
        return m

    def point(self, place, watts):
        """A lamp without size: of one with it, Cycles has less light in the fog that is near."""
        self.lamp("POINT", location=place, energy=watts, shadow_soft_size=0)

    def assert_as_cycles(self, share, samples=256):
        cycles, depth = self.scene.cycles, self.scene.covtrace.max_depth
        cycles.max_bounces = cycles.volume_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = depth
        cycles.transmission_bounces, cycles.sample_clamp_indirect, cycles.blur_glossy = depth, 0, 0
        ours, theirs = mean(render("COVTRACE", samples)), mean(render("CYCLES", samples))
        for a, b in zip(ours, theirs):
            self.assertAlmostEqual(a, b, delta=share * max(theirs), msg=f"{ours}, {theirs}")
        self.assertGreater(max(theirs), 0.02)

    def test_fog_before_the_camera(self):
        self.body((0, 0, 0), (4, 4, 2), "ShaderNodeVolumeScatter", Color=(1, 0.5, 0.2, 1), Density=0.5, Anisotropy=0.4)
        self.point((1, 0, 0), 200)
        self.assert_as_cycles(0.05)

    def test_fog_around_the_camera_and_what_stands_in_it(self):
        self.body((0, 0, 2), (8, 8, 10), "ShaderNodeVolumePrincipled", Color=(0.5, 0.5, 0.8, 1), Density=0.15)
        self.plane(material(**self.MATT), size=3)
        self.point((0.5, 0, 1.5), 100)
        self.assert_as_cycles(0.05)

    def test_a_clear_body_takes_light_by_its_depth(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.body((0, 0, 0), (20, 20, 2), "ShaderNodeVolumeAbsorption", "ShaderNodeBsdfTransparent", Color=(0.2, 0.5, 0.9, 1),
                  Density=0.6)
        self.assert_as_cycles(0.02, 32)

    def test_glass_that_absorbs_in_fog(self):
        self.body((0, 0, 2), (8, 8, 10), "ShaderNodeVolumeScatter", Density=0.1)
        self.body((0, 0, 0), (2, 2, 1), "ShaderNodeVolumeAbsorption", "ShaderNodeBsdfGlass", Color=(0.2, 0.5, 0.9, 1),
                  Density=1.0)
        self.plane(material(**self.MATT), size=6).location.z = -1
        self.point((0, 1, 3), 200)
        text = self.export()
        self.assertIn('MediumInterface "" "medium ', text.split("Camera")[0])
        self.assertEqual(len({line for line in text.splitlines() if line.startswith("MediumInterface")}), 4)
        self.assert_as_cycles(0.05)

    def test_volumes_that_are_not_even_are_told_and_hide_nothing(self):
        m = self.body((0, 0, 0), (4, 4, 2), "ShaderNodeVolumeScatter", Density=0.5)
        tree = m.node_tree
        mix = tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        for value in mean(render("COVTRACE", 4)):
            self.assertAlmostEqual(value, 1, delta=0.01)
        self.export()
        self.assertIn("volume is not supported", self.warnings[0])
