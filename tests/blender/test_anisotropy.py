"""Anisotropy of shaders, its direction and strength, against Cycles: a plane and a ball under a strip of light."""

import unittest

import bpy
from addon_support import CyclesTest, material


# Cycles' share of later bounces is that of an isotropic surface whose alpha is the geometric mean, by which white metals lose 5 to 10 %
# of the light in a white surrounding; ours is that of the mean square, which loses at most 2 %.
TOLERANCE = 0.09


class AnisotropyTest(CyclesTest):
    LEAST = 0.03

    def setUp(self):
        super().setUp()
        self.camera.location, self.camera.rotation_euler = (0, -4, 3), (0.92, 0, 0)
        strip = self.thing("plane", self.shader("Emission", "strip", Strength=20.0), (0, 2, 2.5), (-0.8, 0, 0.5), size=1)
        strip.scale = (0.3, 2, 1)
        self.background.inputs["Color"].default_value = (0.05, 0.05, 0.05, 1)

    def assert_as_cycles_on_both(self, m, has_plane=True):
        ball = self.thing("uv_sphere", m, (1, 0, 0.7), segments=64, ring_count=32, radius=0.7)
        bpy.ops.object.shade_smooth()
        things = [ball, self.thing("plane", m, (-0.8, 0, 0), (0, 0, 0.3), size=2.5)] if has_plane else [ball]
        try:
            self.assert_parts_as_cycles(TOLERANCE, least=self.LEAST)
            self.export()
            self.assertEqual(self.warnings, [])
        finally:
            for thing in things:
                bpy.data.objects.remove(thing)

    def with_tangent(self, m, kind, **values):
        """The material, its first node with a Tangent linked to it."""
        tree = m.node_tree
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type = kind
        for name, value in values.items():
            setattr(tangent, name, value)
        shader = tree.nodes["Material Output"].inputs["Surface"].links[0].from_node
        tree.links.new(tangent.outputs[0], shader.inputs["Tangent"])
        return m

    def test_principled(self):
        for turn in (0.0, 0.15):
            inputs = dict(Base_Color=(0.9, 0.7, 0.4, 1), Metallic=1.0, Roughness=0.35, Anisotropic=0.8, Anisotropic_Rotation=turn)
            with self.subTest(turn=turn):
                self.assert_as_cycles_on_both(material(**inputs))
        with self.subTest("of a dielectric"):
            self.assert_as_cycles_on_both(material(Base_Color=(0.1, 0.05, 0.02, 1), Roughness=0.3, Anisotropic=0.9))

    def test_tangents(self):
        for kind, values in (("RADIAL", dict(axis="X")), ("RADIAL", dict(axis="Y")), ("UV_MAP", {})):
            m = material(Base_Color=(0.8, 0.8, 0.8, 1), Metallic=1.0, Roughness=0.35, Anisotropic=0.9, Anisotropic_Rotation=0.1)
            with self.subTest(kind=kind, **values):
                # Around x and y there is no tangent in the middle of a flat thing.
                self.assert_as_cycles_on_both(self.with_tangent(m, kind, **values), kind == "UV_MAP")

    def test_glossy(self):
        kind = "BsdfGlossy" if bpy.app.version >= (4, 0, 0) else "BsdfAnisotropic"
        for anisotropy in (0.7, -0.7):
            with self.subTest(anisotropy=anisotropy):
                self.assert_as_cycles_on_both(self.shader(kind, Color=(0.8, 0.8, 0.8, 1), Roughness=0.3, Anisotropy=anisotropy, Rotation=0.1))

    @unittest.skipIf(bpy.app.version < (4, 3, 0), "Blender before 4.3")
    def test_metallic(self):
        for anisotropy in (0.7, -0.5):
            with self.subTest(anisotropy=anisotropy):
                self.assert_as_cycles_on_both(self.shader("BsdfMetallic", Roughness=0.3, Anisotropy=anisotropy, Rotation=0.05))

    def test_what_is_not_supported_is_told(self):
        m = material(Metallic=1.0, Anisotropic=0.8)
        tree = m.node_tree
        bump, noise = tree.nodes.new("ShaderNodeBump"), tree.nodes.new("ShaderNodeTexNoise")
        tree.links.new(noise.outputs[0], bump.inputs["Height"])
        tree.links.new(bump.outputs[0], tree.nodes["Principled BSDF"].inputs["Normal"])
        self.thing("plane", m)
        self.export()
        self.assertTrue(any("goes along the UV map, as its normals are changed" in w for w in self.warnings), self.warnings)
