"""glTF files as Blender exports them, with armatures and shape keys, against what Cycles makes of the scene."""

import math
import os
import subprocess
import tempfile

import bpy
from addon_support import HEIGHT, WIDTH, BlenderTest, curves_of, exr, material, mean, render

FRAMES_PER_SECOND = 24


class GltfTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.scene.render.fps = FRAMES_PER_SECOND

    def render_file(self, *words):
        """Renders the export by covtrace; returns means by channel, as `render`, and the program's messages."""
        with tempfile.TemporaryDirectory() as folder:
            file, image = os.path.join(folder, "scene.glb"), os.path.join(folder, "image.exr")
            bpy.ops.export_scene.gltf(filepath=file, export_cameras=True, export_lights=True, export_yup=True)
            done = subprocess.run([os.environ["COVTRACE"], "render", file, "-o", image, "--spp", "256", "--resolution",
                                   f"{WIDTH}x{HEIGHT}", *words], capture_output=True, text=True, check=True)
            pixels = exr.read(image).pixels
        return {f"Combined.{c}": pixels[c] for c in "RGB"}, done.stderr

    def arm(self, thick):
        """An arm of two bones along x, of smooth shading, and with a shape key that thickens its end, with these values."""
        bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=0.25, depth=3, rotation=(0, math.pi / 2, 0))
        arm = bpy.context.object
        bpy.ops.object.transform_apply(rotation=True)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.subdivide(number_cuts=12)
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.ops.object.shade_smooth()
        # The emission is brighter than 1, so that it counts as a lamp and no others are made up.
        arm.data.materials.append(material(Emission=(1, 1, 1, 1), Emission_Strength=2.0, Base_Color=(0, 0, 0, 1), Specular=0.0))
        arm.shape_key_add(name="Basis")
        key = arm.shape_key_add(name="thick")
        for point, vertex in zip(key.data, arm.data.vertices):
            grown = 1 + max(vertex.co.x, 0) / 1.5
            point.co = (vertex.co.x, vertex.co.y * grown, vertex.co.z * grown)
        self.bend(arm, math.radians(20), 0.8)
        for frame, value in zip((0, 2), thick):
            key.value = value
            key.keyframe_insert("value", frame=frame)
        for curve in curves_of(arm.data.shape_keys):
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
        self.scene.frame_start, self.scene.frame_end = 0, 2
        return arm

    def assert_blocks(self, ours, theirs, delta):
        self.assertGreater(mean(theirs)[0], 0.05)
        for x in range(0, WIDTH, 4):
            for y in range(0, HEIGHT, 4):
                a, b = (mean(image, x, y, x + 4, y + 4)[0] for image in (ours, theirs))
                self.assertAlmostEqual(a / 2, b / 2, delta=delta, msg=f"block at {x}, {y}")

    def test_armatures_and_shape_keys_pose_meshes(self):
        self.arm((0, 1))
        for frame in (0, 2):
            self.scene.frame_set(frame)
            theirs = render("CYCLES", 64)
            # Blender exports the armature's action and the shape keys' as two animations, of which one plays by default.
            ours, messages = self.render_file("--animation", "all", "--shutter",
                                              f"{frame / FRAMES_PER_SECOND},{(frame + 0.01) / FRAMES_PER_SECOND}")
            self.assert_blocks(ours, theirs, 0.04)
            self.assertNotIn("morph", messages)
            self.assertNotIn("skin", messages)

    def test_armatures_are_blurred(self):
        arm = self.arm((1, 1))
        self.scene.frame_set(1)
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 2.0
        arm.cycles.motion_steps = 5
        theirs = render("CYCLES", 256)
        ours, messages = self.render_file("--shutter", f"0,{2 / FRAMES_PER_SECOND}")
        self.assert_blocks(ours, theirs, 0.05)
        self.assertNotIn("bends", messages)
