"""Atlases of bodies: that each place has texels of its own, and which of them an export keeps."""

import struct
import unittest.mock
import weakref

import bpy
import numpy as np
from addon_support import BlenderTest, render
from covtrace_blender import atlases, body_baking, body_normals, export_scene
from covtrace_blender.atlas import Atlas
from node_trees import Tree

SIDES, STEPS = 4, 16  # corners around a spring's wire, and along a turn


def spring(turns, pitch, radius=1.0, wire=0.1):
    """(positions, triangles) of a wire in `turns` around the axis z."""
    along = np.arange(turns * STEPS + 1) * (2 * np.pi / STEPS)
    around = np.arange(SIDES) * (2 * np.pi / SIDES)
    out = radius + wire * np.cos(around)
    positions = np.stack([np.cos(along)[:, None] * out, np.sin(along)[:, None] * out,
                          (pitch / (2 * np.pi) * along)[:, None] + wire * np.sin(around)], axis=-1)
    corner = np.arange(len(along) * SIDES).reshape(-1, SIDES)
    a, b = corner[:-1], np.roll(corner, -1, axis=1)[:-1]
    c, d = corner[1:], np.roll(corner, -1, axis=1)[1:]
    triangles = np.concatenate([np.stack((a, c, d), -1).reshape(-1, 3), np.stack((a, d, b), -1).reshape(-1, 3)])
    return positions.reshape(-1, 3), triangles


def joined(*meshes):
    """The corners and triangles of several (positions, triangles) as one."""
    positions, triangles, first = [], [], 0
    for points, corners in meshes:
        positions.append(points)
        triangles.append(corners + first)
        first += len(points)
    triangles = np.concatenate(triangles)
    return np.concatenate(positions)[triangles], triangles


class AtlasTest(BlenderTest):
    def assert_places_have_texels_of_their_own(self, corners, triangles, density):
        """Asserts that texels show the places on the triangles that lie in them."""
        atlas = Atlas(corners, triangles, np.full(len(triangles), density), 1 << 22)
        shares = np.random.default_rng(1).dirichlet((1, 1, 1), (len(triangles), 8))
        places, uvs = (np.einsum("nki,nij->nkj", shares, values).reshape(-1, values.shape[-1]) for values in (corners, atlas.corner_uvs))
        number = np.full((atlas.height, atlas.width), -1)
        number[atlas.texels.rows, atlas.texels.columns] = np.arange(len(atlas.texels.rows))
        found = number[((1 - uvs[:, 1]) * atlas.height).astype(int), (uvs[:, 0] * atlas.width).astype(int)]
        self.assertTrue((found >= 0).all())
        away = np.linalg.norm(atlas.interpolated(corners, found) - places, axis=1)
        self.assertLess(away.max() * density, 3)

    def test_charts_that_lie_on_themselves_are_cut(self):
        short, long = spring(3, 0.5), spring(40, 0.5)
        long[0][:, 0] += 3
        self.assert_places_have_texels_of_their_own(*joined(short), 12.0)
        self.assert_places_have_texels_of_their_own(*joined(short, long), 12.0)


