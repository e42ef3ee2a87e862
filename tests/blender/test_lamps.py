"""Lamps and worlds of the add-on, against closed forms and Cycles."""

import math

import bpy
from addon_support import BlenderTest, material, mean, render


class LampsTest(BlenderTest):
    @staticmethod
    def sky_image():
        """Red and blue tell the longitude, green the latitude. The rows at the two poles are alike, as Cycles interpolates
        between them where nothing lies beyond a pole, and here no other row does."""
        image = bpy.data.images.new("sky", 12, 6, float_buffer=True)
        rows = (0.3, 0, 0.4, 0.6, 1, 0.3)
        image.pixels = [v for i in range(72) for v in (i % 12 / 11, rows[i // 12], (i * 5 % 12) / 11, 1)]
        return image

    def test_point_lamp_of_watts(self):
        self.plane(material(**self.MATT))
        self.lamp("POINT", energy=400, shadow_soft_size=0)
        # Irradiance W / (4 pi d^2) times reflectance / pi; 3 % for the fall-off over the pixels.
        expected = 400 / (4 * math.pi * 9) * 0.5 / math.pi
        self.assertAlmostEqual(self.centre() / expected, 1, delta=0.03)

    def test_sun_of_watts_per_square_metre(self):
        self.plane(material(**self.MATT))
        self.lamp("SUN", energy=3, angle=0)
        self.assertAlmostEqual(self.centre() / (3 * 0.5 / math.pi), 1, delta=0.01)

    def test_lamps_as_cycles_has_them(self):
        self.plane(material(**self.MATT))
        self.lamp("POINT", energy=100, shadow_soft_size=0.5, location=(-2, 0, 2), color=(1, 0.5, 0.2))
        self.lamp("SPOT", energy=300, spot_size=1.0, spot_blend=0.5, shadow_soft_size=0, location=(2, 0, 3))
        area = self.lamp("AREA", energy=50, shape="RECTANGLE", size=1, size_y=2, location=(0, 1, 2))
        area.rotation_euler = (0.5, 0, 0)
        self.assert_as_cycles(0.03)

    def test_spots_without_blend_have_sharp_cones(self):
        self.plane(material(**self.MATT))
        for size in (35, 45, 80):  # degrees whose cosine's arc cosine is a rounding larger
            lamp = self.lamp("SPOT", energy=300, spot_size=math.radians(size), spot_blend=0, shadow_soft_size=0,
                             location=(0, 0, 3))
            self.assertGreater(self.centre(), 0.1)
            bpy.data.objects.remove(lamp)

    def test_lamps_shine_through_their_nodes(self):
        self.plane(material(**self.MATT))
        lamp = self.lamp("POINT", energy=400, shadow_soft_size=0).data
        plain = self.centre()
        lamp.use_nodes = True
        emission = lamp.node_tree.nodes["Emission"]
        emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (0.5, 0.5, 0.5, 1), 3
        self.assertAlmostEqual(self.centre() / plain, 1.5, delta=0.01)

    def test_constants_of_lamps_are_as_in_cycles(self):
        """Trees of nodes that are the same in all directions, and Light Path, by which lamps are lit for rays of no kind."""
        self.plane(material(**self.MATT))
        lamp = self.lamp("POINT", energy=200, shadow_soft_size=0).data
        lamp.use_nodes = True
        tree = lamp.node_tree
        emission, path, ramp = tree.nodes["Emission"], tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeValToRGB")
        add, mixed = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(path.outputs["Is Camera Ray"], add.inputs[0])
        add.inputs[1].default_value = 1.5
        tree.links.new(add.outputs[0], emission.inputs["Strength"])
        ramp.color_ramp.elements[0].color, ramp.inputs["Fac"].default_value = (1, 0.2, 0.1, 1), 0.3
        tree.links.new(ramp.outputs["Color"], emission.inputs["Color"])
        tree.links.new(path.outputs["Is Camera Ray"], mixed.inputs[0])
        tree.links.new(emission.outputs[0], mixed.inputs[1])
        tree.links.new(mixed.outputs[0], tree.nodes["Light Output"].inputs["Surface"])
        self.assert_as_cycles(0.03)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_world_image_stands_as_in_cycles(self):
        image = self.sky_image()
        node = self.scene.world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        node.image, node.interpolation = image, "Linear"
        self.scene.world.node_tree.links.new(node.outputs["Color"], self.background.inputs["Color"])
        self.camera.data.lens = 10
        for turn in ((math.pi / 2, 0, 0.3), (math.pi / 2, 0, 2.5), (0.4, 0, 0)):
            self.camera.rotation_euler = turn
            ours, theirs = mean(render("COVTRACE", 16)), mean(render("CYCLES", 16))
            for a, b in zip(ours, theirs):
                self.assertAlmostEqual(a, b, delta=0.01)

    def test_the_mapping_node_turns_the_world(self):
        image = self.sky_image()
        tree = self.scene.world.node_tree
        node, mapping, place = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Mapping", "TexCoord"))
        node.image = image
        tree.links.new(node.outputs["Color"], self.background.inputs["Color"])
        tree.links.new(place.outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
        self.camera.data.lens = 10
        for kind, turn in (("POINT", (0, 0, 1.2)), ("POINT", (0.5, -0.3, 2)), ("TEXTURE", (0.5, -0.3, 2))):
            mapping.vector_type = kind
            mapping.inputs["Rotation"].default_value = turn
            for view in ((math.pi / 2, 0, 0.3), (0.4, 0, 0)):
                self.camera.rotation_euler = view
                ours, theirs = mean(render("COVTRACE", 16)), mean(render("CYCLES", 16))
                for a, b in zip(ours, theirs):
                    self.assertAlmostEqual(a, b, delta=0.01, msg=f"{kind} {turn} {view}")
        self.export()
        self.assertEqual(self.warnings, [])

    def test_temperatures_have_cycles_colours(self):
        self.plane(material(**self.MATT))
        lamp = self.lamp("POINT", energy=400, shadow_soft_size=0).data
        lamp.use_nodes = True
        for kelvin in (2700, 6500, 11000):
            node = lamp.node_tree.nodes.new("ShaderNodeBlackbody")
            node.inputs["Temperature"].default_value = kelvin
            lamp.node_tree.links.new(node.outputs["Color"], lamp.node_tree.nodes["Emission"].inputs["Color"])
            ours, theirs = mean(render("COVTRACE", 16)), mean(render("CYCLES", 16))
            for a, b in zip(ours, theirs):
                self.assertAlmostEqual(a / theirs[1], b / theirs[1], delta=0.04, msg=f"{kelvin} K: {ours} against {theirs}")
