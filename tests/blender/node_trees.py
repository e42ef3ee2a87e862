"""Materials as trees of nodes, for tests."""

import bpy

BLUE, ORANGE = (0.1, 0.2, 0.8, 1), (0.9, 0.5, 0.1, 1)


class Tree:
    """A material whose matt colour is what a node gives."""

    def __init__(self, name="nodes"):
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.shader = self.tree.nodes.new("ShaderNodeBsdfDiffuse")
        self.link(self.shader, "BSDF", self.tree.nodes["Material Output"].inputs["Surface"])

    @classmethod
    def of(cls, material):
        """That of a material which has nodes of its own."""
        found = cls.__new__(cls)
        found.material, found.tree = material, material.node_tree
        return found

    def link(self, node, output, socket):
        self.tree.links.new(node.outputs[output], socket)

    def node(self, kind, settings=None, inputs=None):
        """A node; inputs: by name or index, values or (node, output)."""
        node = self.tree.nodes.new("ShaderNode" + kind)
        for key, value in (settings or {}).items():
            setattr(node, key, value)
        for key, value in (inputs or {}).items():
            socket = node.inputs[key]
            if isinstance(value, tuple) and isinstance(value[0], bpy.types.Node):
                self.link(*value, socket)
            elif isinstance(value, bpy.types.Node):
                self.link(value, 0, socket)
            else:
                socket.default_value = value
        return node

    def uv(self):
        return self.node("TexCoord"), "UV"

    def colours(self):
        """A colour that changes in all three channels over the plane."""
        parts = self.node("SeparateXYZ", inputs={0: self.uv()})
        product = self.node("Math", {"operation": "MULTIPLY"}, {0: (parts, 0), 1: (parts, 1)})
        return self.node("CombineColor", inputs={0: (parts, 0), 1: (parts, 1), 2: product})

    def number(self, axis=0):
        return self.node("SeparateXYZ", inputs={0: self.uv()}), axis

    def show(self, node, output=0):
        self.link(node, output, self.shader.inputs["Color"])
