"""The node Object Info, attributes of objects, islands and pointiness against Cycles: each object fills a cell of the picture."""

import bpy
import numpy as np
from addon_support import BlenderTest, render
from covtrace_blender import owner
from node_trees import Tree

CELL = 8  # pixels
COLUMNS = 4


class ObjectInfoTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.camera.data.type, self.scene.covtrace.method = "ORTHO", "uniform"

    def shining(self, *outputs):
        """A material that shines in as many outputs of Object Info as red, green and blue."""
        tree = Tree("told")
        node, shader = tree.node("ObjectInfo"), tree.node("Emission")
        if outputs[0] in ("Color", "Location"):
            tree.link(node, outputs[0], shader.inputs["Color"])
        else:
            colour = tree.node("CombineXYZ")
            for output, channel in zip(outputs, "XYZ"):
                tree.link(node, output, colour.inputs[channel])
            tree.link(colour, 0, shader.inputs["Color"])
        tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
        tree.material.pass_index = 3
        return tree.material

    def plane(self, m, count=0):
        bpy.ops.mesh.primitive_plane_add(size=1, location=(count % COLUMNS, count // COLUMNS, 0))
        bpy.context.object.data.materials.append(m)
        return bpy.context.object

    def cells(self, rows):
        """(rows, COLUMNS, 3) from the bottom: what both engines show of each cell."""
        self.scene.render.resolution_x, self.scene.render.resolution_y = CELL * COLUMNS, CELL * rows
        self.camera.location, self.camera.data.ortho_scale = ((COLUMNS - 1) / 2, (rows - 1) / 2, 5), max(COLUMNS, rows)
        found = []
        for engine in ("COVTRACE", "CYCLES"):
            image = render(engine, 4)
            channels = [np.reshape(image[f"Combined.{c}"], (rows, CELL, COLUMNS, CELL)) for c in "RGB"]
            found.append(np.stack([c[:, 2:-2, :, 2:-2].mean(axis=(1, 3)) for c in channels], axis=-1)[::-1])
        return found

    def test_objects_know_themselves(self):
        told = (("Color",), ("Location",), ("Random", "Object Index", "Material Index"))
        told += (("Alpha",),) if bpy.app.version >= (3, 4) else ()
        materials = [self.shining(*outputs) for outputs in told]
        for number in range(2 * len(materials)):
            thing = self.plane(materials[number % len(materials)], number)
            thing.color, thing.pass_index = (0.1 + 0.1 * number, 0.9 - 0.1 * number, 0.4, 0.5), number
        ours, theirs = self.cells(2)
        self.export()
        self.assertEqual(self.warnings, [])
        np.testing.assert_allclose(ours, theirs, atol=0.6 / owner.LEVELS, rtol=1e-3)

    def test_objects_have_attributes(self):
        """Properties of the user's own and Blender's; the object's go before its data's, and none is zero."""
        for number, (name, output) in enumerate((("tint", "Color"), ("tint", "Fac"), ("size", "Vector"), ("of data", "Color"),
                                                 ("color", "Alpha"), ("none", "Color"), ("none", "Alpha"), ("pass_index", "Fac"))):
            tree = Tree("told")
            node, shader = tree.node("Attribute", {"attribute_type": "OBJECT", "attribute_name": name}), tree.node("Emission")
            tree.tree.links.new(next(o for o in node.outputs if o.identifier == output), shader.inputs["Color"])
            tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
            thing = self.plane(tree.material, number)
            thing["tint"], thing["size"], thing.data["tint"], thing.data["of data"] = (0.1, 0.5, 0.9), 0.3, (1.0, 0.0, 0.0), [0.2, 0.6, 0.4, 0.5]
            thing.color, thing.pass_index = (0.1, 0.9, 0.4, 0.5), 1
        ours, theirs = self.cells(2)
        self.export()
        self.assertEqual(self.warnings, [])
        np.testing.assert_allclose(ours, theirs, atol=1e-3)

    def test_islands_differ_at_random(self):
        tree = Tree("islands")
        shader = tree.node("Emission")
        tree.link(tree.node("NewGeometry"), "Random Per Island", shader.inputs["Color"])
        tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
        mesh = bpy.data.meshes.new("islands")
        # Edges in no order, by which other vertices come to stand for a part
        corners = [(x + dx, y + dy, 0) for y in range(2) for x in range(COLUMNS) for dx, dy in ((-.5, -.5), (.45, -.5), (.45, .45), (-.5, .45))]
        edges = [(4 * n + a, 4 * n + b) for n in range(2 * COLUMNS) for a, b in ((2, 3), (1, 0), (3, 0), (1, 2))]
        mesh.from_pydata(corners, edges, [tuple(range(4 * n, 4 * n + 4)) for n in range(2 * COLUMNS)])
        mesh.materials.append(tree.material)
        self.scene.collection.objects.link(bpy.data.objects.new("islands", mesh))
        ours, theirs = self.cells(2)
        self.export()
        self.assertEqual(self.warnings, [])
        self.assertGreater(theirs.std(), 0.15)
        np.testing.assert_allclose(ours, theirs, atol=0.01)

    def test_places_as_the_camera_sees_them(self):
        outputs = ("View Vector", "View Z Depth", "View Distance")
        for number in range(2 * COLUMNS):
            tree = Tree("seen")
            node, scaled, shader = tree.node("CameraData"), tree.node("VectorMath", {"operation": "MULTIPLY_ADD"}), tree.node("Emission")
            tree.link(node, outputs[number % 3], scaled.inputs[0])
            scaled.inputs[1].default_value, scaled.inputs[2].default_value = (0.1, 0.1, 0.1) if number % 3 else (0.3, 0.3, 0.3), (0.4, 0.4, 0.4)
            tree.link(scaled, 0, shader.inputs["Color"])
            tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
            self.plane(tree.material, number).location.z = number / 20
        self.camera.data.type = "PERSP"
        self.camera.scale, self.camera.data.angle = (2, 2, 2), 0.7
        ours, theirs = self.cells(2)
        self.export()
        self.assertEqual(self.warnings, [])
        self.assertGreater(theirs.std(), 0.1)
        np.testing.assert_allclose(ours, theirs, atol=0.01)

    def test_wires(self):
        tree = Tree("wires")
        shader = tree.node("Emission")
        tree.link(tree.node("Wireframe", {}, {"Size": 0.12}), 0, shader.inputs["Color"])
        tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
        self.plane(tree.material).scale = (0.6, 1, 1)
        self.scene.render.resolution_x = self.scene.render.resolution_y = 64
        self.camera.location, self.camera.data.ortho_scale = (0, 0, 5), 1
        ours, theirs = (np.asarray(render(engine, 64)["Combined.R"]) for engine in ("COVTRACE", "CYCLES"))
        self.export()
        self.assertEqual(self.warnings, [])
        self.assertAlmostEqual(ours.mean() / theirs.mean(), 1, delta=0.02)
        self.assertLess(np.abs(ours - theirs).mean(), 0.02)

    def test_points_and_hollows(self):
        """A landscape of peaks and valleys whose sharp edges are split."""
        tree = Tree("pointiness")
        shader = tree.node("Emission")
        tree.link(tree.node("NewGeometry"), "Pointiness", shader.inputs["Color"])
        tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
        bpy.ops.mesh.primitive_grid_add(size=1, x_subdivisions=9, y_subdivisions=5, location=(1.5, 0.5, 0))
        thing = bpy.context.object
        thing.scale = (4, 2, 1)
        for vertex in thing.data.vertices:
            vertex.co.z = np.random.default_rng(vertex.index).random() * 0.3
        thing.data.materials.append(tree.material)
        split = thing.modifiers.new("split", "EDGE_SPLIT")
        split.split_angle = 0.3
        ours, theirs = self.cells(2)
        self.export()
        self.assertEqual(self.warnings, [])
        self.assertGreater(theirs.std(), 0.02)
        # A step of 8 bits; the same cells are up to 0.007 darker in Cycles 3.4 than in 4.5
        np.testing.assert_allclose(ours, theirs, atol=0.005 if bpy.app.version >= (4, 0) else 0.01)

    def test_instances_differ_at_random(self):
        thing = self.plane(self.shining("Random", "Random", "Random"))
        alone = bpy.data.collections.new("alone")
        alone.objects.link(thing)
        self.scene.collection.objects.unlink(thing)
        for number in range(4 * COLUMNS):
            empty = bpy.data.objects.new("empty", None)
            empty.instance_type, empty.instance_collection = "COLLECTION", alone
            empty.location = (number % COLUMNS, number // COLUMNS, 0)
            self.scene.collection.objects.link(empty)
        ours, theirs = self.cells(4)
        self.export()
        self.assertEqual(self.warnings, [])
        self.assertGreater(theirs.std(), 0.2)
        np.testing.assert_allclose(ours, theirs, atol=0.51 / owner.LEVELS_OF_INSTANCES)

    def test_the_place_of_instances_is_told(self):
        thing = self.plane(self.shining("Location"))
        thing.instance_type = "VERTS"
        bpy.ops.mesh.primitive_plane_add(size=1)
        bpy.context.object.parent = thing
        bpy.context.object.data.materials.append(thing.data.materials[0])
        self.export()
        self.assertTrue(any("the location of what has instances" in w for w in self.warnings), self.warnings)

    def test_places_that_nothing_asks_for_bake_nothing_anew(self):
        """Objects that differ in their places share the image of what hangs on their index alone."""
        m = self.shining("Object Index")
        tree = m.node_tree
        emission = next(node for node in tree.nodes if node.type == "EMISSION")
        checker, colour = tree.nodes.new("ShaderNodeTexChecker"), emission.inputs["Color"].links[0].from_socket
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], checker.inputs["Vector"])
        tree.links.new(colour, checker.inputs["Color1"])
        tree.links.new(checker.outputs["Color"], emission.inputs["Color"])
        for number in range(3):
            self.plane(m, number)
        files = []
        self.export(lambda folder: files.extend(folder.glob("texture*")))
        self.assertEqual(len(files), 1)
