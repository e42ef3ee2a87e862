"""The add-on inside Blender: what it renders against Cycles and against closed forms; layers, motion, lens, cancelling."""

import math
import os
import pathlib
import sys
import tempfile
import time
import unittest

import bpy

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(SOURCE / "blender"), str(SOURCE / "tests" / "cli")]

import covtrace_blender
import exr
from covtrace_blender import engine, export_scene

WIDTH, HEIGHT = 32, 24


def render(engine_name, samples):
    """The render as channels by name, without the view layer's."""
    scene = bpy.context.scene
    scene.render.engine = engine_name
    scene.covtrace.samples = samples
    if engine_name == "CYCLES":
        scene.cycles.samples = samples
        scene.cycles.use_denoising = False
        scene.cycles.use_adaptive_sampling = False
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    settings.exr_codec = "ZIP"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "image.exr")
        bpy.ops.render.render(write_still=True)
        image = exr.read(scene.render.filepath)
    return {name.split(".", 1)[1]: values for name, values in image.pixels.items()}


def mean(image, x0=0, y0=0, x1=WIDTH, y1=HEIGHT):
    """Mean colour of a part of the picture."""
    return [sum(image[f"Combined.{c}"][y * WIDTH + x] for y in range(y0, y1) for x in range(x0, x1)) /
            ((x1 - x0) * (y1 - y0)) for c in "RGB"]


def material(name="material", **inputs):
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    for key, value in inputs.items():
        m.node_tree.nodes["Principled BSDF"].inputs[key.replace("_", " ")].default_value = value
    return m