class KeptAtlasesTest(BlenderTest):
    def patterned(self, output):
        """A material of noise on an output of the node Texture Coordinate."""
        tree = Tree()
        tree.show(tree.node("TexNoise", {}, {"Scale": 3.0, "Vector": (tree.node("TexCoord"), output)}), "Color")
        return tree.material

    def work(self, frame):
        """(atlases that are laid out to render a frame, times that nodes are evaluated on bodies)."""
        self.scene.frame_set(frame)
        with unittest.mock.patch.object(atlases, "Atlas", side_effect=Atlas) as laid_out, \
                unittest.mock.patch.object(body_baking, "BodyPlace", side_effect=body_baking.BodyPlace) as evaluated:
            render("COVTRACE", 1)
        return laid_out.call_count, evaluated.call_count

    def test_what_deforms_is_baked_anew_where_its_coordinates_change(self):
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=4, size=2)
        arm = bpy.context.object
        arm.data.materials.append(self.patterned("Generated"))
        self.bend(arm, 0.3, 2)
        laid_out, evaluated = self.work(0)
        self.assertEqual(laid_out, 1)
        self.assertGreater(evaluated, 0)
        self.assertEqual(self.work(1), (0, 0))
        arm.data.materials[0] = self.patterned("Object")
        for frame in (1, 2):
            laid_out, evaluated = self.work(frame)
            self.assertEqual(laid_out, 0)
            self.assertGreater(evaluated, 0)
        self.assertEqual(self.work(2), (0, 0))

    def test_bodies_are_let_go_before_they_are_rendered(self):
        bpy.ops.mesh.primitive_cube_add()
        bpy.context.object.data.materials.append(self.patterned("Object"))
        made, lay_out = [], export_scene.Body.lay_out

        def noted(body, *arguments):
            made.append(weakref.ref(body))
            lay_out(body, *arguments)

        with unittest.mock.patch.object(export_scene.Body, "lay_out", noted):
            self.export(lambda folder: self.assertEqual([body() for body in made], [None]))

    def test_texels_are_let_go_and_found_again(self):
        corners, triangles = joined(spring(2, 0.5))
        with unittest.mock.patch.object(Atlas, "bytes_of_texels", autospec=True, side_effect=Atlas.bytes_of_texels) as looked_at, \
                unittest.mock.patch.object(atlases, "_known", {}), unittest.mock.patch.object(atlases, "MOST_BYTES", 1 << 17):
            first, second = [], []
            for found in (first, second):
                export = atlases.Atlases()
                for number in range(20):
                    found.append(export.of(corners, triangles, np.full(len(triangles), 8.0 + number), 1 << 16)[1])
                    self.assertGreater(len(found[-1].texels.rows), 0)
                    held = sum(atlas.bytes_of_texels() for atlas in found)
                    self.assertLess(held, (1 << 17) + 2 * found[-1].bytes_of_texels())
                looked_at.reset_mock()
                export.of(corners, triangles, np.full(len(triangles), 1.0), 1 << 16)
                self.assertLess(looked_at.call_count, 3)  # not all of them, each time
                export.keep()
            self.assertGreater(sum(atlas in first for atlas in second), 0)

    def texels(self):
        """The number of them in each of the images that an export writes."""
        found = []
        self.export(lambda folder: found.extend(struct.unpack(">II", file.read_bytes()[16:24]) for file in folder.glob("texture*.png")))
        return [width * height for width, height in found]

    def look_near(self):
        self.scene.render.resolution_x, self.scene.render.resolution_y, self.camera.data.lens = 256, 192, 20

    def assert_a_bound_makes_coarser(self, images):
        whole = self.texels()
        self.assertEqual(len(whole), images)
        self.assertEqual(self.warnings, [])
        with unittest.mock.patch.object(export_scene, "MOST_TEXELS", sum(whole) // 5):
            self.assertLess(sum(self.texels()), sum(whole) // 3)
        told, = self.warnings
        self.assertIn("as coarse", told)

    def test_all_atlases_together_have_a_bound(self):
        self.look_near()
        for number in range(6):
            bpy.ops.mesh.primitive_cube_add(size=0.8 - 0.02 * number, location=(number % 3 - 1, number // 3 - 0.5, 3.5))
            bpy.context.object.data.materials.append(self.patterned("Generated"))
        self.assert_a_bound_makes_coarser(6)

    def test_the_bound_counts_places_in_the_world_of_each_object_of_a_mesh(self):
        self.look_near()
        tree = Tree()
        tree.show(tree.node("TexNoise", {}, {"Scale": 4.0, "Vector": (tree.node("NewGeometry"), "Position")}), "Color")
        bpy.ops.mesh.primitive_cube_add(size=0.8, location=(0, 0, 3.5))
        first = bpy.context.object
        first.data.materials.append(tree.material)
        for number in range(5):
            twin = first.copy()
            twin.location.x += 1e-4 * (number + 1)
            self.scene.collection.objects.link(twin)
        self.assert_a_bound_makes_coarser(6)

    def test_a_floor_makes_nothing_else_coarser(self):
        self.look_near()
        bpy.ops.mesh.primitive_cube_add(size=0.8, location=(0, 0, 3.5))
        bpy.context.object.data.materials.append(self.patterned("Generated"))
        bpy.context.object.data.materials.append(self.patterned("Object"))  # on no face
        cube, = self.texels()
        self.plane(self.patterned("Generated"), size=1000)  # for which there would be thousands of millions
        with unittest.mock.patch.object(export_scene, "MOST_TEXELS", cube * 3 // 2 + (1 << 22)):
            self.assertIn(cube, self.texels())
            self.assertEqual(self.warnings, [])

    def test_the_bound_counts_each_image_once(self):
        def noise(tree, scale, vector=None):
            return tree.node("TexNoise", {}, {"Scale": scale, "Detail": 0.0, **({"Vector": (vector, 0)} if vector else {})})

        def mask(tree):
            mix = tree.node("MixShader", {}, {0: noise(tree, 2.1), 1: tree.node("BsdfTransparent"), 2: tree.shader})
            tree.link(mix, 0, tree.tree.nodes["Material Output"].inputs["Surface"])

        def uv_maps(tree):
            first, second = (tree.node("UVMap", {"uv_map": name}) for name in ("UVMap", "other"))
            tree.show(noise(tree, 2.2, first), "Color")
            tree.link(noise(tree, 2.3, second), 0, tree.shader.inputs["Roughness"])
            glossy = tree.node("BsdfGlossy", {}, {"Roughness": noise(tree, 2.4, second)})
            mix = tree.node("MixShader", {}, {0: 0.5, 1: tree.shader, 2: glossy})
            tree.link(mix, 0, tree.tree.nodes["Material Output"].inputs["Surface"])

        def normals(tree):
            tree.show(noise(tree, 2.5), "Color")
            tree.link(tree.node("NormalMap", {}, {"Color": (noise(tree, 2.6), "Color")}), 0, tree.shader.inputs["Normal"])

        make = body_baking.body_image
        for build, images in ((mask, 1), (uv_maps, 2), (normals, 3)):
            with self.subTest(build.__name__):
                tree = Tree()
                build(tree)
                plane = self.plane(tree.material, size=2)
                plane.data.uv_layers.new(name="other")
                with unittest.mock.patch.object(body_baking, "body_image", side_effect=make) as baked, \
                        unittest.mock.patch.object(body_normals, "body_image", side_effect=make) as turned, \
                        unittest.mock.patch.object(export_scene.BodyDemand, "add") as added:
                    self.export()
                bpy.data.objects.remove(plane)
                self.assertEqual(baked.call_count + turned.call_count, images)
                self.assertEqual([call.args[1] for call in added.call_args_list], [images])
