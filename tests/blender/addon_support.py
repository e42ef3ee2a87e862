"""Support for the tests of the add-on: they run inside Blender, and render by covtrace and by Cycles."""

import faulthandler
import math
import os
import pathlib
import sys
import tempfile
import unittest

import bpy

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "blender"))
sys.path.append(str(SOURCE / "tests" / "cli"))

import covtrace_blender
import exr
from covtrace_blender import export_scene

WIDTH, HEIGHT = 32, 24
MOST_SECONDS = 180


def write_layers(scene):
    """Images are OpenEXR files of one part with all layers."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # from Blender 5.0 on
        settings.media_type = "MULTI_LAYER_IMAGE"
        settings.use_exr_interleave = True  # one part, as before
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    settings.exr_codec = "ZIP"


def curves_of(animated):
    """The curves of what an object, or other data, is animated by."""
    action = animated.animation_data.action
    if hasattr(action, "fcurves"):  # to Blender 4.5
        return action.fcurves
    return [curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves]


def render(engine_name, samples):
    """The render as channels by name, without the view layer's name."""
    scene = bpy.context.scene
    scene.render.engine = engine_name
    scene.covtrace.samples = samples
    if engine_name == "CYCLES":
        scene.cycles.samples = samples
        scene.cycles.use_denoising = False
        scene.cycles.use_adaptive_sampling = False
        # A map of where the world is bright takes two seconds a picture at the resolution that Cycles chooses for nodes.
        scene.world.cycles.sampling_method, scene.world.cycles.sample_map_resolution = "MANUAL", 256
    write_layers(scene)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "image.exr")
        bpy.ops.render.render(write_still=True)
        image = exr.read(scene.render.filepath)
    return {name.split(".", 1)[1]: values for name, values in image.pixels.items()}


def mean(image, x0=0, y0=0, x1=WIDTH, y1=HEIGHT):
    """Mean colour of a part of the picture."""
    return [sum(image[f"Combined.{c}"][y * WIDTH + x] for y in range(y0, y1) for x in range(x0, x1)) /
            ((x1 - x0) * (y1 - y0)) for c in "RGB"]


# Names of Principled's sockets from Blender 4.0 on, by those of 3.4.
SINCE_4 = {"Specular": "Specular IOR Level", "Emission": "Emission Color", "Transmission": "Transmission Weight",
           "Clearcoat": "Coat Weight", "Clearcoat Roughness": "Coat Roughness", "Sheen": "Sheen Weight",
           "Subsurface": "Subsurface Weight"}


def socket(principled, name):
    """An input by its name in Blender 3.4."""
    return principled.inputs[SINCE_4.get(name, name) if bpy.app.version >= (4, 0, 0) else name]


def volume_material(kind, **inputs):
    """A material whose volume is a shader of this kind."""
    m = bpy.data.materials.new("filled")
    m.use_nodes = True
    m.node_tree.nodes.clear()
    output, node = m.node_tree.nodes.new("ShaderNodeOutputMaterial"), m.node_tree.nodes.new(kind)
    for name, value in inputs.items():
        node.inputs[name.replace("_", " ")].default_value = value
    m.node_tree.links.new(node.outputs[0], output.inputs["Volume"])
    return m


