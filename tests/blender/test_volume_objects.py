"""Volume objects, whose grids are those of OpenVDB, against Cycles."""

import math
import os
import tempfile
from unittest import mock

import bpy
import numpy as np
import test_varying_volumes
from addon_support import HEIGHT, WIDTH, BlenderTest, geometry_tree, render, volume_material
from covtrace_blender import openvdb_grids, volume_lattice

VDB = openvdb_grids.library()


class VolumeObjectsTest(BlenderTest):
    body, point, instances, node, link, assert_parts, fine_steps, times, noise, shader = (
        getattr(test_varying_volumes.VaryingVolumesTest, name) for name in
        ("body", "point", "instances", "node", "link", "assert_parts", "fine_steps", "times", "noise", "shader"))

    def setUp(self):
        super().setUp()
        if VDB is None:
            self.skipTest("there is no Python module of OpenVDB")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "grids.vdb")

    @staticmethod
    def places(shape, size):
        """x, y, z of voxels of this size, about the middle."""
        return [size * (axis - (n - 1) / 2) for axis, n in zip(np.meshgrid(*map(np.arange, shape), indexing="ij"), shape)]

    def grid(self, name, values, size, first=None, turn=None):
        """A grid of OpenVDB of an array, about the middle of its object."""
        grid = (VDB.Vec3SGrid if values.ndim > 3 else VDB.FloatGrid)()
        grid.copyFromArray(values.astype(np.float32))
        grid.name = name
        middle = [-size * (n - 1) / 2 for n in values.shape[:3]]
        matrix = np.eye(4)
        matrix[:3, :3] = size * (np.eye(3) if turn is None else turn)
        matrix[3, :3] = middle @ matrix[:3, :3] / size
        grid.transform = VDB.createLinearTransform(matrix.tolist())
        return grid

    def smoke(self, shape=(24, 20, 16), size=0.15):
        """Two puffs, of which one is thin."""
        x, y, z = self.places(shape, size)
        found = 3 * np.clip(1 - ((x - 0.5) ** 2 + y**2 + z**2) / 0.9, 0, None) + np.clip(1 - ((x + 1) ** 2 + (y - 0.4) ** 2 + z**2) / 0.4, 0, None)
        return self.grid("density", found, size)

    def volume(self, *grids, kind="ShaderNodeVolumePrincipled", **inputs):
        """A volume object of these grids, with a material of a node of this kind, both returned; None: without one."""
        VDB.write(self.path, grids=list(grids))
        data = bpy.data.volumes.new("smoke")
        data.filepath = self.path
        obj = bpy.data.objects.new("smoke", data)
        self.scene.collection.objects.link(obj)
        bpy.context.view_layer.objects.active = obj
        if not kind:
            return obj, None
        data.materials.append(volume_material(kind, **inputs))
        return obj, data.materials[0]

    def test_blur_takes_the_grids_of_the_middle(self):
        obj, _ = self.volume(self.smoke())
        obj.data.is_sequence = True
        self.scene.render.use_motion_blur = True
        name = self.path.replace(".vdb", "_%04d.vdb")
        texts = []
        for frame, strength in ((1, 1), (2, 5)):
            VDB.write(name % frame, grids=[self.grid("density", np.full((4, 4, 4), strength), 0.5)])
        obj.data.filepath, obj.data.frame_start, obj.data.frame_duration = name % 1, 1, 2
        for frame in (1, 2):
            self.scene.frame_set(frame)
            texts.append(self.export())
        self.assertIn("uniformgrid", texts[0])
        self.assertNotEqual(texts[0].split("density")[-1][:200], texts[1].split("density")[-1][:200])

    def test_overlaps_in_part_are_told(self):
        self.volume(self.smoke())
        self.body((0, 0, 0), (1, 1, 1), "ShaderNodeVolumeScatter")
        fog = bpy.context.object
        for size, count in ((20, 0), (0.3, 0), (1, 1)):
            fog.scale, fog.location = (size,) * 3, (1.2 if count else 0, 0, 0)
            bpy.context.view_layer.update()
            text = self.export()
            if size == 20:  # around the fog there is nothing, though its middle is in the smoke
                self.assertRegex(text, r'MediumInterface "medium \d+" ""')
            self.assertEqual(sum("overlap in part" in text for text in self.warnings), count, f"{size}: {self.warnings}")

    def test_ray_visibility_is_told(self):
        obj, _ = self.volume(self.smoke())
        obj.visible_camera = False
        self.export()
        self.assertIn("volumes that all rays see alike", " ".join(self.warnings))

    def test_smoke_of_a_file(self):
        self.volume(self.smoke(), Color=(0.8, 0.6, 0.4, 1), Density=1.5)
        self.point((1, 0, 2), 300)
        self.background.inputs["Color"].default_value = (0.1, 0.15, 0.2, 1)
        self.assert_parts(0.05)
        self.assertIn('"uniformgrid"', self.export())
        self.assertEqual(self.warnings, [])

    def test_without_material(self):
        self.volume(self.smoke(), kind=None)
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        self.assert_parts(0.05)

    def test_sizes_of_objects(self):
        """By the object's space what is larger is as clear."""
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        obj, m = self.volume(self.smoke(), Color=(0.2, 0.1, 0.3, 1), Density=1.0)
        obj.scale, obj.rotation_euler = (2, 0.5, 0.7), (0.3, 0.5, 1)
        for space in ("OBJECT", "WORLD"):
            with self.subTest(space):
                obj.data.render.space = space
                self.assert_parts(0.05)

    def fire(self, shape=(24, 20, 16), size=0.15):
        x, y, z = self.places(shape, size)
        heat = np.clip(1 - ((x + 0.3) ** 2 + (y + 0.2) ** 2 + z**2) / 1.2, 0, None)
        return self.grid("temperature", np.where(heat > 0, 0.4 + 0.6 * heat, 0), size)

    def test_fire(self):
        # Cycles' blackbodies of 1000 K are 7 % brighter in red than Planck's law in Rec.709 is, those of 2000 K 2 %.
        obj, m = self.volume(self.smoke(), self.fire(), Color=(0.3, 0.3, 0.3, 1), Blackbody_Intensity=0.05, Temperature=5000.0)
        for size in (1, 2):
            with self.subTest(size):
                obj.scale = (size, size, size)
                self.assert_parts(0.05)

    def test_attributes_and_volume_info(self):
        obj, m = self.volume(self.smoke(), self.fire((30, 12, 40), 0.1), kind="ShaderNodeVolumeAbsorption", Color=(0.1, 0.3, 0.6, 1))
        attribute, info, both = self.node(m, "Attribute", attribute_name="density"), self.node(m, "VolumeInfo"), self.node(m, "Math", operation="ADD")
        self.link(m, attribute.outputs["Fac"], both.inputs[0], info.outputs["Temperature"], both.inputs[1], both.outputs[0],
                  self.shader(m).inputs["Density"])
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        self.assert_parts(0.03)

    def test_grids_that_are_turned(self):
        turn = np.array([[math.cos(0.6), math.sin(0.6), 0], [-math.sin(0.6), math.cos(0.6), 0], [0, 0, 1]])
        x, y, z = self.places((24, 20, 16), 0.15)
        puff = 3 * np.clip(1 - (x**2 / 2 + y**2 / 0.5 + z**2), 0, None)
        self.volume(self.grid("density", puff, 0.15, turn=turn), Color=(0.2, 0.1, 0.3, 1))
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        self.assert_parts(0.05)

    def test_light_that_hangs_on_no_grid(self):
        """It fills the box around the grids, as in Cycles 5.3; before it fills more, which is told."""
        obj, m = self.volume(self.smoke(), Color=(0.3, 0.3, 0.3, 1), Emission_Strength=0.3, Emission_Color=(1, 0.4, 0.1, 1))
        self.export()
        if bpy.app.version < (5, 3, 0):
            self.assertEqual(self.warnings, ["material 'filled': its volume is not empty where its grids are; it fills the box around them, in this "
                                             "version of Cycles somewhat more"])
        else:
            self.assertEqual(self.warnings, [])
            self.assert_parts(0.05)

    def test_colours_of_a_grid(self):
        x, y, z = self.places((24, 20, 16), 0.15)
        colour = np.stack([0.9 + 0 * x, 0.5 + 0 * x, 0.2 + 0 * x], -1) * (x * x + y * y < 4)[..., None]
        obj, m = self.volume(self.smoke(), self.grid("tint", colour, 0.15), Color_Attribute="tint", Color=(0.9, 0.9, 0.9, 1))
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        self.assert_parts(0.05)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_what_geometry_nodes_make_of_a_mesh(self):
        """At the mesh's own place, and in instances of it."""
        bpy.ops.mesh.primitive_cube_add(size=1.5)
        cube, m = bpy.context.object, volume_material("ShaderNodeVolumePrincipled", Density=2.0, Color=(0.3, 0.2, 0.1, 1))
        tree = geometry_tree("smoke")
        nodes = [tree.nodes.new(kind) for kind in ("NodeGroupInput", "GeometryNodeMeshToVolume", "GeometryNodeSetMaterial", "NodeGroupOutput")]
        for a, b in zip(nodes, nodes[1:]):
            tree.links.new(a.outputs[0], b.inputs[0])
        nodes[2].inputs["Material"].default_value = m
        cube.modifiers.new("smoke", "NODES").node_group = tree
        cube.location = (0.5, 0.3, 0)
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        self.assert_parts(0.05)
        cube.location = (0, 0, 0)
        self.instances(cube, (-1, 0.5, 0), (1, 0, 0))
        self.assert_parts(0.05)
        self.assertEqual(self.export().count('"uniformgrid"'), 2)
        self.assertEqual(self.warnings, [])

    def test_many_voxels_have_means(self):
        obj, m = self.volume(self.smoke((96, 80, 64), 0.0375), Color=(0.2, 0.1, 0.3, 1))
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        with mock.patch.object(volume_lattice, "MOST", 1 << 15):
            self.assert_parts(0.05)
            self.assertLess(len(self.export()), 6 * 33000)
        self.assertEqual(len(self.warnings), 1)
        self.assertIn("blocks of 3 along each side have their mean", self.warnings[0])

    def test_what_has_no_grid_to_show_is_not_there(self):
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        obj, m = self.volume(self.smoke(), kind="ShaderNodeVolumeScatter", Density=3.0)
        self.assertNotIn("MakeNamedMedium", self.export())
        self.assert_parts(0.02, 8)
        obj.data.filepath = self.path + "none"
        m.node_tree.links.new(m.node_tree.nodes.new("ShaderNodeVolumePrincipled").outputs[0], m.node_tree.nodes["Material Output"].inputs["Volume"])
        self.assertNotIn("MakeNamedMedium", self.export())
        self.assertEqual(len(self.warnings), 1, self.warnings)
        self.assertIn("volume object 'smoke' is not rendered", self.warnings[0])

    def test_opacity_before_a_transparent_film(self):
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        self.scene.cycles.max_bounces = self.scene.cycles.volume_bounces = self.scene.covtrace.max_depth
        self.scene.render.film_transparent = True
        for color in (None, (0.8, 0.2, 0.1, 1)):
            obj, _ = self.volume(self.smoke(), **({"Color": color} if color else {}))
            alphas = [np.reshape(render(engine, samples)["Combined.A"], (2, HEIGHT // 2, 2, WIDTH // 2)).mean((1, 3))
                      for engine, samples in (("COVTRACE", 64), ("CYCLES", 1024))]
            self.assertLess(np.abs(alphas[0] - alphas[1]).max(), 0.003, alphas)
            self.assertGreater(np.ptp(alphas[0]), 0.2)
            self.export()
            self.assertEqual(self.warnings, [])
            bpy.data.objects.remove(obj)

    def test_layers_without_volumes(self):
        self.volume(self.smoke())
        self.scene.view_layers[0].use_volumes = False
        self.background.inputs["Color"].default_value = (1, 0.9, 0.8, 1)
        self.assert_parts(0.02, 8)

    def test_a_blender_without_openvdb_is_told(self):
        self.volume(self.smoke())
        with mock.patch.object(openvdb_grids, "library", lambda: None):
            self.assertNotIn("MakeNamedMedium", self.export())
        self.assertEqual(len(self.warnings), 1)
        self.assertIn("no Python module openvdb", self.warnings[0])
