"""Cameras and lenses against Cycles'."""

import bpy

from addon_support import PARTS, BlenderTest, HEIGHT, WIDTH, material, mean, render


class CameraTest(BlenderTest):
    def test_camera_sees_what_cycles_sees(self):
        self.plane(self.shining(), size=1.3)
        for values in (dict(), dict(shift_x=0.3, shift_y=0.1), dict(type="ORTHO", ortho_scale=4),
                       dict(sensor_fit="VERTICAL", lens=35)):
            for key, value in values.items():
                setattr(self.camera.data, key, value)
            ours, theirs = render("COVTRACE", 16), render("CYCLES", 16)
            for part in ((0, 0, 16, 12), (16, 0, 32, 12), (0, 12, 16, 24), (16, 12, 32, 24)):
                self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.02, msg=str(values))

    def test_lens_blurs_as_in_cycles(self):
        self.plane(self.shining(), size=0.5)
        dof = self.camera.data.dof
        dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 2.5, 0.05
        ours, theirs = render("COVTRACE", 256), render("CYCLES", 256)
        parts = [(0, 0, WIDTH, HEIGHT), (12, 8, 20, 16)]
        for part in parts:
            self.assertAlmostEqual(mean(ours, *part)[0] / mean(theirs, *part)[0], 1, delta=0.05)
        self.assertLess(mean(ours, *parts[1])[0], 0.8)  # it is blurred

    def test_camera_clips_as_in_cycles(self):
        """Objects nearer than Clip Start or beyond Clip End shadow, and are not seen."""
        self.plane(self.shining(), z=-2)
        matt, data = material(**self.MATT), self.camera.data
        near, far = self.plane(matt, size=1, z=4), self.plane(matt, size=1.5, z=0)
        far.location.x = 0.7
        self.lamp("SUN", energy=2.0, angle=0.1).rotation_euler = (0.3, 0.2, 0)
        for kind in ("PERSP", "ORTHO"):
            data.type, data.ortho_scale = kind, 4
            for data.clip_start, data.clip_end in ((0.1, 100), (1.5, 100), (0.1, 4.5)):
                ours, theirs = render("COVTRACE", 16), render("CYCLES", 16)
                for part in PARTS:
                    self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.02,
                                           msg=f"{kind} {data.clip_start} {data.clip_end}")
        data.type, data.clip_start, data.clip_end = "PERSP", 1.5, 100
        self.export()
        self.assertEqual(self.warnings, [])
        near.rotation_euler = (1.2, 0, 0)
        near.scale = (1, 4, 1)
        self.export()
        self.assertEqual(self.warnings, ["the camera's Clip Start cuts what is nearer; shown whole: 'Plane.001'"])

    def test_clip_end_hides_skies_around_the_camera_as_in_cycles(self):
        """A dome whose box is around the camera; it lights as before. What is cut is told."""
        data = self.camera.data
        of = data if hasattr(data, "panorama_type") else data.cycles
        of.panorama_type = "EQUIRECTANGULAR"
        self.background.inputs["Color"].default_value = (0.2, 0.2, 0.2, 1)
        bpy.ops.mesh.primitive_uv_sphere_add(radius=500)
        bpy.context.object.data.materials.append(self.shining())
        self.plane(material(**self.MATT), size=2)
        for data.type, data.clip_start, data.clip_end, has_sky in (
                ("PERSP", 0.1, 100, False), ("PERSP", 0.1, 1000, True), ("PANO", 0.1, 100, False), ("PANO", 0.1, 1000, True), ("PANO", 900, 1000, False)):
            ours, theirs = render("COVTRACE", 16), render("CYCLES", 16)
            for part in PARTS:
                self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.03, msg=f"{data.type} {data.clip_end}")
            self.assertEqual(mean(ours, 0, 0, 4, 4)[0] > 0.9, has_sky)
            self.export()
            self.assertEqual(self.warnings, [])
        data.type, data.clip_start, data.clip_end = "PERSP", 0.1, 100
        bpy.data.objects.remove(bpy.data.objects["Sphere"])
        self.camera.rotation_euler = (1.4, 0, 0)
        bpy.data.objects["Plane"].scale = (2000,) * 3
        self.export()
        self.assertEqual(self.warnings, ["the camera's Clip End cuts what is farther; shown whole: 'Plane'"])

    def test_panoramas_show_all_directions_as_in_cycles(self):
        data = self.camera.data
        of = data if hasattr(data, "panorama_type") else data.cycles
        data.type, of.panorama_type = "PANO", "EQUIRECTANGULAR"
        self.camera.location, self.camera.rotation_euler = (0, 0, 0), (1.2, 0.2, 0.5)
        for place, colour in (((2, 0, 0.3), (1, 0, 0)), ((-1, 2, 0), (0, 1, 0)), ((0, -2, 1), (0, 0, 1)), ((0.3, 0.2, 2), (1, 1, 0))):
            m = material(Emission=(*colour, 1), Emission_Strength=1.0, Base_Color=(0, 0, 0, 1), Specular=0.0)
            bpy.ops.mesh.primitive_ico_sphere_add(radius=0.8, location=place)
            bpy.context.object.data.materials.append(m)
        ours, theirs = render("COVTRACE", 16), render("CYCLES", 16)
        for x0, y0 in ((x, y) for x in range(0, WIDTH, 8) for y in range(0, HEIGHT, 8)):
            part = (x0, y0, x0 + 8, y0 + 8)
            for a, b in zip(mean(ours, *part), mean(theirs, *part)):
                self.assertAlmostEqual(a, b, delta=0.03, msg=str(part))

    def test_fisheyes_and_parts_of_panoramas_are_as_in_cycles(self):
        data = self.camera.data
        of = data if hasattr(data, "panorama_type") else data.cycles
        data.type, data.sensor_width = "PANO", 30
        self.camera.location, self.camera.rotation_euler = (0, 0, 0), (1.2, 0.2, 0.5)
        for place, colour in (((0, 2, 0.3), (1, 0, 0)), ((-1, 2, 1), (0, 1, 0)), ((1.5, 1.5, 0), (0, 0, 1)), ((0.3, 0.2, 2), (1, 1, 0))):
            m = material(Emission=(*colour, 1), Emission_Strength=1.0, Base_Color=(0, 0, 0, 1), Specular=0.0)
            bpy.ops.mesh.primitive_ico_sphere_add(radius=0.7, location=place)
            bpy.context.object.data.materials.append(m)
        self.background.inputs["Color"].default_value = (0.3, 0.3, 0.3, 1)
        for kind, settings in (("FISHEYE_EQUIDISTANT", {"fisheye_fov": 3.0}), ("FISHEYE_EQUISOLID", {"fisheye_fov": 3.3, "fisheye_lens": 9}),
                               ("FISHEYE_EQUISOLID", {"fisheye_fov": 2.5, "fisheye_lens": 15, "pixel_aspect_x": 2}),
                               ("EQUIRECTANGULAR", {"longitude_min": -1, "longitude_max": 0.5, "latitude_min": -0.3, "latitude_max": 1.2}),
                               ("EQUIRECTANGULAR", {"longitude_min": 1, "longitude_max": 5}), ("EQUIRECTANGULAR", {"longitude_min": -4, "longitude_max": 0})):
            of.panorama_type = kind
            for name, value in settings.items():
                setattr(self.scene.render if name.startswith("pixel") else of, name, value)
            data.update_tag()
            ours, theirs = render("COVTRACE", 16), render("CYCLES", 16)
            for x0, y0 in ((x, y) for x in range(0, WIDTH, 8) for y in range(0, HEIGHT, 8)):
                part = (x0, y0, x0 + 8, y0 + 8)
                for a, b in zip(mean(ours, *part), mean(theirs, *part)):
                    self.assertAlmostEqual(a, b, delta=0.03, msg=f"{kind} {part}")
        of.longitude_max = 4
        if of.longitude_max == 4:  # Blender 3.4 allows half a turn to either side
            with self.assertRaisesRegex(RuntimeError, "around more than once"):
                self.export()
        of.longitude_max = 0
        data.dof.use_dof = True
        self.export()
        self.assertEqual(self.warnings, ["the camera's depth of field is left out, as it is a panorama"])
        data.dof.use_dof, data.shift_x, of.panorama_type, of.fisheye_fov = False, 0.1, "FISHEYE_EQUIDISTANT", 7
        self.export()
        self.assertEqual(self.warnings, ["the camera's shift is left out, as it is a panorama",
                                         "the camera's fisheye goes around more than once and ends at 360 degrees"])
        of.panorama_type = "MIRRORBALL"
        data.update_tag()
        with self.assertRaisesRegex(RuntimeError, "MIRRORBALL are not supported"):
            self.export()

    def test_apertures_have_their_blades_as_in_cycles(self):
        """A lamp out of focus is nearly a picture of the aperture."""
        dof = self.camera.data.dof
        self.camera.location, self.camera.rotation_euler = (0, 0, 10), (0, 0, 0)
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        m = material(Emission=(1, 1, 1, 1), Emission_Strength=10.0, Base_Color=(0, 0, 0, 1), Specular=0.0)
        bpy.ops.mesh.primitive_ico_sphere_add(radius=0.4, subdivisions=4, location=(0, 0, 0))
        bpy.context.object.data.materials.append(m)
        dof.use_dof, dof.focus_distance = True, 5
        dof.aperture_fstop = self.camera.data.lens * 1e-3 / (2 * 0.9)
        for dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio in ((0, 0, 2), (3, 0, 1), (3, 0.5, 1), (5, 0.2, 0.7)):
            ours, theirs = render("COVTRACE", 256), render("CYCLES", 256)
            for x0, y0 in ((x, y) for x in range(0, WIDTH, 4) for y in range(0, HEIGHT, 4)):
                part = (x0, y0, x0 + 4, y0 + 4)
                self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.07, msg=f"{dof.aperture_blades} {part}")
        self.export()
        self.assertEqual(self.warnings, [])
