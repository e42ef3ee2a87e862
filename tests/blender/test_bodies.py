"""Nodes that hang on the place on a body, against Cycles: each body has a cell of the picture to itself."""

import math
import re
import struct
import unittest.mock

import bpy
import numpy as np
from addon_support import BlenderTest, render
from covtrace_blender import body_baking
from node_trees import BLUE, ORANGE, Tree

CELL = 48  # pixels; the bodies are in rows of four
COLUMNS = 4


class BodiesTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.camera.data.type, self.scene.covtrace.method = "ORTHO", "uniform"
        self.count = 0

    def place(self, obj, *materials, is_smooth=False):
        """Puts an object into the next cell, seen from a corner; its faces have the materials in turn."""
        obj.location = (self.count % COLUMNS, -(self.count // COLUMNS), 0)
        obj.rotation_euler = (-0.9, 0.1, 0.6)
        for m in materials:
            obj.data.materials.append(m)
        for number, polygon in enumerate(obj.data.polygons if obj.type == "MESH" else ()):
            polygon.material_index, polygon.use_smooth = number % len(materials), is_smooth
        self.count += 1
        return obj

    @staticmethod
    def made(kind, **values):
        getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**values)
        return bpy.context.object

    def sphere(self):
        return self.made("uv_sphere", radius=0.42, segments=24, ring_count=12)

    def cube(self):
        return self.made("cube", size=0.55)

    def assert_bodies(self, names, least_correlation=0.97, samples=32):
        """Asserts that within each body pixels vary together with Cycles', and that means agree within 3 %."""
        rows = -(-self.count // COLUMNS)
        self.scene.render.resolution_x, self.scene.render.resolution_y = size = (CELL * COLUMNS, CELL * rows)
        self.camera.location, self.camera.data.ortho_scale = ((COLUMNS - 1) / 2, -(rows - 1) / 2, 5), max(COLUMNS, rows)
        ours, theirs = (np.stack([np.reshape(render(engine, samples)[f"{name}.{c}"], size[::-1]) for c in "RGB"], axis=-1)
                        for engine, name in (("COVTRACE", "Noisy Image"), ("CYCLES", "Combined")))
        self.export()
        self.assertEqual(self.warnings, [])
        for number, name in enumerate(names):
            with self.subTest(name):
                y, x = (CELL * (number // COLUMNS) + 14, CELL * (number % COLUMNS) + 14)
                a, b = (p[y:y + CELL - 28, x:x + CELL - 28] for p in (ours, theirs))
                np.testing.assert_allclose(a.mean(axis=(0, 1)), b.mean(axis=(0, 1)), rtol=0.03)
                self.assertGreater(b.std(axis=(0, 1)).max(), 0.03, "all of it is alike")
                alike = np.corrcoef(a.ravel(), b.ravel())[0, 1]
                self.assertGreater(alike, least_correlation)

    @staticmethod
    def texture(kind, coordinates=None, settings=None, output="Color", **inputs):
        """A material that shows a texture; coordinates: an output of the node Texture Coordinate; None: nothing is linked."""
        tree = Tree(kind)
        links = {"Vector": (tree.node("TexCoord"), coordinates)} if coordinates else {}
        tree.show(tree.node("Tex" + kind, settings, {**{k.replace("_", " "): v for k, v in inputs.items()}, **links}), output)
        return tree.material

    @staticmethod
    def pattern():
        image = bpy.data.images.new("pattern", 16, 16, float_buffer=True)
        y, x = np.mgrid[:16, :16] / 15
        image.pixels = np.dstack((x, y, 0.5 + 0.4 * np.sin(9 * x * y), np.ones_like(x))).ravel()
        return image

    def test_patterns_on_bodies_are_as_in_cycles(self):
        noise = dict(Scale=4.0, Detail=2.0)
        names = []

        def add(name, obj, *materials, **options):
            names.append(name)
            return self.place(obj, *materials, **options)

        add("noise of a sphere", self.sphere(), self.texture("Noise", **noise), is_smooth=True)
        add("two materials", self.cube(), self.texture("Voronoi", "Object", Scale=4.0),
            self.texture("Checker", Scale=3.0, Color1=BLUE, Color2=ORANGE))
        twisted = add("modifiers", self.cube(), self.texture("Noise", **noise))
        twisted.modifiers.new("round", "BEVEL").width = 0.08
        twist = twisted.modifiers.new("twist", "SIMPLE_DEFORM")
        twist.deform_method, twist.deform_axis, twist.angle = "TWIST", "Z", 0.8
        bare = add("no UV map", self.made("monkey", size=0.75), self.texture("Wave", "Object", Scale=1.0, Distortion=3.0), is_smooth=True)
        while bare.data.uv_layers:
            bare.data.uv_layers.remove(bare.data.uv_layers[0])
        boxed = self.texture("Image", "Object", {"projection": "BOX", "projection_blend": 0.3, "image": self.pattern()})
        add("box", self.sphere(), boxed, is_smooth=True)
        add("around", self.sphere(), self.texture("Image", "Generated", {"projection": "SPHERE", "image": self.pattern()}), is_smooth=True)
        mixed = Tree()
        image = mixed.node("TexImage", {"image": self.pattern()}, {"Vector": mixed.uv()})
        mixed.show(mixed.node("MixRGB", {"blend_type": "MULTIPLY"}, {0: 1.0, 1: image, 2: (mixed.node("TexNoise", {}, {"Scale": 6.0}), 0)}))
        add("with its UV map", self.cube(), mixed.material)
        moved = Tree()
        world = moved.node("TexNoise", {}, {"Scale": 3.0, "Vector": (moved.node("NewGeometry"), "Position")})
        moved.show(world, "Color")
        add("world", self.cube(), moved.material)
        self.assert_bodies(names)

    def light_from_the_side(self):
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        self.lamp("SUN", energy=3.0).rotation_euler = (0.5, 0.4, 0)

    @staticmethod
    def bumpy():
        tree = Tree()
        noise = tree.node("TexNoise", {}, {"Scale": 5.0, "Detail": 0.0})
        tree.link(tree.node("Bump", {}, {"Distance": 0.03, "Height": (noise, "Fac")}), 0, tree.shader.inputs["Normal"])
        return tree.material

    def attribute(self, obj, kind, domain, values, name="painted"):
        """Gives an object's mesh an attribute; values(number of an element, count) gives its values."""
        found = obj.data.attributes.new(name, kind, domain)
        for number, element in enumerate(found.data):
            value = values(number, len(found.data))
            if "COLOR" in kind:
                element.color = value
            elif kind == "FLOAT_VECTOR":
                element.vector = value
            else:
                element.value = value

    def test_attributes_are_as_in_cycles(self):
        def colour(number, count):
            share = number / count
            return share, 0.5 + 0.5 * math.cos(9 * share), 1 - share, share * share

        names = []
        for kind, domain, output, values in (
                ("FLOAT_COLOR", "POINT", "Color", colour), ("BYTE_COLOR", "CORNER", "Color", colour),
                ("FLOAT_COLOR", "POINT", "Fac", colour), ("BYTE_COLOR", "CORNER", "Alpha", colour),
                ("FLOAT", "POINT", "Fac", lambda i, n: i / n), ("FLOAT_VECTOR", "FACE", "Vector", lambda i, n: colour(i, n)[:3]),
                ("BOOLEAN", "FACE", "Fac", lambda i, n: i % 3 == 0), ("INT", "POINT", "Color", lambda i, n: i % 2)):
            tree, is_colour = Tree(f"{kind} {domain} {output}"), "COLOR" in kind
            node = tree.node("VertexColor" if is_colour and output != "Fac" else "Attribute")
            if node.type == "ATTRIBUTE":
                node.attribute_name = "painted"
            tree.show(node, output)
            obj = self.place(self.sphere(), tree.material, is_smooth=True)
            self.attribute(obj, kind, domain, values)
            if is_colour:
                obj.data.color_attributes.render_color_index = 0
            names.append(tree.material.name)
        self.assert_bodies(names)

    def test_what_attributes_lack_is_as_in_cycles(self):
        """Two numbers as one, UV maps by name, what a mesh has not, a node without a name, and kinds that Cycles does not know."""
        for title, name, output in (("two", "pair", "Fac"), ("map", "UVMap", "Color"), ("none", "nothing", "Alpha"), ("nameless", "", "Color"),
                                    ("turn", "turn", "Color")):
            tree = Tree(title)
            node = tree.node("Attribute")
            node.attribute_name = name
            tree.show(node, output)
            obj = self.place(self.sphere(), tree.material, is_smooth=True)
            for number, element in enumerate(obj.data.attributes.new("pair", "FLOAT2", "POINT").data):
                element.vector = (number % 3 / 3, 0.9)
            for element in obj.data.color_attributes.new("colour", "BYTE_COLOR", "CORNER").data:
                element.color = (0.9, 0.5, 0.2, 1)
            if bpy.app.version >= (4, 0, 0):
                for element in obj.data.attributes.new("turn", "QUATERNION", "POINT").data:
                    element.value = (0.8, 0.2, 0.5, 0.3)
        size = self.scene.render.resolution_x, self.scene.render.resolution_y = CELL * COLUMNS, 2 * CELL
        self.camera.location, self.camera.data.ortho_scale = ((COLUMNS - 1) / 2, -0.5, 5), COLUMNS
        ours, theirs = (np.stack([np.reshape(render(engine, 16)[f"Combined.{c}"], size[::-1]) for c in "RGB"], axis=-1)
                        for engine in ("COVTRACE", "CYCLES"))
        for number in range(self.count):
            y, x = CELL * (number // COLUMNS) + 14, CELL * (number % COLUMNS) + 14
            a, b = (p[y:y + CELL - 28, x:x + CELL - 28].mean(axis=(0, 1)) for p in (ours, theirs))
            with self.subTest(number=number):
                np.testing.assert_allclose(a, b, rtol=0.03, atol=2e-3)

    def test_heights_on_bodies_are_as_in_cycles(self):
        self.light_from_the_side()
        material = self.bumpy()
        self.place(self.sphere(), material, is_smooth=True)
        self.place(self.made("torus", major_radius=0.3, minor_radius=0.13), material, is_smooth=True).scale = (-1, 1, 1)
        self.place(self.made("monkey", size=0.75), material, is_smooth=True)
        self.place(self.cube(), material)
        self.place(self.sphere(), material, is_smooth=True).scale = (0.3, 1, 1)
        twin = self.sphere()
        self.place(twin, material, is_smooth=True)
        things = bpy.data.collections.new("things")
        things.objects.link(twin)
        self.scene.collection.objects.unlink(twin)
        for scale in ((1, 1, 1), (-1, 1, 1)):
            self.count -= scale[0] > 0
            empty = self.place(bpy.data.objects.new("empty", None))
            empty.instance_type, empty.instance_collection, empty.scale = "COLLECTION", things, scale
            things.instance_offset, empty.rotation_euler = twin.location, (0, 0, 0)
            self.scene.collection.objects.link(empty)
        self.assert_bodies(["sphere", "mirrored torus", "monkey", "cube", "flat", "instance", "mirrored instance"], 0.99)

    def test_normal_maps_on_bodies_are_as_in_cycles(self):
        self.light_from_the_side()
        tree = Tree()
        image = bpy.data.images.new("normals", 64, 64, float_buffer=True)
        image.colorspace_settings.name = "Non-Color"
        y, x = np.mgrid[:64, :64] * (2 * np.pi / 8)
        image.pixels = np.dstack((0.5 + 0.15 * np.sin(x), 0.5 + 0.15 * np.cos(y), np.full_like(x, 0.96), np.ones_like(x))).ravel()
        normals = tree.node("NormalMap", {}, {"Color": tree.node("TexImage", {"image": image}, {"Vector": tree.uv()})})
        tree.link(normals, 0, tree.shader.inputs["Normal"])
        places = {"over a UV map": tree.material}
        if hasattr(normals, "convention"):  # from Blender 5.1 on
            places["of DirectX"] = tree.material.copy()
            places["of DirectX"].node_tree.nodes[normals.name].convention = "DIRECTX"
        for where, material in list(places.items()):
            on_body = places[f"{where} over a body"] = material.copy()
            nodes = on_body.node_tree.nodes
            noise = nodes.new("ShaderNodeTexNoise")
            noise.inputs["Scale"].default_value = 2
            on_body.node_tree.links.new(noise.outputs["Color"], nodes[tree.shader.name].inputs["Color"])
        for material in places.values():
            for scale in (1, -1):
                self.place(self.sphere(), material, is_smooth=True).scale = (scale, 1, 1)
            for loop in self.place(self.sphere(), material, is_smooth=True).data.uv_layers[0].data:
                loop.uv = (-2 * loop.uv[0], loop.uv[1])
        self.assert_bodies([f"{kind} {where}" for where in places for kind in ("plain", "mirrored", "mirrored map")])

    def test_what_is_no_body_is_told_or_left_out(self):
        nothing = self.place(self.cube(), self.texture("Noise"))
        nothing.data.clear_geometry()
        broken = self.place(self.cube(), self.texture("Noise"))
        broken.data.vertices[0].co.x = float("nan")
        tree = Tree()
        tree.show(tree.node("TexNoise"))
        tree.link(tree.node("VolumeAbsorption"), 0, tree.tree.nodes["Material Output"].inputs["Volume"])
        unused = self.place(self.cube(), self.texture("Noise"))
        unused.data.materials.append(tree.material)
        self.place(self.cube(), self.texture("Noise")).scale = (0, 0, 0)
        point = self.place(self.cube(), self.texture("Voronoi"))
        for vertex in point.data.vertices:
            vertex.co = (0, 0, 0)
        self.camera.location = unused.matrix_world @ unused.data.vertices[0].co  # infinitely near
        self.export()
        self.assertEqual(len([w for w in self.warnings if "not finite" in w]), 1, self.warnings)

    def sizes(self):
        """(width, height) of the images that an export writes."""
        found = []
        self.text = self.export(lambda folder: found.extend(
            struct.unpack(">II", file.read_bytes()[16:24]) for file in sorted(folder.glob("texture*.png"))))
        return found

    def test_images_of_bodies_are_as_fine_as_the_picture(self):
        self.camera.data.type = "PERSP"
        ball = self.place(self.sphere(), self.texture("Noise", Scale=3.0))
        twin = bpy.data.objects.new("twin", ball.data)
        self.scene.collection.objects.link(twin)
        self.scene.render.resolution_x, self.scene.render.resolution_y = 256, 192
        baked = []
        original = body_baking.BodyPlace
        with unittest.mock.patch.object(body_baking, "BodyPlace", lambda *a: baked.append(1) or original(*a)):
            near, = self.sizes()  # one for both, whose meshes are the same
            self.assertEqual(len(set(re.findall(r'"string filename" "(texture\d+.png)"', self.text))), 1)
            count = len(baked)
            self.assertGreater(count, 0)
            self.assertEqual(self.sizes(), [near])
            self.assertEqual(len(baked), count, "what has not changed was baked again")
            self.scene.render.resolution_x *= 4
            self.scene.render.resolution_y *= 4
            fine, = self.sizes()
        self.assertGreater(fine[0] / near[0], 3)  # less than 4: margins do not grow

    def test_images_of_long_bodies_that_shine_are_no_squares(self):
        tree = Tree()
        shader = tree.node("Emission", {}, {"Color": (tree.node("TexNoise", {}, {"Scale": 9.0}), "Color")})
        tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
        tube = self.made("cube", size=2)
        for vertex in tube.data.vertices:
            vertex.co.y *= 0.01
            vertex.co.z *= 0.01
        self.place(tube, tree.material)
        self.scene.render.resolution_x, self.scene.render.resolution_y = 512, 384
        (width, height), = self.sizes()
        self.assertGreater(max(width, height), 3 * min(width, height))
