"""Point clouds, against Cycles."""

import bpy
from addon_support import CyclesTest, geometry_tree


class PointsTest(CyclesTest):
    def cloud(self, m, radius, size=2, group="points"):
        """Points at the vertices of a grid that geometry nodes make, with a radius that grows along x."""
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=size)
        obj = bpy.context.object
        tree = geometry_tree(group)
        nodes, links = tree.nodes, tree.links
        start, points, coat, end = (nodes.new(kind) for kind in ("NodeGroupInput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial",
                                                                  "NodeGroupOutput"))
        position, axes, times = nodes.new("GeometryNodeInputPosition"), nodes.new("ShaderNodeSeparateXYZ"), nodes.new("ShaderNodeMath")
        times.operation = "MULTIPLY_ADD"
        times.inputs[1].default_value, times.inputs[2].default_value = radius / size, radius
        coat.inputs["Material"].default_value = m
        links.new(start.outputs[0], points.inputs["Mesh"])
        links.new(position.outputs[0], axes.inputs[0])
        links.new(axes.outputs[0], times.inputs[0])
        links.new(times.outputs[0], points.inputs["Radius"])
        links.new(points.outputs[0], coat.inputs["Geometry"])
        links.new(coat.outputs[0], end.inputs[0])
        obj.modifiers.new("points", "NODES").node_group = tree
        return obj

    def test_points_are_spheres_of_their_radius(self):
        self.cloud(self.shader("BsdfDiffuse", Color=(0.8, 0.4, 0.2, 1)), 0.12).scale = (0.9, 0.9, 0.9)
        self.plane(self.shader("BsdfDiffuse", Color=(0.3, 0.3, 0.3, 1)), size=6, z=-0.3)
        self.lamp("SUN", energy=3, angle=0.1).rotation_euler = (0.6, 0.4, 0)
        self.assert_parts_as_cycles(0.05, 128, samples_of_cycles=128)
        self.assertEqual(self.export().count('Shape "sphere"'), 49)
        self.assertEqual(self.warnings, [])

    def test_points_that_shine(self):
        self.cloud(self.shader("Emission", Color=(1, 0.6, 0.2, 1), Strength=6.0), 0.05)
        self.plane(self.shader("BsdfDiffuse", Color=(0.6, 0.6, 0.6, 1)), size=6, z=-0.3)
        self.assert_parts_as_cycles(0.05, 128, samples_of_cycles=256)
