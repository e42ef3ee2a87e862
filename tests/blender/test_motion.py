"""Motion blur of objects and of meshes that change their shape, against Cycles."""

import math

import bpy
from addon_support import HEIGHT, BlenderTest, curves_of, material, mean, render


class MotionTest(BlenderTest):
    def test_motion_blurs_along_the_way(self):
        plane = self.plane(self.shining(), size=0.5)
        for frame, x in ((0, -1), (2, 1)):
            plane.location.x = x
            plane.keyframe_insert("location", frame=frame)
        for curve in curves_of(plane):
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"
        self.scene.frame_set(1)
        still = mean(render("COVTRACE", 64))[0]
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 1.0
        blurred = render("COVTRACE", 64)
        self.assertAlmostEqual(mean(blurred)[0] / still, 1, delta=0.05)  # the same light,
        middle = mean(blurred, 14, 10, 18, 14)[0]
        self.assertAlmostEqual(middle, 0.5, delta=0.06)  # over twice the way
        self.assertEqual(self.scene.frame_current, 1)

    def test_the_shutter_opens_as_in_cycles_and_not_for_all(self):
        """Where an object stands tells when it was seen; one that is not blurred is seen in the middle of that time."""
        self.scene.cycles.film_exposure = 1.5
        for y, is_blurred in ((-0.6, True), (0.6, False)):
            plane = self.plane(self.shining(), size=0.6)
            for frame, x in ((0, -1.5), (2, 1.5)):
                plane.location = (x, y, 0)
                plane.keyframe_insert("location", frame=frame)
            for curve in curves_of(plane):
                for key in curve.keyframe_points:
                    key.interpolation = "LINEAR"
            plane.cycles.use_motion_blur = is_blurred
        self.scene.frame_set(1)
        render_settings = self.scene.render
        render_settings.use_motion_blur, render_settings.motion_blur_shutter = True, 0.6
        of = render_settings if hasattr(render_settings, "motion_blur_position") else self.scene.cycles
        for of.motion_blur_position in ("START", "CENTER", "END"):
            ours, theirs = render("COVTRACE", 16), render("CYCLES", 32)
            for x in range(8, 24, 4):
                for y in (0, HEIGHT // 2):
                    part = (x, y, x + 4, y + HEIGHT // 2)
                    self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.05, msg=f"{of.motion_blur_position} {part}")

    def test_cameras_and_shapes_whose_motion_blur_is_off_are_sharp_as_in_cycles(self):
        plane = self.plane(self.shining(), size=1.5)
        self.deform(plane, range(4))
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 1.0
        for frame, y in ((0, -1), (2, 1)):
            self.camera.location.y = y
            self.camera.keyframe_insert("location", frame=frame)
        self.scene.frame_set(1)
        for camera_is_blurred, is_blurred, has_blurred_shape in ((False, True, True), (True, False, True), (True, True, False)):
            self.camera.cycles.use_motion_blur = camera_is_blurred
            plane.cycles.use_motion_blur, plane.cycles.use_deform_motion = is_blurred, has_blurred_shape
            ours, theirs = render("COVTRACE", 16), render("CYCLES", 32)
            for x, y in ((x, y) for x in range(0, 32, 8) for y in range(0, HEIGHT, 8)):
                part = (x, y, x + 8, y + 8)
                self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.05,
                                       msg=f"{camera_is_blurred} {is_blurred} {has_blurred_shape} {part}")

    def deform(self, mesh_object, moved, distance=(2, 0, 0)):
        """Adds a shape key that moves these vertices, from no part at frame 0 to the whole way at frame 2; the
        shutter is open over both."""
        mesh_object.shape_key_add(name="Basis")
        key = mesh_object.shape_key_add(name="moved")
        for i in moved:
            key.data[i].co = [a + b for a, b in zip(key.data[i].co, distance)]
        for frame, value in ((0, 0.0), (2, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)
        for curve in curves_of(mesh_object.data.shape_keys):
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
        self.scene.frame_set(1)
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 2.0

    def test_meshes_that_move_by_their_vertices_are_blurred(self):
        plane = self.plane(self.shining(), size=0.5)
        self.deform(plane, range(4))
        ours, theirs = render("COVTRACE", 256), render("CYCLES", 256)
        for part in ((14, 10, 18, 14), (18, 10, 22, 14), (22, 10, 26, 14)):
            self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.05)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_connected_pieces_move_alone(self):
        bpy.ops.mesh.primitive_plane_add(size=0.5, location=(0, 1, 0))
        still = bpy.context.object
        plane = self.plane(self.shining(), size=0.5)
        still.data.materials.append(plane.data.materials[0])
        still.select_set(True)
        bpy.ops.object.join()
        self.deform(plane, range(4))
        ours, theirs = render("COVTRACE", 256), render("CYCLES", 256)
        for part in ((14, 0, 18, 10), (18, 10, 22, 14), (18, 0, 22, 10)):
            self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.05)

    def test_what_one_triangle_cannot_follow_is_told(self):
        plane = self.plane(self.shining(), size=0.5)
        self.deform(plane, [0], (0.5, 0.5, 0))  # both triangles end as lines
        self.export()
        self.assertTrue(any("bends more while the shutter is open" in w for w in self.warnings), self.warnings)

    def test_arms_bend_as_in_cycles(self):
        """Bends an arm of two bones along x, whose second one turns by 40 degrees while the shutter is open."""
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=4, size=1)
        arm = bpy.context.object
        for vertex in arm.data.vertices:
            vertex.co = (vertex.co.x * 3, vertex.co.y * 0.5, 0)
        arm.data.materials.append(self.shining())
        self.bend(arm, math.radians(20), 0.6)
        self.scene.frame_set(1)
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 2.0
        # Cycles' own to Blender 4.5, the scene's since.
        settings = self.scene.cycles if hasattr(self.scene.cycles, "motion_blur_position") else self.scene.render
        settings.motion_blur_position = "CENTER"
        arm.cycles.motion_steps = 5  # Cycles' own are straight between its steps
        ours, theirs = render("COVTRACE", 256), render("CYCLES", 256)
        for x in range(0, 32, 4):
            for y in range(0, 24, 4):
                self.assertAlmostEqual(mean(ours, x, y, x + 4, y + 4)[0], mean(theirs, x, y, x + 4, y + 4)[0], delta=0.04)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_lamps_shine_from_all_of_their_way(self):
        self.plane(material(**self.MATT))
        for kind, values in (("POINT", {"shadow_soft_size": 0}), ("POINT", {"shadow_soft_size": 0.3}), ("AREA", {"size": 0.5})):
            with self.subTest(kind, **values):
                lamp = self.lamp(kind, energy=100, location=(0, 0, 1), **values)
                self.scene.render.use_motion_blur = False
                steps = []
                for k in range(8):  # the middles of eight parts of the way
                    lamp.location.x = (k + 0.5) / 2 - 2
                    steps.append(render("COVTRACE", 64))
                for frame, x in ((0, -2), (2, 2)):
                    lamp.location.x = x
                    lamp.keyframe_insert("location", frame=frame)
                for curve in curves_of(lamp):
                    for key in curve.keyframe_points:
                        key.interpolation = "LINEAR"
                self.scene.frame_set(1)
                self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 2.0
                blurred = render("COVTRACE", 256)
                for x in range(0, 32, 8):
                    part = (x, 8, x + 8, 16)
                    self.assertAlmostEqual(mean(blurred, *part)[0] / (sum(mean(s, *part)[0] for s in steps) / 8), 1, delta=0.05)
                self.export()
                self.assertEqual(self.warnings, [])
                bpy.data.objects.remove(lamp)

    def test_lamps_that_stand_still_are_told(self):
        self.plane(material(**self.MATT))
        lamp = self.lamp("SPOT", energy=100)
        for frame, x in ((0, -2), (2, 2)):
            lamp.location.x = x
            lamp.keyframe_insert("location", frame=frame)
        self.scene.frame_set(1)
        self.scene.render.use_motion_blur = True
        self.export()
        self.assertTrue(any("is a spot and moves" in w for w in self.warnings), self.warnings)
