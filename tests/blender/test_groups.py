"""Groups of nodes, muted nodes and links, and reroutes of materials, against Cycles."""

import itertools

import bpy
from addon_support import BlenderTest, material, mean, render, socket
from node_trees import Tree

IS_NEW = bpy.app.version >= (4, 0)


def plastic_group():
    """A group with the inputs Colour and Grey, whose output is a Principled that has the colour darkened by an inner group."""
    inner = bpy.data.node_groups.new("darker", "ShaderNodeTree")
    outer = bpy.data.node_groups.new("plastic", "ShaderNodeTree")
    for tree, sockets in ((inner, (("Colour", "INPUT", "Color"), ("Colour", "OUTPUT", "Color"))),
                          (outer, (("Colour", "INPUT", "Color"), ("Grey", "INPUT", "Float"), ("Surface", "OUTPUT", "Shader")))):
        for name, side, kind in sockets:
            if hasattr(tree, "interface"):
                tree.interface.new_socket(name, in_out=side, socket_type=f"NodeSocket{kind}")
            else:
                (tree.inputs if side == "INPUT" else tree.outputs).new(f"NodeSocket{kind}", name)
    ends = {tree: (tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")) for tree in (inner, outer)}
    gamma = inner.nodes.new("ShaderNodeGamma")
    gamma.inputs["Gamma"].default_value = 2
    inner.links.new(ends[inner][0].outputs["Colour"], gamma.inputs["Color"])
    inner.links.new(gamma.outputs[0], ends[inner][1].inputs["Colour"])
    darker, principled = outer.nodes.new("ShaderNodeGroup"), outer.nodes.new("ShaderNodeBsdfPrincipled")
    darker.node_tree = inner
    socket(principled, "Specular").default_value = 0
    outer.links.new(ends[outer][0].outputs["Colour"], darker.inputs["Colour"])
    outer.links.new(darker.outputs[0], principled.inputs["Base Color"])
    # A number where a colour is wanted
    outer.links.new(ends[outer][0].outputs["Grey"], principled.inputs["Emission Color" if IS_NEW else "Emission"])
    principled.inputs["Emission Strength"].default_value = 0.5
    outer.links.new(principled.outputs[0], ends[outer][1].inputs["Surface"])
    return outer


class GroupsTest(BlenderTest):
    def test_shaders_in_groups_are_as_in_cycles(self):
        """Groups in a Mix Shader, each with its own values of what it does not get by links, and a muted node."""
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        m, group = bpy.data.materials.new("grouped"), plastic_group()
        m.use_nodes = True
        tree = m.node_tree
        mix, output = tree.nodes.new("ShaderNodeMixShader"), tree.nodes["Material Output"]
        mix.inputs[0].default_value = 0.25
        for place, colour, grey in ((1, (0.9, 0.4, 0.2, 1), 0.1), (2, (0.1, 0.3, 0.8, 1), 0.3)):
            node = tree.nodes.new("ShaderNodeGroup")
            node.node_tree = group
            node.inputs["Colour"].default_value, node.inputs["Grey"].default_value = colour, grey
            tree.links.new(node.outputs[0], mix.inputs[place])
        tree.links.new(mix.outputs[0], output.inputs["Surface"])
        muted = tree.nodes.new("ShaderNodeInvert")
        tree.links.new(muted.outputs[0], tree.nodes["Group"].inputs["Colour"])
        colour = tree.nodes.new("ShaderNodeRGB")
        colour.outputs[0].default_value, muted.mute = (0.6, 0.4, 0.2, 1), True
        tree.links.new(colour.outputs[0], muted.inputs["Color"])
        self.plane(m)
        self.export()
        self.assertEqual(self.warnings, [])
        self.assert_as_cycles(0.02)

    def test_muted_shaders_pass_on_their_first_one(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        m = material()
        tree = m.node_tree
        mix, matt = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
        matt.inputs["Color"].default_value = (0.8, 0.3, 0.2, 1)
        tree.links.new(matt.outputs[0], mix.inputs[1])
        tree.links.new(tree.nodes.new("ShaderNodeEmission").outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        mix.mute = True
        self.plane(m)
        self.assert_as_cycles(0.02)

    @staticmethod
    def shining_material():
        """(material, Emission, RGB) of a new material that shines."""
        m = bpy.data.materials.new("shining")
        m.use_nodes = True
        tree = m.node_tree
        shader, source = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeRGB")
        source.outputs[0].default_value = (0.1, 0.6, 0.2, 1)
        tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        return m, shader, source

    @staticmethod
    def group_node(tree, kind):
        """A group node that hands on what reaches its one socket, of this kind."""
        group = bpy.data.node_groups.new(kind, "ShaderNodeTree")
        for side, sockets in (("INPUT", "inputs"), ("OUTPUT", "outputs")):
            if hasattr(group, "interface"):
                group.interface.new_socket("Passed", in_out=side, socket_type=f"NodeSocket{kind}")
            else:
                getattr(group, sockets).new(f"NodeSocket{kind}", "Passed")
        group.links.new(group.nodes.new("NodeGroupInput").outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree = group
        return node

    def assert_shines_as_cycles(self, m):
        plane = self.plane(m)
        for a, b in zip(mean(render("COVTRACE", 4)), mean(render("CYCLES", 4))):
            self.assertAlmostEqual(a, b, delta=2e-3)
        bpy.data.objects.remove(plane)

    def test_sockets_on_the_way_convert_as_in_cycles(self):
        """A colour that passes sockets of other types, of groups and of a muted node."""
        for kind, name in itertools.product(("Float", "Vector", "Muted"), ("Color", "Strength")):
            m, shader, source = self.shining_material()
            tree = m.node_tree
            if kind == "Muted":
                node = tree.nodes.new("ShaderNodeRGBToBW")
                node.mute = True
            else:
                node = self.group_node(tree, kind)
            tree.links.new(source.outputs[0], node.inputs[0])
            tree.links.new(node.outputs[0], shader.inputs[name])
            with self.subTest(kind, name=name):
                self.assert_shines_as_cycles(m)

    def test_ends_without_a_node_are_as_in_cycles(self):
        """A reroute and muted nodes that nothing feeds, a reroute inside of a group, and a group input of the outermost tree: zero or as no
        link, by the version of Blender."""
        for kind, name in itertools.product(("reroute", "muted", "number", "source", "twice", "inside", "outermost"), ("Color", "Strength")):
            m, shader, _ = self.shining_material()
            tree = m.node_tree
            shader.inputs["Color"].default_value, shader.inputs["Strength"].default_value = (0.3, 0.2, 0.6, 1), 1.5
            if kind == "reroute":
                node = tree.nodes.new("NodeReroute")
            elif kind == "muted":
                node = self.group_node(tree, "Color")
                node.mute, node.inputs[0].default_value = True, (0.9, 0.9, 0.9, 1)
            elif kind == "number":
                node = tree.nodes.new("ShaderNodeMath")
                node.mute, node.inputs[0].default_value = True, 0.8
            elif kind == "source":
                node = tree.nodes.new("ShaderNodeRGB")
                node.mute, node.outputs[0].default_value = True, (0.9, 0.8, 0.7, 1)
            elif kind == "twice":
                first, node = tree.nodes.new("ShaderNodeGamma"), tree.nodes.new("NodeReroute")
                first.mute, first.inputs[0].default_value = True, (0.9, 0.8, 0.7, 1)
                tree.links.new(first.outputs[0], node.inputs[0])
            elif kind == "inside":
                node = self.group_node(tree, "Color")
                inner = node.node_tree
                end = next(n for n in inner.nodes if n.type == "GROUP_OUTPUT")
                end.inputs[0].default_value = (0.9, 0.8, 0.7, 1)
                inner.links.new(inner.nodes.new("NodeReroute").outputs[0], end.inputs[0])
            else:
                if hasattr(tree, "interface"):
                    tree.interface.new_socket("Passed", in_out="INPUT", socket_type="NodeSocketColor")
                else:
                    tree.inputs.new("NodeSocketColor", "Passed")
                node = tree.nodes.new("NodeGroupInput")
            tree.links.new(node.outputs[0], shader.inputs[name])
            with self.subTest(kind, name=name):
                self.assert_shines_as_cycles(m)

    def test_the_output_may_be_in_a_group(self):
        m, _, _ = self.shining_material()
        node = self.group_node(m.node_tree, "Color")
        node.inputs[0].default_value = (0.1, 0.8, 0.6, 1)
        m.node_tree.nodes.remove(m.node_tree.nodes["Material Output"])
        inner = node.node_tree
        shader, output = inner.nodes.new("ShaderNodeEmission"), inner.nodes.new("ShaderNodeOutputMaterial")
        inner.links.new(next(n for n in inner.nodes if n.type == "GROUP_INPUT").outputs[0], shader.inputs["Color"])
        inner.links.new(shader.outputs[0], output.inputs["Surface"])
        self.assert_shines_as_cycles(m)

    def test_a_link_that_is_muted_is_baked_anew(self):
        tree = Tree()
        gamma = tree.node("Gamma", inputs={"Color": (tree.colours(), 0)})
        tree.show(gamma)
        self.plane(tree.material)
        self.assertIn("imagemap", self.export())
        gamma.inputs["Color"].links[0].is_muted = True
        self.assertNotIn("imagemap", self.export())