def geometry_tree(name):
    """A tree of geometry nodes, without any, from a geometry to another."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    if hasattr(tree, "interface"):
        for way in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    return tree


def material(name="material", **inputs):
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    for key, value in inputs.items():
        socket(m.node_tree.nodes["Principled BSDF"], key.replace("_", " ")).default_value = value
    return m


class BlenderTest(unittest.TestCase):
    MATT = dict(Base_Color=(0.5, 0.5, 0.5, 1), Specular=0.0, Roughness=1.0)

    def setUp(self):
        # A test that hangs says where.
        faulthandler.dump_traceback_later(MOST_SECONDS, exit=True)
        self.addCleanup(faulthandler.cancel_dump_traceback_later)
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
        """Asserts that the means of both whole pictures agree, per channel."""
        ours, theirs = mean(render("COVTRACE", samples)), mean(render("CYCLES", samples))
        for channel, (a, b) in enumerate(zip(ours, theirs)):
            self.assertGreater(b, 1e-3)
            self.assertAlmostEqual(a / b, 1, delta=tolerance, msg=f"channel {channel}: {ours} against {theirs}")

    def shares(self, m, tilts=(0, 0.8, 1.2), engines=("COVTRACE", "CYCLES")):
        """Yields (tilt, colours by engine): how bright a plane in a white surrounding is from above and aslant, and exports it."""
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.camera.data.lens = 200
        plane = self.plane(m)
        for tilt in tilts:
            self.camera.location = (0, -5 * math.sin(tilt), 5 * math.cos(tilt))
            self.camera.rotation_euler = (tilt, 0, 0)
            yield tilt, *(mean(render(engine, 64)) for engine in engines)
        self.export()
        bpy.data.objects.remove(plane)

    def assert_as_bright(self, m, tolerance, what, tilts=(0, 0.8, 1.2)):
        """Asserts that a plane in a white surrounding is as bright as in Cycles, seen from above and aslant, and that nothing is
        left out. tolerance: of the share that comes back; what: what an error calls it."""
        for tilt, ours, theirs in self.shares(m, tilts):
            for a, b in zip(ours, theirs):
                self.assertAlmostEqual(a, b, delta=tolerance, msg=f"{what} at {tilt}: {ours} against {theirs}")
        self.assertEqual(self.warnings, [])

    def centre(self):
        return mean(render("COVTRACE", 64), WIDTH // 2 - 2, HEIGHT // 2 - 2, WIDTH // 2 + 2, HEIGHT // 2 + 2)[0]

    def shining(self):
        return material(Emission=(1, 1, 1, 1), Emission_Strength=1.0, Base_Color=(0, 0, 0, 1), Specular=0.0)

    def bend(self, arm, turn, softness):
        """Puts an arm along x, whose elbow is at 0, on two bones, of which the second turns about z by `turn` radian either way
        from frame 0 to 2; `softness`: length over which it bends."""
        bpy.ops.object.armature_add(enter_editmode=True)
        rig = bpy.context.object
        bones = rig.data.edit_bones
        upper, lower = bones[0], bones.new("lower")
        upper.head, upper.tail = (-1.5, 0, 0), (0, 0, 0)
        lower.head, lower.tail, lower.parent = (0, 0, 0), (1.5, 0, 0), upper
        names = (upper.name, lower.name)
        bpy.ops.object.mode_set(mode="OBJECT")
        for name, share in zip(names, (lambda t: 1 - t, lambda t: t)):
            group = arm.vertex_groups.new(name=name)
            for vertex in arm.data.vertices:
                group.add([vertex.index], share(min(max(vertex.co.x / softness + 0.5, 0), 1)), "REPLACE")
        arm.parent = rig
        arm.modifiers.new("rig", "ARMATURE").object = rig
        bone = rig.pose.bones[names[1]]
        bone.rotation_mode = "QUATERNION"
        for frame, angle in ((0, -turn), (2, turn)):
            bone.rotation_quaternion = (math.cos(angle / 2), 0, 0, math.sin(angle / 2))
            bone.keyframe_insert("rotation_quaternion", frame=frame)
        for curve in curves_of(rig):
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"

    def export(self, look=lambda folder: None):
        """The text of the exported scene; look: called with the folder that it is in while that is there."""
        class Engine:
            @staticmethod
            def frame_set(frame, subframe):
                bpy.context.scene.frame_set(frame, subframe=subframe)
        with tempfile.TemporaryDirectory() as folder:
            exporter = export_scene.SceneExporter(Engine(), bpy.context.evaluated_depsgraph_get(), folder)
            text = pathlib.Path(exporter.write()).read_text()
            look(pathlib.Path(folder))
        self.warnings = exporter.warnings
        return text


BOUNCES = 8

# Whole, upper left, upper right, lower left, lower right.
PARTS = ((0, 0, 32, 24), (0, 0, 16, 12), (16, 0, 32, 12), (0, 12, 16, 24), (16, 12, 32, 24))


class CyclesTest(BlenderTest):
    """Pictures beside those of Cycles, part by part."""

    def setUp(self):
        super().setUp()
        # All light of both, without limits of Cycles' own.
        cycles = self.scene.cycles
        cycles.sample_clamp_indirect, cycles.blur_glossy = 0, 0
        for kind in ("max", "diffuse", "glossy", "transmission"):
            setattr(cycles, f"{kind}_bounces", BOUNCES)
        self.scene.covtrace.max_depth = BOUNCES

    def shader(self, kind, name="shader", **inputs):
        """A material of one shader node."""
        m = bpy.data.materials.new(name)
        m.use_nodes = True
        tree = m.node_tree
        node = self.node(tree, kind, **inputs)
        tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        return m

    @staticmethod
    def node(tree, kind, **inputs):
        node = tree.nodes.new("ShaderNode" + kind)
        for key, value in inputs.items():
            node.inputs[key.replace("_", " ")].default_value = value
        return node

    def thing(self, kind, m, location=(0, 0, 0), rotation=(0, 0, 0), **values):
        getattr(bpy.ops.mesh, f"primitive_{kind}_add")(location=location, rotation=rotation, **values)
        bpy.context.object.data.materials.append(m)
        return bpy.context.object

    def assert_parts_as_cycles(self, tolerance=0.05, samples=256, least=0.02, samples_of_cycles=512):
        """samples_of_cycles: many where it finds light by chance hits of a lamp behind a mirror or glass."""
        ours, theirs = render("COVTRACE", samples), render("CYCLES", samples_of_cycles)
        for part in PARTS:
            for channel, (a, b) in enumerate(zip(mean(ours, *part), mean(theirs, *part))):
                self.assertAlmostEqual(a, b, delta=tolerance * max(b, least), msg=f"{part} channel {channel}")
        return ours
