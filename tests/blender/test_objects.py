"""Objects, modifiers, instances and strands of the add-on, against Cycles."""

import math

import bpy
from addon_support import BlenderTest, geometry_tree, mean, render


class ObjectsTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)

    def assert_silhouettes_as_cycles(self, delta=0.03, samples=64):
        """Asserts silhouettes of black things before white: the quarters of the picture agree, and none of it is
        empty or full."""
        ours, theirs = render("COVTRACE", samples), render("CYCLES", samples)
        self.assertGreater(mean(theirs)[0], 0.1)
        self.assertLess(mean(theirs)[0], 0.98)
        for y0, y1 in ((0, 12), (12, 24)):
            for x0, x1 in ((0, 16), (16, 32)):
                self.assertAlmostEqual(mean(ours, x0, y0, x1, y1)[0], mean(theirs, x0, y0, x1, y1)[0], delta=delta)

    def black(self):
        m = bpy.data.materials.new("black")
        m.use_nodes = True
        m.node_tree.nodes.remove(m.node_tree.nodes["Principled BSDF"])
        node = m.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
        node.inputs["Color"].default_value = (0, 0, 0, 1)
        m.node_tree.links.new(node.outputs["BSDF"], m.node_tree.nodes["Material Output"].inputs["Surface"])
        return m

    def cube(self, size=0.4, location=(0, 0, 0)):
        bpy.ops.mesh.primitive_cube_add(size=size, location=location)
        bpy.context.object.data.materials.append(self.black())
        return bpy.context.object

    def test_instances_share_one_object(self):
        child = self.plane(self.black(), size=0.3)
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=3)
        parent = bpy.context.object
        child.parent, parent.instance_type = parent, "VERTS"
        parent.show_instancer_for_render = False
        text = self.export()
        self.assertEqual(text.count("ObjectBegin"), 1)
        self.assertEqual(text.count("ObjectInstance"), 25)
        self.assert_silhouettes_as_cycles()

    def test_collections_are_instanced(self):
        cube = self.cube(0.6)
        collection = bpy.data.collections.new("things")
        collection.objects.link(cube)
        self.scene.collection.objects.unlink(cube)
        for x, turn in ((-1, 0.5), (1, 0)):
            empty = bpy.data.objects.new("empty", None)
            empty.instance_type, empty.instance_collection = "COLLECTION", collection
            empty.location, empty.rotation_euler, empty.scale = (x, 0.4, 0), (0, 0, turn), (1, 1.5, 1)
            self.scene.collection.objects.link(empty)
        self.assertEqual(self.export().count("ObjectInstance"), 2)
        self.assert_silhouettes_as_cycles()

    def test_what_is_scaled_flat_is_there(self):
        """A matrix without an inverse, as of a floor that is scaled by 0 along its normal; two zeros leave a line."""
        for location, scale in (((-1, 0.5, 0), (1, 0.6, 0)), ((1, 0.5, 0), (0.9, 0.6, 0)), ((0, -0.8, 0), (1, 0, 0)), ((0, 1, 0), (0, 0, 0))):
            bpy.ops.mesh.primitive_uv_sphere_add(radius=0.7, location=location, scale=scale, rotation=(0.4, 0.3, 0.2))
            bpy.context.object.scale = scale  # the operator itself takes no zero
            bpy.context.object.data.materials.append(self.black())
        bpy.context.view_layer.update()
        self.assertEqual(self.export().count('Shape "plymesh"'), 2)
        self.assert_silhouettes_as_cycles()

    def test_what_is_scaled_flat_has_places_in_the_world(self):
        """Displacement along the world's normal, and colours by the place, take the matrix' inverse."""
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.7)
        bpy.context.object.scale = (1, 1, 0)
        m = self.black()
        bpy.context.object.data.materials.append(m)
        tree = m.node_tree
        place, displacement = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeDisplacement")
        tree.links.new(place.outputs["Position"], tree.nodes["Diffuse BSDF"].inputs["Color"])
        displacement.space, displacement.inputs["Height"].default_value = "WORLD", 0.7
        tree.links.new(displacement.outputs["Displacement"], tree.nodes["Material Output"].inputs["Displacement"])
        (m if hasattr(m, "displacement_method") else m.cycles).displacement_method = "DISPLACEMENT"
        bpy.context.view_layer.update()
        text = self.export()
        self.assertEqual(text.count('Shape "plymesh"'), 1)
        self.assertIn('"imagemap"', text)
        self.assertEqual(self.warnings, [])

    def test_what_stands_nowhere_is_left_out(self):
        for number, values in enumerate(({}, {"location": (math.nan, 0, 0)}, {"scale": (1, math.nan, 1)})):
            cube = self.cube()
            cube.name = f"cube {number}"
            for name, value in values.items():
                setattr(cube, name, value)
        bpy.ops.object.light_add(type="AREA")
        bpy.context.object.name, bpy.context.object.scale = "lamp", (math.nan, 1, 1)
        bpy.context.view_layer.update()
        text = self.export()
        self.assertEqual((text.count('Shape "plymesh"'), text.count("AreaLightSource")), (1, 0))
        self.assertEqual(self.warnings, [f"object '{name}' has a place or a size that is not finite and is left out"
                                         for name in ("cube 1", "cube 2", "lamp")])

    def test_geometry_nodes_and_modifiers_are_evaluated(self):
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3, size=2.4)
        grid = bpy.context.object
        group = geometry_tree("scatter")
        nodes = group.nodes
        begin, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
        scatter, cone = nodes.new("GeometryNodeInstanceOnPoints"), nodes.new("GeometryNodeMeshCone")
        coat = nodes.new("GeometryNodeSetMaterial")
        cone.inputs["Radius Bottom"].default_value, cone.inputs["Depth"].default_value = 0.3, 0.6
        coat.inputs["Material"].default_value = self.black()
        group.links.new(begin.outputs[0], scatter.inputs["Points"])
        group.links.new(cone.outputs["Mesh"], coat.inputs["Geometry"])
        group.links.new(coat.outputs["Geometry"], scatter.inputs["Instance"])
        group.links.new(scatter.outputs["Instances"], end.inputs[0])
        grid.modifiers.new("scatter", "NODES").node_group = group
        cube = self.cube(0.5, (1.3, -0.7, 0.5))
        cube.modifiers.new("smooth", "SUBSURF").render_levels = 3
        array = cube.modifiers.new("row", "ARRAY")
        array.count, array.relative_offset_displace = 3, (-1.2, 0.2, 0)
        self.assertEqual(self.export().count("ObjectInstance"), 16)
        self.assert_silhouettes_as_cycles()

    def test_smooth_sides_of_flat_caps_are_as_in_cycles(self):
        """Sides of a cylinder below a lamp: whether caps have a part in their normals tells whether these are lit."""
        self.background.inputs["Color"].default_value = (0.2, 0.2, 0.2, 1)
        self.lamp("SUN", energy=3).rotation_euler = (0.6, 0, 0)
        self.camera.location, self.camera.rotation_euler, self.camera.data.lens = (0, -5, 0), (math.pi / 2, 0, 0), 130
        m = self.black()
        m.node_tree.nodes["Diffuse BSDF"].inputs["Color"].default_value = (0.8, 0.8, 0.8, 1)
        for are_edges_sharp in (False, True):
            bpy.ops.mesh.primitive_cylinder_add(radius=0.5, depth=1, vertices=24)
            cylinder = bpy.context.object
            cylinder.data.materials.append(m)
            for polygon in cylinder.data.polygons:
                polygon.use_smooth = len(polygon.vertices) == 4
            sharp = [e for e in cylinder.data.edges if cylinder.data.vertices[e.vertices[0]].co.z == cylinder.data.vertices[e.vertices[1]].co.z]
            for edge in sharp:
                edge.use_edge_sharp = are_edges_sharp
            with self.subTest(are_edges_sharp=are_edges_sharp):
                self.assert_as_cycles(0.02)
            bpy.data.objects.remove(cylinder)

    def test_curves_and_text_are_meshes(self):
        bpy.ops.curve.primitive_bezier_circle_add(radius=1)
        bpy.context.object.data.bevel_depth = 0.15
        bpy.context.object.data.materials.append(self.black())
        bpy.ops.object.text_add(location=(-0.6, -0.3, 0))
        bpy.context.object.data.body, bpy.context.object.data.extrude = "Co", 0.1
        bpy.context.object.data.materials.append(self.black())
        self.assert_silhouettes_as_cycles()

    # -- strands

    def hairy(self):
        """A tilted sheet with thick hair of its second material, and with children."""
        sheet = self.plane(self.black(), size=1.5)
        sheet.data.materials.append(self.black())
        sheet.rotation_euler = (0, math.pi / 2.5, 0)
        sheet.modifiers.new("hair", "PARTICLE_SYSTEM")
        settings = sheet.particle_systems[0].settings
        settings.type, settings.count, settings.hair_length, settings.material = "HAIR", 30, 1.2, 2
        settings.root_radius, settings.tip_radius, settings.radius_scale = 1.0, 0.3, 0.08
        settings.brownian_factor = 0.2
        return sheet, settings

    def test_hair_is_as_wide_as_in_cycles(self):
        sheet, settings = self.hairy()
        self.assert_silhouettes_as_cycles()
        settings.child_type, settings.rendered_child_count, settings.shape = "SIMPLE", 4, 0.4
        settings.use_close_tip = False
        self.assert_silhouettes_as_cycles()
        sheet.show_instancer_for_render = False
        self.assert_silhouettes_as_cycles()

    def test_hair_is_as_bright_as_in_cycles(self):
        matt = self.black()
        matt.node_tree.nodes["Diffuse BSDF"].inputs["Color"].default_value = (0.9, 0.9, 0.9, 1)
        sheet = self.plane(matt, size=3)
        sheet.modifiers.new("hair", "PARTICLE_SYSTEM")
        settings = sheet.particle_systems[0].settings
        settings.type = "HAIR"
        settings.root_radius, settings.tip_radius = 1.0, 1.0
        sheet.show_instancer_for_render = False
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        cycles, depth = self.scene.cycles, self.scene.covtrace.max_depth
        cycles.max_bounces = cycles.diffuse_bounces = depth
        self.scene.cycles_curves.shape = "THICK"  # round, not ribbons that turn to the ray
        settings.use_close_tip = False
        # Strands thinner than a pixel have flat sides, those of four and more smooth ones. These are seen from their side, as their
        # ends are open here and round in Cycles.
        for count, length, radius, wander, is_smooth in ((3000, 0.4, 0.01, 0.2, False), (60, 4.0, 0.2, 0.0, True)):
            with self.subTest(radius=radius):
                settings.count, settings.hair_length, settings.radius_scale, settings.brownian_factor = count, length, radius, wander
                if is_smooth:
                    sheet.location.x, sheet.rotation_euler.y = -2, math.pi / 2
                ours, theirs = (mean(render(engine, 128), 8, 6, 24, 18)[0] for engine in ("COVTRACE", "CYCLES"))
                self.assertAlmostEqual(ours / theirs, 1, delta=0.01)
                self.export(lambda folder: self.assertEqual(any(b"float nx" in file.read_bytes() for file in folder.glob("*.ply")), is_smooth))

    def test_hair_curves_are_strands(self):
        sheet, _ = self.hairy()
        bpy.context.view_layer.objects.active = sheet
        bpy.ops.curves.convert_from_particle_system()
        curves = next(o for o in self.scene.objects if o.type == "CURVES")
        curves.data.materials.append(self.black())
        bpy.data.objects.remove(sheet)
        self.assert_silhouettes_as_cycles(samples=256)  # of Cycles' own width
        radii = curves.data.attributes.new("radius", "FLOAT", "POINT").data
        for i, radius in enumerate(radii):
            radius.value = 0.02 + 0.03 * (i % 5) / 4
        self.assert_silhouettes_as_cycles()

    def test_what_is_not_rendered_is_told(self):
        pencils = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils)  # the former in Blender 4.3 to 4.5
        self.scene.collection.objects.link(bpy.data.objects.new("strokes", pencils.new("strokes")))
        self.export()
        self.assertEqual(self.warnings, ["object 'strokes' is grease pencil, which is not rendered"])