class AddonTest(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        if not hasattr(bpy.types.Scene, "covtrace"):
            covtrace_blender.register()
        scene = self.scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
        scene.world = bpy.data.worlds.new("world")
        scene.world.use_nodes = True
        self.background = scene.world.node_tree.nodes["Background"]
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        bpy.ops.object.camera_add(location=(0, 0, 5))
        self.camera = scene.camera = bpy.context.object

    def plane(self, m, size=20, z=0):
        bpy.ops.mesh.primitive_plane_add(size=size, location=(0, 0, z))
        bpy.context.object.data.materials.append(m)
        return bpy.context.object

    def lamp(self, kind, **values):
        bpy.ops.object.light_add(type=kind, location=values.pop("location", (0, 0, 3)))
        for key, value in values.items():
            setattr(bpy.context.object.data, key, value)
        return bpy.context.object

    def assert_as_cycles(self, tolerance, samples=64):
        """The whole pictures' means agree, per channel."""
        ours, theirs = mean(render("COVTRACE", samples)), mean(render("CYCLES", samples))
        for channel, (a, b) in enumerate(zip(ours, theirs)):
            self.assertGreater(b, 1e-3)
            self.assertAlmostEqual(a / b, 1, delta=tolerance, msg=f"channel {channel}: {ours} against {theirs}")

    # -- units of lamps: a matt plane under each, in closed form

    MATT = dict(Base_Color=(0.5, 0.5, 0.5, 1), Specular=0.0, Roughness=1.0)

    def centre(self):
        return mean(render("COVTRACE", 64), WIDTH // 2 - 2, HEIGHT // 2 - 2, WIDTH // 2 + 2, HEIGHT // 2 + 2)[0]

    def test_point_lamp_of_watts(self):
        self.plane(material(**self.MATT))
        self.lamp("POINT", energy=400, shadow_soft_size=0)
        # W / (4 pi d^2) times reflectance / pi; 3 % for the fall-off over the pixels.
        expected = 400 / (4 * math.pi * 9) * 0.5 / math.pi
        self.assertAlmostEqual(self.centre() / expected, 1, delta=0.03)

    def test_sun_of_watts_per_square_metre(self):
        self.plane(material(**self.MATT))
        self.lamp("SUN", energy=3, angle=0)
        self.assertAlmostEqual(self.centre() / (3 * 0.5 / math.pi), 1, delta=0.01)

    def test_lamps_as_cycles_has_them(self):
        self.plane(material(**self.MATT))
        self.lamp("POINT", energy=100, shadow_soft_size=0.5, location=(-2, 0, 2), color=(1, 0.5, 0.2))
        self.lamp("SPOT", energy=300, spot_size=1.0, spot_blend=0.5, shadow_soft_size=0, location=(2, 0, 3))
        area = self.lamp("AREA", energy=50, shape="RECTANGLE", size=1, size_y=2, location=(0, 1, 2))
        area.rotation_euler = (0.5, 0, 0)
        self.assert_as_cycles(0.03)

    def test_world_and_materials_as_cycles_has_them(self):
        self.background.inputs["Color"].default_value = (0.8, 0.9, 1, 1)
        self.plane(material("floor", Base_Color=(0.3, 0.6, 0.2, 1), Roughness=0.6))
        kinds = [dict(Base_Color=(0.8, 0.2, 0.1, 1), Roughness=0.3), dict(Base_Color=(1, 0.7, 0.3, 1), Metallic=1.0),
                 dict(Base_Color=(0.2, 0.3, 0.8, 1), Metallic=0.5, Roughness=0.4),
                 dict(Emission=(0.5, 1, 0.2, 1), Emission_Strength=1.5)]
        for i, kind in enumerate(kinds):
            bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(-1.5 + i, 0, 0.5))
            bpy.ops.object.shade_smooth()
            bpy.context.object.data.materials.append(material(f"m{i}", **kind))
        # Blender 3.4's Principled sends back more light than falls on it, as the decision 0051 has measured.
        self.assert_as_cycles(0.05)

    def test_shaders_that_keep_energy_are_as_bright_as_in_cycles(self):
        """In a white surrounding, where nothing but the surface's own share counts; from above, and from the side."""
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.camera.data.lens = 200

        def shader(kind, **inputs):
            m = bpy.data.materials.new(kind)
            m.use_nodes = True
            node = m.node_tree.nodes.new(kind)
            for key, value in inputs.items():
                node.inputs[key].default_value = value
            m.node_tree.links.new(node.outputs["BSDF"], m.node_tree.nodes["Material Output"].inputs["Surface"])
            return m

        grey, white = (0.5, 0.6, 0.7, 1), (1, 1, 1, 1)
        # From the side they differ as decision 0051 says: grey metals in Fresnel's term, rough borders in Smith's.
        for m, tilts in ((shader("ShaderNodeBsdfDiffuse", Color=grey), (0, 1.2)),
                         (shader("ShaderNodeBsdfGlossy", Color=white, Roughness=0.1), (0, 1.2)),
                         (shader("ShaderNodeBsdfGlossy", Color=grey, Roughness=0.7), (0,)),
                         (material(Base_Color=white, Metallic=1.0, Roughness=0.3), (0, 1.2)),
                         (material(Base_Color=grey, Metallic=1.0, Roughness=0.3), (0,)),
                         (material(Base_Color=(0, 0, 0, 1), Specular=0.5, Roughness=0.3), (0, 1.2))):
            plane = self.plane(m)
            for tilt in tilts:
                self.camera.location = (0, -5 * math.sin(tilt), 5 * math.cos(tilt))
                self.camera.rotation_euler = (tilt, 0, 0)
                with self.subTest(m.name, tilt=tilt):
                    self.assert_as_cycles(0.015)
            bpy.data.objects.remove(plane)

    def test_textures_lie_as_in_cycles(self):
        # Nearest texels: Cycles interpolates bytes before it decodes them, which contrasts as hard as these would show.
        m = self.image_material()
        self.plane(m, size=3)
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        # A turn or flip would change these means by more than 0.1.
        self.assert_quarters_as_cycles(samples=64)

    def image_material(self, size=4, extension="REPEAT", uv_map=None, is_float=False):
        """Shows an image whose texels all differ, so that no turn or flip goes unseen."""
        image = bpy.data.images.new("texels", size, size, float_buffer=is_float)
        image.pixels = [v for i in range(size * size) for v in (i / 15, (i * 7 % 16) / 15, (i % 4) / 3, 1)]
        m = bpy.data.materials.new("shown")
        m.use_nodes = True
        tree = m.node_tree
        texture, principled = tree.nodes.new("ShaderNodeTexImage"), tree.nodes["Principled BSDF"]
        texture.image, texture.interpolation, texture.extension = image, "Closest", extension
        # The roughness at which Cycles' diffuse base is within 1 % of Lambert's (decision 0051).
        principled.inputs["Specular"].default_value, principled.inputs["Roughness"].default_value = 0, 0.3
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

    def test_uv_maps_are_those_of_the_render(self):
        # Selected in the editor, active for the render, and named by a node: all three differ.
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
        m.node_tree.links.new(texture.outputs["Color"], m.node_tree.nodes["Principled BSDF"].inputs["Emission"])
        self.plane(m, size=20)
        ours, theirs = mean(render("COVTRACE", 64)), mean(render("CYCLES", 64))
        for a, b in zip(ours, theirs):
            self.assertAlmostEqual(a / b, 1, delta=0.02, msg=f"{ours} against {theirs}")

    def test_lamps_shine_through_their_nodes(self):
        self.plane(material(**self.MATT))
        lamp = self.lamp("POINT", energy=400, shadow_soft_size=0).data
        plain = self.centre()
        lamp.use_nodes = True
        emission = lamp.node_tree.nodes["Emission"]
        emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (0.5, 0.5, 0.5, 1), 3
        self.assertAlmostEqual(self.centre() / plain, 1.5, delta=0.01)

    def test_world_image_stands_as_in_cycles(self):
        image = bpy.data.images.new("sky", 8, 4, float_buffer=True)
        image.pixels = [v for i in range(32) for v in (i % 8 / 7, i // 8 / 3, (i * 5 % 8) / 7, 1)]
        node = self.scene.world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        node.image, node.interpolation = image, "Linear"
        self.scene.world.node_tree.links.new(node.outputs["Color"], self.background.inputs["Color"])
        self.camera.data.lens = 10
        for turn in ((math.pi / 2, 0, 0.3), (math.pi / 2, 0, 2.5), (0.4, 0, 0)):
            self.camera.rotation_euler = turn
            ours, theirs = mean(render("COVTRACE", 16)), mean(render("CYCLES", 16))
            for a, b in zip(ours, theirs):
                self.assertAlmostEqual(a, b, delta=0.02)

    # -- the camera

    def test_camera_sees_what_cycles_sees(self):
        m = material(Emission=(1, 1, 1, 1), Emission_Strength=1.0, Base_Color=(0, 0, 0, 1), Specular=0.0)
        self.plane(m, size=1.3)
        for values in (dict(), dict(shift_x=0.3, shift_y=0.1), dict(type="ORTHO", ortho_scale=4),
                       dict(sensor_fit="VERTICAL", lens=35)):
            for key, value in values.items():
                setattr(self.camera.data, key, value)
            ours, theirs = render("COVTRACE", 16), render("CYCLES", 16)
            for part in ((0, 0, 16, 12), (16, 0, 32, 12), (0, 12, 16, 24), (16, 12, 32, 24)):
                self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.02, msg=str(values))

    def test_lens_blurs_as_in_cycles(self):
        m = material(Emission=(1, 1, 1, 1), Emission_Strength=1.0, Base_Color=(0, 0, 0, 1), Specular=0.0)
        self.plane(m, size=0.5)
        dof = self.camera.data.dof
        dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 2.5, 0.05
        ours, theirs = render("COVTRACE", 256), render("CYCLES", 256)
        parts = [(0, 0, WIDTH, HEIGHT), (12, 8, 20, 16)]
        for part in parts:
            self.assertAlmostEqual(mean(ours, *part)[0] / mean(theirs, *part)[0], 1, delta=0.05)
        self.assertLess(mean(ours, *parts[1])[0], 0.8)  # it is blurred

    def test_motion_blurs_along_the_way(self):
        m = material(Emission=(1, 1, 1, 1), Emission_Strength=1.0, Base_Color=(0, 0, 0, 1), Specular=0.0)
        plane = self.plane(m, size=0.5)
        for frame, x in ((0, -1), (2, 1)):
            plane.location.x = x
            plane.keyframe_insert("location", frame=frame)
        for curve in plane.animation_data.action.fcurves:
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

    def deform(self, mesh_object, moved, distance=(2, 0, 0)):
        """A shape key that moves these vertices, from no part at frame 0 to the whole way at frame 2; shutter over both."""
        mesh_object.shape_key_add(name="Basis")
        key = mesh_object.shape_key_add(name="moved")
        for i in moved:
            key.data[i].co = [a + b for a, b in zip(key.data[i].co, distance)]
        for frame, value in ((0, 0.0), (2, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)
        for curve in mesh_object.data.shape_keys.animation_data.action.fcurves:
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
        self.scene.frame_set(1)
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 2.0

    def shining(self):
        return material(Emission=(1, 1, 1, 1), Emission_Strength=1.0, Base_Color=(0, 0, 0, 1), Specular=0.0)

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

    def test_what_bends_is_told(self):
        plane = self.plane(self.shining(), size=0.5)
        self.deform(plane, range(2))
        self.export()
        self.assertTrue(any("bends while the shutter is open" in w for w in self.warnings), self.warnings)

    # -- the engine

    def test_layers_come_back(self):
        self.plane(material(Base_Color=(0.2, 0.4, 0.6, 1), Roughness=1.0))
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        image = render("COVTRACE", 16)
        centre = HEIGHT // 2 * WIDTH + WIDTH // 2
        self.assertAlmostEqual(image["Depth.Z"][centre], 5, delta=0.05)
        self.assertAlmostEqual(image["Denoising Normal.Z"][centre], 1, delta=1e-3)
        self.assertAlmostEqual(image["Denoising Albedo.B"][centre], 0.6, delta=0.05)
        self.assertGreater(image["Debug Sample Count.X"][centre], 0)
        for name in ("Noisy Image.R", "variance.R", "error.X", "density.X", "filter.X"):
            self.assertIn(name, image)

    def test_names_of_view_layers_are_free(self):
        self.scene.view_layers[0].name = "Another"
        self.plane(material(**self.MATT))
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        image = render("COVTRACE", 16)
        self.assertGreater(mean(image)[0], 0.3)
        self.assertEqual(set(image["Combined.A"]), {1.0})

    def test_instances_share_one_object(self):
        self.plane(material(**self.MATT), size=2)
        child = bpy.context.object
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=8)
        parent = bpy.context.object
        child.parent, parent.instance_type = parent, "VERTS"
        text = self.export()
        self.assertEqual(text.count("ObjectBegin"), 1)
        self.assertEqual(text.count("ObjectInstance"), 25)

    def test_unknown_nodes_are_told(self):
        m = material()
        noise = m.node_tree.nodes.new("ShaderNodeTexNoise")
        m.node_tree.links.new(noise.outputs["Color"], m.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
        self.plane(m)
        self.export()
        self.assertTrue(any("Noise Texture" in w for w in self.warnings), self.warnings)

    def test_what_is_left_out_is_told(self):
        """Each of these changes the picture in Cycles and not here."""
        m = material()
        tree = m.node_tree
        principled, output = tree.nodes["Principled BSDF"], tree.nodes["Material Output"]
        noise = tree.nodes.new("ShaderNodeTexNoise")
        image = tree.nodes.new("ShaderNodeTexImage")
        image.image, image.projection = bpy.data.images.new("image", 2, 2), "BOX"
        hsv = tree.nodes.new("ShaderNodeSeparateColor")
        hsv.mode = "HSV"
        tree.links.new(image.outputs["Color"], hsv.inputs[0])
        tree.links.new(hsv.outputs[0], principled.inputs["Roughness"])
        tree.links.new(image.outputs["Color"], principled.inputs["Specular"])
        tree.links.new(noise.outputs["Fac"], principled.inputs["Emission Strength"])
        tree.links.new(noise.outputs["Color"], output.inputs["Displacement"])
        tree.links.new(noise.outputs["Fac"], output.inputs["Volume"])
        strength = self.scene.world.node_tree.nodes.new("ShaderNodeValue")
        self.scene.world.node_tree.links.new(strength.outputs[0], self.background.inputs["Strength"])
        self.plane(m)
        lamp = self.lamp("POINT", energy=10)
        lamp.data.use_nodes = True
        falloff = lamp.data.node_tree.nodes.new("ShaderNodeLightFalloff")
        lamp.data.node_tree.links.new(falloff.outputs["Linear"], lamp.data.node_tree.nodes["Emission"].inputs["Strength"])
        for frame, x in ((0, 0.0), (2, 1.0)):
            lamp.location.x = x
            lamp.keyframe_insert("location", frame=frame)
        self.scene.render.use_motion_blur = True
        self.scene.frame_set(1)
        self.export()
        for text in ("'Separate Color' at 'Roughness'", "an image at 'Specular'", "projection of", "'Noise Texture' at 'Emission Strength'",
                     "Displacement is not", "Volume is not", "world's Strength", "linked to 'Strength' of its shader",
                     "moves while the shutter is open"):
            self.assertTrue(any(text in w for w in self.warnings), f"{text}: {self.warnings}")

    def export(self):
        class Engine:
            @staticmethod
            def frame_set(frame, subframe):
                bpy.context.scene.frame_set(frame, subframe=subframe)
        with tempfile.TemporaryDirectory() as folder:
            exporter = export_scene.SceneExporter(Engine(), bpy.context.evaluated_depsgraph_get(), folder)
            text = pathlib.Path(exporter.write()).read_text()
        self.warnings = exporter.warnings
        return text

    def test_escape_ends_the_render(self):
        self.plane(material(**self.MATT))
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        start, is_stopped = time.time(), engine.CovtraceEngine._is_stopped
        engine.CovtraceEngine._is_stopped = lambda self: time.time() > start + 2
        try:
            render("COVTRACE", 1e6)
        finally:
            engine.CovtraceEngine._is_stopped = is_stopped
        self.assertLess(time.time() - start, 15)

    def test_failures_are_errors(self):
        self.plane(material(**self.MATT))
        known = os.environ.get("COVTRACE")
        os.environ["COVTRACE"] = "/nonexistent/covtrace"
        try:
            with self.assertRaisesRegex(RuntimeError, "was not found"):
                render("COVTRACE", 1)
        finally:
            os.environ["COVTRACE"] = known or ""
        self.scene.camera = None
        with self.assertRaises(RuntimeError):
            render("COVTRACE", 1)


if __name__ == "__main__":
    result = unittest.main(argv=["addon_test", *os.environ.get("COVTRACE_TESTS", "").split()], exit=False, verbosity=2).result
    sys.stdout.flush()
    # Blender's own exit code knows nothing of failed tests.
    os._exit(0 if result.wasSuccessful() else 1)
