"""Light of shaders in mixtures and sums, against Cycles."""

import bpy
from addon_support import BlenderTest, material, mean, render
from node_trees import Tree


class EmissionTest(BlenderTest):
    def image(self, name, values):
        image = bpy.data.images.new(name, 2, 2, float_buffer=True)
        image.colorspace_settings.name = "Non-Color"
        image.pixels = [channel for value in values for channel in (value, value, value, 1)]
        return image

    def node(self, tree, kind, *parts):
        """A shader's node: ("light", strength), ("principled", strength, alpha), ("matt",), ("clear",), ("mix", share, first, second)
        or ("add", first, second). Numbers may be images."""
        node = tree.nodes.new({"mix": "ShaderNodeMixShader", "add": "ShaderNodeAddShader", "clear": "ShaderNodeBsdfTransparent",
                               "matt": "ShaderNodeBsdfDiffuse", "principled": "ShaderNodeBsdfPrincipled",
                               "light": "ShaderNodeEmission"}[kind])
        colour = (1, 0.5, 0.25, 1)
        if kind == "matt":
            node.inputs["Color"].default_value = (0, 0, 0, 1)
        if kind == "light":
            node.inputs["Color"].default_value = colour
        if kind == "principled":
            node.inputs["Base Color"].default_value, node.inputs["Roughness"].default_value = (0, 0, 0, 1), 1
            node.inputs["Specular IOR Level" if "Specular IOR Level" in node.inputs else "Specular"].default_value = 0
            node.inputs["Emission Color" if "Emission Color" in node.inputs else "Emission"].default_value = colour
        numbers = {"mix": (node.inputs[0],), "light": [s for s in node.inputs if s.name == "Strength"],
                   "principled": [node.inputs[name] for name in ("Emission Strength", "Alpha") if name in node.inputs]}.get(kind, ())
        for socket, number in zip(numbers, parts):
            if isinstance(number, float):
                socket.default_value = number
            else:
                texture = tree.nodes.new("ShaderNodeTexImage")
                texture.image = number
                tree.links.new(texture.outputs["Color"], socket)
        for socket, part in zip(node.inputs[-2:], parts[-2:] if kind in ("mix", "add") else ()):
            tree.links.new(self.node(tree, *part).outputs[0], socket)
        return node

    def material_of(self, tree):
        m = bpy.data.materials.new("light")
        m.use_nodes = True
        m.node_tree.links.new(self.node(m.node_tree, *tree).outputs[0], m.node_tree.nodes["Material Output"].inputs["Surface"])
        return m

    def test_mixtures_weaken_light_as_in_cycles(self):
        light, matt, clear = ("light", 2.0), ("matt",), ("clear",)
        principled = ("principled", 3.0, 1.0)
        mask, strength = self.image("mask", (0.2, 0.9, 0.4, 0.7)), self.image("strength", (1.0, 3.0, 2.0, 0.5))
        for tree in (("mix", 0.3, matt, light), ("mix", 0.3, light, matt), ("mix", 0.6, matt, principled),
                     ("mix", 0.5, ("mix", 0.25, light, matt), ("mix", 0.4, principled, matt)),
                     ("mix", 0.5, clear, ("mix", 0.4, light, matt)), ("mix", 0.7, ("mix", 0.4, clear, light), matt),
                     ("mix", 0.5, matt, ("principled", 3.0, 0.4)), ("add", light, ("mix", 0.5, light, matt)),
                     ("mix", 0.0, light, principled), ("mix", mask, matt, light), ("mix", 0.5, matt, ("mix", mask, principled, light)),
                     ("mix", mask, light, clear), ("mix", 0.5, matt, ("light", strength))):
            plane = self.plane(self.material_of(tree))
            with self.subTest(tree=tree):
                ours, theirs = mean(render("COVTRACE", 64)), mean(render("CYCLES", 64))
                for a, b in zip(ours, theirs):
                    self.assertAlmostEqual(a / b, 1, delta=0.02)
                self.export()
                self.assertEqual(self.warnings, [])
            bpy.data.objects.remove(plane)

    def test_masks_finer_than_texels_keep_their_light(self):
        """The light of what a mask shows on something clear: texels of the light and of the mask are means each."""
        for parts in ((("clear",), ("light", 2.0)), (("light", 2.0), ("clear",)), (("clear",), ("mix", 0.4, ("light", 2.0), ("matt",)))):
            m = self.material_of(("mix", 0.5, *parts))
            tree = Tree.of(m)
            slanted = tree.node("Math", {"operation": "MULTIPLY_ADD"}, {0: tree.number(), 1: 700.0, 2: tree.number(1)})
            fraction = tree.node("Math", {"operation": "FRACT"}, {0: slanted})
            mask = tree.node("Math", {"operation": "LESS_THAN"}, {0: fraction, 1: 0.3})
            m.node_tree.links.new(mask.outputs[0], self.top_of(m).inputs[0])
            # A colour that varies makes an image of the light, too.
            light = next(node for node in m.node_tree.nodes if node.type == "EMISSION")
            m.node_tree.links.new(tree.colours().outputs[0], light.inputs["Color"])
            plane = self.plane(m)
            with self.subTest(parts=parts):
                self.assert_as_cycles(0.02)
            bpy.data.objects.remove(plane)

    def test_colours_and_numbers_shine_where_shaders_are_asked_for(self):
        m = self.material_of(("mix", 0.3, ("matt",), ("matt",)))
        tree, mix = Tree.of(m), self.top_of(m)
        m.node_tree.links.new(tree.colours().outputs[0], mix.inputs[2])
        number = tree.node("Math", {"operation": "ADD"}, {0: tree.number(), 1: 0.5})
        plane = self.plane(m)
        for node, end in ((None, mix), (number, mix.inputs[1]), (tree.colours(), self.output_of(m)), (number, self.output_of(m))):
            if node:
                m.node_tree.links.new(node.outputs[0], end)
            with self.subTest(node=node and node.type, end=end.name):
                self.assert_as_cycles(0.02)
                self.export()
                self.assertEqual(self.warnings, [])
        bpy.data.objects.remove(plane)

    @staticmethod
    def output_of(m):
        return m.node_tree.nodes["Material Output"].inputs["Surface"]

    def top_of(self, m):
        """The shader's node that a material is."""
        return self.output_of(m).links[0].from_node

    def test_light_that_is_not_weakened_is_told(self):
        mask = self.image("mask", (0.2, 0.9, 0.4, 0.7))
        m = self.material_of(("mix", mask, ("matt",), ("light", 1.0)))
        tree = m.node_tree
        light = next(node for node in tree.nodes if node.type == "EMISSION")
        shown = tree.nodes.new("ShaderNodeTexImage")
        shown.image = mask
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Reflection"], shown.inputs["Vector"])
        tree.links.new(shown.outputs["Color"], light.inputs["Color"])
        self.plane(m)
        self.export()
        self.assertTrue(any("alone is there, and not weakened" in w for w in self.warnings), self.warnings)

    def test_light_that_is_added_to_what_lets_light_pass_is_whole(self):
        self.background.inputs["Color"].default_value = (0.3, 0.4, 0.5, 1)
        glow, mask = ("add", ("light", 2.0), ("clear",)), self.image("mask", (0.2, 0.9, 0.4, 0.7))
        for tree in (glow, ("mix", 0.5, glow, ("matt",)), ("mix", mask, glow, ("matt",)), ("mix", 0.5, ("clear",), ("mix", 0.5, ("clear",), glow)),
                     ("add", ("light", 0.5), ("principled", 1.0, 0.4))):
            plane = self.plane(self.material_of(tree))
            with self.subTest(tree=tree):
                self.assert_as_cycles(0.02)
                self.export()
                self.assertEqual(self.warnings, [])
            bpy.data.objects.remove(plane)

    def test_light_lets_shadows_pass(self):
        """A pane that shines and lets light pass casts no shadow on the floor below."""
        self.plane(material(**self.MATT))
        pane = self.plane(self.material_of(("add", ("light", 0.2), ("clear",))), size=1, z=1)
        self.lamp("POINT", energy=200, location=(0.5, 0, 4))
        self.assert_as_cycles(0.02)
        shone = mean(render("COVTRACE", 64))[0]
        bpy.data.objects.remove(pane)
        self.assertGreater(shone, mean(render("COVTRACE", 64))[0])

    def test_lamps_shine_through_mixtures_as_in_cycles(self):
        lamp = self.lamp("POINT", energy=400, shadow_soft_size=0).data
        lamp.use_nodes = True
        tree = lamp.node_tree
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        matt = bpy.data.materials.new("floor")
        matt.use_nodes = False
        self.plane(matt)
        for parts in (("mix", 0.3, ("light", 2.0), ("mix", 0.5, ("matt",), ("light", 4.0))), ("add", ("light", 1.0), ("light", 0.5))):
            tree.links.new(self.node(tree, *parts).outputs[0], tree.nodes["Light Output"].inputs["Surface"])
            with self.subTest(parts=parts):
                for a, b in zip(mean(render("COVTRACE", 32)), mean(render("CYCLES", 32))):
                    self.assertAlmostEqual(a / b, 1, delta=0.03)
                self.export()
                self.assertEqual(self.warnings, [])
