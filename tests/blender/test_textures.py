"""The places of images on surfaces, their wrapping and their light, against Cycles."""

import os
import tempfile
import unittest.mock

import bpy
from addon_support import BlenderTest, material, mean, render, socket
from covtrace_blender import body_baking, tiled_images
from covtrace_blender.baking import Baker
from node_trees import Tree


class TexturesTest(BlenderTest):
    def test_textures_lie_as_in_cycles(self):
        # Texels are the nearest ones: Cycles interpolates bytes before it decodes them, which
        # contrasts as hard as these would show.
        m = self.image_material()
        self.plane(m, size=3)
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        # A turn or flip would change these means by more than 0.1.
        self.assert_quarters_as_cycles(samples=64)

    def image_material(self, size=4, extension="REPEAT", uv_map=None, is_float=False):
        """A material with an image whose texels all differ, so that no turn or flip goes unseen."""
        image = bpy.data.images.new("texels", size, size, float_buffer=is_float)
        image.pixels = [v for i in range(size * size) for v in (i / 15, (i * 7 % 16) / 15, (i % 4) / 3, 1)]
        m = bpy.data.materials.new("shown")
        m.use_nodes = True
        tree = m.node_tree
        texture, principled = tree.nodes.new("ShaderNodeTexImage"), tree.nodes["Principled BSDF"]
        texture.image, texture.interpolation, texture.extension = image, "Closest", extension
        # The roughness at which Cycles' diffuse base is within 1 % of Lambert's (decision 0051).
        socket(principled, "Specular").default_value, principled.inputs["Roughness"].default_value = 0, 0.3
        tree.links.new(texture.outputs["Color"], principled.inputs["Base Color"])
        if uv_map is not None:
            node = tree.nodes.new("ShaderNodeUVMap")
            node.uv_map = uv_map
            tree.links.new(node.outputs["UV"], texture.inputs["Vector"])
        return m

    def assert_quarters_as_cycles(self, delta=0.02, samples=32):
        ours, theirs = render("COVTRACE", samples), render("CYCLES", samples)
        for y0, y1 in ((2, 12), (12, 22)):
            for x0, x1 in ((6, 16), (16, 26)):
                for a, b in zip(mean(ours, x0, y0, x1, y1), mean(theirs, x0, y0, x1, y1)):
                    self.assertAlmostEqual(a, b, delta=delta)

    def test_nodes_without_an_image_are_as_in_cycles(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        for output in ("Color", "Alpha"):
            tree = Tree(output)
            # Half of it: the light of magenta alone would have no green, of which no share could be off.
            half = tree.node("Mix", {"data_type": "RGBA"}, {0: 0.5, 6: (tree.node("TexImage"), output), 7: (0.2, 0.4, 0.6, 1)})
            tree.show(half, 2)
            plane = self.plane(tree.material, size=3)
            with self.subTest(output):
                self.assert_quarters_as_cycles()
                self.export()
                self.assertEqual(self.warnings, [])
            bpy.data.objects.remove(plane)

    def test_uv_maps_are_those_of_the_render(self):
        # The UV maps selected in the editor, active for the render, and named by a node all differ.
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        for uv_map in (None, "", "named"):
            plane = self.plane(self.image_material(uv_map=uv_map), size=3)
            layers = plane.data.uv_layers
            for k, name in enumerate(("for the render", "named")):
                layer = layers.new(name=name)
                for loop in layer.data:
                    loop.uv = (1 - loop.uv[0], loop.uv[1]) if k else (loop.uv[1], loop.uv[0])
            layers["for the render"].active_render = True
            layers.active = layers[0]
            with self.subTest(uv_map):
                self.assert_quarters_as_cycles()
                self.export()
                self.assertEqual(self.warnings, [])
            bpy.data.objects.remove(plane)

    def test_inputs_lie_on_uv_maps_of_their_own(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        m = bpy.data.materials.new("two")
        m.use_nodes = True
        tree = m.node_tree
        mix = tree.nodes.new("ShaderNodeMixShader")
        for number, (name, channels) in enumerate((("", (0, 0.5)), ("other", (0.5, 0)))):
            image = bpy.data.images.new("ramp", 32, 32, float_buffer=True)
            image.pixels = [v for y in range(32) for x in range(32) for v in (*(c * x / 31 for c in channels), y / 31, 1)]
            texture, matt, uv_map = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexImage", "BsdfDiffuse", "UVMap"))
            texture.image, uv_map.uv_map = image, name
            tree.links.new(uv_map.outputs[0], texture.inputs["Vector"])
            tree.links.new(texture.outputs["Color"], matt.inputs["Color"])
            tree.links.new(matt.outputs[0], mix.inputs[1 + number])
        tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        plane = self.plane(m, size=3)
        for loop in plane.data.uv_layers.new(name="other").data:
            loop.uv = (1 - loop.uv[1], loop.uv[0])
        self.assert_quarters_as_cycles()
        self.export()
        self.assertEqual(self.warnings, [])
        # Where both names are of one map, the images are used as they are.
        plane.data.uv_layers["other"].active_render = True
        self.assert_quarters_as_cycles()
        with unittest.mock.patch.object(body_baking, "BodyPlace", side_effect=AssertionError):
            self.export()
        self.assertEqual(self.warnings, [])

    def test_what_paints_may_change_is_baked_once_an_export(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        image = bpy.data.images.new("painted", 2, 2, float_buffer=True)
        image.colorspace_settings.name = "Non-Color"
        m = bpy.data.materials.new("mask")
        m.use_nodes = True
        tree = m.node_tree
        texture, half, mix, clear = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexImage", "Math", "MixShader", "BsdfTransparent"))
        texture.image, half.operation, half.inputs[1].default_value = image, "MULTIPLY", 0.5
        for start, end in ((texture.outputs["Color"], half.inputs[0]), (half.outputs[0], mix.inputs[0]), (clear.outputs[0], mix.inputs[1]),
                           (mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])):
            tree.links.new(start, end)
        self.plane(m)
        for value in (0.2, 0.8):  # of which half is opaque and black
            image.pixels = [value, value, value, 1] * 4
            with unittest.mock.patch.object(Baker, "bake", autospec=True, side_effect=Baker.bake) as bake:
                self.assertAlmostEqual(mean(render("COVTRACE", 16))[0], 1 - 0.5 * value, delta=0.02)
            self.assertEqual(bake.call_count, 1)

    def test_images_whose_files_are_missing_are_magenta_as_in_cycles(self):
        image = bpy.data.images.new("lost", 4, 4)
        image.source, image.filepath = "FILE", "//lost.png"
        m = bpy.data.materials.new("shown")
        m.use_nodes = True
        texture, emission = m.node_tree.nodes.new("ShaderNodeTexImage"), m.node_tree.nodes.new("ShaderNodeEmission")
        m.node_tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
        m.node_tree.links.new(emission.outputs["Emission"], m.node_tree.nodes["Material Output"].inputs["Surface"])
        self.plane(m, size=1)
        world = self.scene.world.node_tree
        around = world.nodes.new("ShaderNodeTexEnvironment")
        around.image = texture.image = image
        world.links.new(around.outputs["Color"], self.background.inputs["Color"])
        self.background.inputs["Strength"].default_value = 0.5
        ours, theirs = render("COVTRACE", 4), render("CYCLES", 4)
        for place in ((14, 10, 18, 14), (0, 0, 4, 4)):
            self.assertGreater(mean(theirs, *place)[0], 0.4)
            for a, b in zip(mean(ours, *place), mean(theirs, *place)):
                self.assertAlmostEqual(a, b, delta=0.01)
        self.export()
        self.assertEqual(len([w for w in self.warnings if "//lost.png" in w]), 1, self.warnings)
        # The image is baked where other nodes hang on it.
        gamma = m.node_tree.nodes.new("ShaderNodeGamma")
        gamma.inputs["Gamma"].default_value = 2
        m.node_tree.links.new(texture.outputs["Color"], gamma.inputs["Color"])
        m.node_tree.links.new(gamma.outputs["Color"], emission.inputs["Color"])
        for a, b in zip(mean(render("COVTRACE", 4), 14, 10, 18, 14), (1, 0, 1)):
            self.assertAlmostEqual(a, b, delta=0.01)

    def tiled_image(self, folder):
        """An image of three tiles around the origin's corner, the second of which is finer, and the file of a fourth is missing."""
        for number, colour, size in ((1001, (0.8, 0.1, 0.2, 1), 4), (1002, (0.1, 0.7, 0.3, 1), 8), (1011, (0.2, 0.3, 0.9, 1), 4)):
            tile = bpy.data.images.new("tile", size, size)
            tile.pixels = colour * (size * size)
            tile.filepath_raw, tile.file_format = os.path.join(folder, f"skin.{number}.png"), "PNG"
            tile.save()
        image = bpy.data.images.load(os.path.join(folder, "skin.1001.png"))
        image.source, image.filepath = "TILED", os.path.join(folder, "skin.<UDIM>.png")
        for number in (1002, 1011, 1012):
            if all(tile.number != number for tile in image.tiles):
                image.tiles.new(number)
        return image

    def test_tiles_lie_as_in_cycles(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        m = self.image_material()
        plane = self.plane(m, size=3)
        for loop in plane.data.uv_layers[0].data:
            loop.uv = (2 * loop.uv[0], 2 * loop.uv[1])
        texture = next(node for node in m.node_tree.nodes if node.type == "TEX_IMAGE")
        with tempfile.TemporaryDirectory() as folder:
            texture.image = self.tiled_image(folder)
            self.assert_quarters_as_cycles()
            self.export()
            self.assertEqual(len([w for w in self.warnings if "tile 1012" in w]), 1, self.warnings)
            with unittest.mock.patch.object(tiled_images, "_tile") as read:
                self.export()
                read.assert_not_called()
            self.assertEqual(len([w for w in self.warnings if "tile 1012" in w]), 1, self.warnings)
            gamma = m.node_tree.nodes.new("ShaderNodeGamma")
            gamma.inputs["Gamma"].default_value = 1.5
            m.node_tree.links.new(texture.outputs["Color"], gamma.inputs["Color"])
            m.node_tree.links.new(gamma.outputs["Color"], m.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
            self.assert_quarters_as_cycles()

    def test_normal_maps_are_scaled_as_in_cycles(self):
        """A map that leans to the right in its left half and to the left in its right one; its left half alone is shown."""
        self.lamp("SUN", energy=3).rotation_euler = (0, 0.7, 0)
        m = self.image_material()
        tree = m.node_tree
        texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
        texture.image.colorspace_settings.name = "Non-Color"
        texture.image.pixels = [v for i in range(16) for v in (0.8 if i % 4 < 2 else 0.2, 0.5, 0.9, 1)]
        normals, mapping = tree.nodes.new("ShaderNodeNormalMap"), tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = (0.5, 1, 1)
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
        tree.links.new(texture.outputs["Color"], normals.inputs["Color"])
        principled = tree.nodes["Principled BSDF"]
        tree.links.remove(principled.inputs["Base Color"].links[0])
        tree.links.new(normals.outputs["Normal"], principled.inputs["Normal"])
        self.plane(m, size=3)
        self.assert_quarters_as_cycles()
        self.export()
        self.assertEqual(self.warnings, [])

    def test_images_go_on_as_in_cycles(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        for extension in ("REPEAT", "EXTEND", "CLIP"):
            plane = self.plane(self.image_material(extension=extension), size=3)
            for loop in plane.data.uv_layers[0].data:
                loop.uv = (2 * loop.uv[0] - 0.25, 2 * loop.uv[1] - 0.75)
            with self.subTest(extension):
                self.assert_quarters_as_cycles()
            bpy.data.objects.remove(plane)

    def test_images_shine_beyond_white(self):
        image = bpy.data.images.new("bright", 2, 2, float_buffer=True)
        image.pixels = [v for i in range(4) for v in (4, 2 * i, 0.25, 1)]
        m = material(Base_Color=(0, 0, 0, 1), Specular=0.0, Emission_Strength=1.5)
        texture = m.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        m.node_tree.links.new(texture.outputs["Color"], socket(m.node_tree.nodes["Principled BSDF"], "Emission"))
        self.plane(m, size=20)
        ours, theirs = mean(render("COVTRACE", 64)), mean(render("CYCLES", 64))
        for a, b in zip(ours, theirs):
            self.assertAlmostEqual(a / b, 1, delta=0.02, msg=f"{ours} against {theirs}")

    def test_opacity_of_images_counts_as_in_cycles(self):
        """Colours are multiplied by it where nothing reads Alpha, but for data and channels that are packed."""
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.scene.covtrace.method = "uniform"
        for mode, space, is_float, reads in (("STRAIGHT", "sRGB", False, False), ("STRAIGHT", "sRGB", False, True), ("PREMUL", "sRGB", False, False),
                                             ("CHANNEL_PACKED", "sRGB", False, False), ("STRAIGHT", "Non-Color", False, False),
                                             ("PREMUL", "", True, False), ("PREMUL", "", True, True)):
            image = bpy.data.images.new("image", 2, 2, alpha=True, float_buffer=is_float)
            if space:
                image.colorspace_settings.name = space
            image.pixels = [0.35, 0.15, 0.25, 0.5] * 4
            image.pack()
            image.alpha_mode = mode
            tree = Tree("image")
            node = tree.node("TexImage", {"image": image})
            tree.show(node)
            if reads:
                add = tree.node("Math", {"operation": "MULTIPLY"}, {0: (node, "Alpha"), 1: 0.05})
                tree.link(add, 0, tree.shader.inputs["Roughness"])
            plane = self.plane(tree.material)
            with self.subTest(mode=mode, space=space, is_float=is_float, reads=reads):
                for a, b in zip(mean(render("COVTRACE", 4)), mean(render("CYCLES", 4))):
                    self.assertAlmostEqual(a, b, delta=0.02)
            bpy.data.objects.remove(plane)

    def test_colour_spaces_of_images_are_told(self):
        image = bpy.data.images.new("image", 2, 2)
        image.colorspace_settings.name = "Filmic sRGB"
        tree = Tree("image")
        tree.show(tree.node("TexImage", {"image": image}))
        self.plane(tree.material)
        self.export()
        self.assertEqual(self.warnings, ["the image 'image' is in the colour space Filmic sRGB, which is not supported; it is taken as sRGB"])
