"""Heights that turn normals, by the nodes Bump and Displacement, against Cycles."""

import bpy
from node_tiles import NodeTilesTest
from node_trees import Tree


class HeightsTest(NodeTilesTest):
    def test_heights_turn_normals(self):
        """Lit from the side, waves of heights have a bright and a dark side."""
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        bpy.ops.object.light_add(type="SUN", rotation=(0.3, 0.8, 0))
        bpy.context.object.data.energy = 2

        def build(strength, distance, invert=False):
            def show(tree):
                turned = tree.node("Math", {"operation": "MULTIPLY"}, {0: tree.number(), 1: 6.2})
                waves = tree.node("Math", {"operation": "SINE"}, {0: turned})
                height = tree.node("Math", {"operation": "MULTIPLY"}, {0: waves, 1: tree.number(1)})
                bump = tree.node("Bump", {"invert": invert}, {"Strength": strength, "Distance": distance, "Height": height})
                tree.link(bump, 0, tree.shader.inputs["Normal"])
            return show

        # Cycles darkens what bumps turn towards the light, by up to 4 % here (its term against hard terminators).
        self.assert_nodes({"bump": build(1.0, 0.08), "inverted": build(1.0, 0.06, True), "half": build(0.5, 0.12)},
                          most_of_structure=0.6)

    def test_strength_bounds_how_far_heights_turn_normals(self):
        """Heights so steep that their normals lie nearly along the surface: a Strength mixes these with its own."""
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        bpy.ops.object.light_add(type="SUN", rotation=(0, 0.5, 0))
        bpy.context.object.data.energy = 3

        def waves(strength):
            def show(tree):
                turned = tree.node("Math", {"operation": "MULTIPLY"}, {0: tree.number(), 1: 3.1})
                height = tree.node("Math", {"operation": "SINE"}, {0: turned})
                bump = tree.node("Bump", {}, {"Strength": strength, "Distance": 20.0, "Height": height})
                tree.link(bump, 0, tree.shader.inputs["Normal"])
            return show

        self.assert_nodes({"weak": waves(0.2), "half": waves(0.4)}, most_of_structure=0.3)

    def test_bumps_turn_the_normals_of_others(self):
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        bpy.ops.object.light_add(type="SUN", rotation=(0.3, 0.6, 0))
        bpy.context.object.data.energy = 2

        def both(strengths):
            def show(tree):
                last = None
                for axis, strength in enumerate(strengths):
                    turned = tree.node("Math", {"operation": "MULTIPLY"}, {0: tree.number(axis), 1: 4.7})
                    height = tree.node("Math", {"operation": "SINE"}, {0: turned})
                    last = tree.node("Bump", {"invert": axis == 1}, {"Strength": strength, "Distance": 0.08, "Height": height,
                                                                     **({"Normal": last} if last else {})})
                tree.link(last, 0, tree.shader.inputs["Normal"])
            return show

        self.assert_nodes({"whole": both((1.0, 1.0)), "parts": both((0.5, 1.0)), "weak": both((0.4, 0.4)), "second": both((0.0, 1.0))},
                          most_of_structure=0.6)

    def test_displacement_turns_normals(self):
        """By the object's scale, where the node's space is that of the object."""
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        bpy.ops.object.light_add(type="SUN", rotation=(0.3, 0.8, 0))
        bpy.context.object.data.energy = 2

        def waves(method, space, scale):
            def show(tree):
                turned = tree.node("Math", {"operation": "MULTIPLY"}, {0: tree.number(), 1: 6.2})
                height = tree.node("Math", {"operation": "SINE"}, {0: turned})
                tree.link(tree.node("Displacement", {"space": space}, {"Height": height, "Scale": scale}), 0,
                          tree.tree.nodes["Material Output"].inputs["Displacement"])
                of = tree.material if hasattr(tree.material, "displacement_method") else tree.material.cycles
                of.displacement_method = method
            return show

        def change(plane):
            plane.scale = (0.5,) * 3
            for vertex in plane.data.vertices:
                vertex.co *= 2

        self.assert_nodes({"of object": waves("BUMP", "OBJECT", 0.1), "of world": waves("BUMP", "WORLD", 0.05)}, change,
                          mean_tolerance=0.05, most_of_structure=0.6)

    def test_objects_share_the_heights_of_displacement(self):
        """In one file for all scales, and one material for what is only turned."""
        tree = Tree("heights")
        height = tree.node("Math", {"operation": "SINE"}, {0: tree.number()})
        tree.link(tree.node("Displacement", {}, {"Height": height, "Scale": 1.0}), 0, tree.tree.nodes["Material Output"].inputs["Displacement"])
        for number, (turn, scale) in enumerate(((0, 1), (0.4, 1), (1.3, 1), (0, 2), (0, 3))):
            plane = self.tile(number, tree.material)
            plane.rotation_euler, plane.scale = (turn, 2 * turn, 3 * turn), (scale,) * 3
        files = []
        text = self.export(lambda folder: files.extend(folder.glob("*.pfm")))
        self.assertEqual((len(files), text.count('"float scale" 2'), text.count("texture displacement")), (1, 1, 3))

    def test_heights_follow_uv_maps(self):
        """Smooth meshes are among them, where pbrt takes v to be as long as u and left of it."""
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        bpy.ops.object.light_add(type="SUN", rotation=(0.3, 0.8, 0))
        bpy.context.object.data.energy = 2

        def waves(axis):
            def show(tree):
                turned = tree.node("Math", {"operation": "MULTIPLY"}, {0: tree.number(axis), 1: 6.2})
                heights = tree.node("Math", {"operation": "SINE"}, {0: turned})
                tree.link(tree.node("Bump", {}, {"Distance": 0.05, "Height": heights}), 0, tree.shader.inputs["Normal"])
            return show

        def change(plane):
            plane.data.polygons[0].use_smooth = True
            for loop in plane.data.uv_layers[0].data:
                loop.uv = (loop.uv[1], 2 * loop.uv[0])  # mirrored and stretched

        self.assert_nodes({"along u": waves(0), "along v": waves(1)}, change, mean_tolerance=0.05, most_of_structure=0.6)

    def test_heights_from_above(self):
        """Lit along the normal, where Cycles' term against hard terminators is 1. Slopes stay below 1, where it bends normals."""
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        bpy.ops.object.light_add(type="SUN")
        bpy.context.object.data.energy = 3

        def waves(distance):
            def show(tree):
                turned = tree.node("Math", {"operation": "MULTIPLY"}, {0: tree.number(), 1: 3.1})
                height = tree.node("Math", {"operation": "SINE"}, {0: turned})
                tree.link(tree.node("Bump", {}, {"Distance": distance, "Height": height}), 0, tree.shader.inputs["Normal"])
            return show

        self.assert_nodes({"low": waves(0.2), "high": waves(0.3)}, most_of_structure=0.1)
