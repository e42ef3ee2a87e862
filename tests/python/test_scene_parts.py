"""Scenes that are changed after they were read: the same bits as the file with these values gives."""

import base64
import json
import pathlib
import struct
import tempfile
import unittest
import warnings

import numpy

import covtrace

TEXT = """
LookAt {eye}  {target}  0 1 0
Camera "perspective" "float fov" {fov} "float lensradius" {lens} "float focaldistance" {focus}
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
WorldBegin
LightSource "infinite" "rgb L" [{sky}]
AttributeBegin
  Translate {lamp}
  LightSource "point" "rgb I" [10 10 10]
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [{area}]
  Translate 0 3 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
Texture "checks" "spectrum" "checkerboard"
MakeNamedMaterial "floor" "string type" "diffuse" {floor}
MakeNamedMaterial "metal" "string type" "conductor" "rgb reflectance" [.9 .8 .7] "float roughness" {rough}
NamedMaterial "{ball}"
AttributeBegin
  {place}
  Shape "sphere" "float radius" 1
AttributeEnd
NamedMaterial "floor"
Shape "trianglemesh" "point3 P" [-4 -1 -4  4 -1 -4  4 -1 4  -4 -1 4] "point2 uv" [0 0  4 0  4 4  0 4] "integer indices" [0 2 1  0 3 2]
"""
VALUES = {"eye": "0 1 6", "target": "0 0 0", "fov": 40, "lens": 0, "focus": 6, "sky": ".1 .2 .3", "lamp": "2 3 4", "area": "3 3 3",
          "floor": '"texture reflectance" "checks"', "rough": 0.3, "ball": "metal", "place": "Translate 0.25 0 0"}


def scene(**values):
    return covtrace.Scene.from_string(TEXT.format(**{**VALUES, **values}))


def moved(x, y, z):
    matrix = numpy.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


class Parts(unittest.TestCase):
    def setUp(self):
        self.scene = scene()

    def test_attributes_that_are_none_are_refused(self):
        # They were set in Python and changed no picture.
        camera, metal = self.scene.camera, self.scene.materials["metal"]
        for part, name, told in ((camera, "fov", r"its values are items, such as \['fov'\]"),
                                 (metal, "reflectance", r"its values are items, such as \['reflectance'\]"),
                                 (self.scene.lights[0], "I", "its values are items"), (self.scene.area_lights[0], "L", "its values are items"),
                                 (self.scene.shapes[0], "matrix", "has no attribute 'matrix' to set$"),
                                 (camera, "eye", r"look_at\(eye, target\) places it"),
                                 (self.scene, "environment", r"Scene has no attribute 'environment' to set; .*environment=")):
            with self.assertRaisesRegex(AttributeError, told):
                setattr(part, name, (1, 0, 0))
        for name, told in (("resolution", r"render\(scene, resolution="), ("spp", r"render\(scene, spp="), ("camera", "look_at"),
                           ("lights", "light="), ("materials", "items"), ("name", "name of Scene cannot be set$")):
            with self.assertRaisesRegex(AttributeError, f"^{name} of Scene cannot be set.*{told}" if told[0] != "n" else f"^{told}"):
                setattr(self.scene, name, None)
        self.scene.shapes[0].material = 1
        camera.to_world = moved(0, 1, 6)
        self.assertEqual(self.scene.shapes[0].material, 1)

    def test_attributes_that_are_none_tell_what_is_meant(self):
        for part, name, told in ((self.scene, "add_light", "light=.* adds lamps"), (self.scene, "width", r"resolution is \(width, height\)"),
                                 (self.scene, "frobnicate", "Scene has no attribute 'frobnicate'$"),
                                 (self.scene, "film", "resolution and spp"), (self.scene, "look_at", r"scene\.camera\.look_at"),
                                 (self.scene.camera, "position", "look_at"), (self.scene.materials, "keys", r"\[part\.name"),
                                 (self.scene.materials["metal"], "reflectance", r"such as \['reflectance'\]"),
                                 (self.scene.shapes[0], "matrix", "Shape has no attribute 'matrix'$")):
            with self.assertRaisesRegex(AttributeError, told):
                getattr(part, name)
        self.assertFalse(hasattr(self.scene, "add_light"))

    def test_the_extent_follows_the_shapes(self):
        # The floor's corners, the ball of radius 1 at x = 0.25 and the lamp of 0.5 at y = 3.
        numpy.testing.assert_allclose(self.scene.extent, [[-4, -1, -4], [4, 3.5, 4]], atol=1e-6)
        self.scene.shapes[1].place(moved(9, 0, 0))
        numpy.testing.assert_allclose(self.scene.extent, [[-4, -1, -4], [10, 3.5, 4]], atol=1e-6)
        self.assertIsNone(covtrace.Scene.from_string("WorldBegin").extent)

    def render(self, which):
        return covtrace.render(which, spp=4, seed=1)

    def assert_like(self, **values):
        image = self.render(self.scene)
        self.assertTrue(covtrace.compare(image, self.render(scene(**values))).identical, values)
        self.assertFalse(covtrace.compare(image, self.render(scene())).identical, "nothing was changed")

    def test_material_values(self):
        floor = self.scene.materials["floor"]
        self.assertEqual((floor.name, floor.kind, list(floor)), ("floor", "diffuse", ["reflectance"]))
        self.assertIsNone(floor["reflectance"])  # a checkerboard
        floor["reflectance"] = 0.5, 0.25, 0.125
        self.assertEqual(floor["reflectance"], (0.5, 0.25, 0.125))
        metal = self.scene.materials["metal"]
        self.assertAlmostEqual(metal["roughness"], 0.3, places=6)
        metal["roughness"] = 0.0625
        self.assertEqual([metal[n] for n in ("uroughness", "vroughness")], [0.0625] * 2)
        self.assert_like(floor='"rgb reflectance" [.5 .25 .125]', rough=0.0625)

    def test_metals_by_index(self):
        """eta and k count where a metal has no reflectance, and are listed there alone."""
        self.assertNotIn("eta", list(self.scene.materials["metal"]))
        text = TEXT.format(**VALUES).replace('"rgb reflectance" [.9 .8 .7]', '"rgb eta" [1 1 1] "rgb k" [3 2 1]')
        by_index = covtrace.Scene.from_string(text)
        # The reader takes indices for three channels from what pbrt's file says of its spectrum.
        expected = covtrace.Scene.from_string(text.replace("[3 2 1]", "[4 3 2]"))
        self.assertNotEqual(by_index.materials["metal"]["k"], expected.materials["metal"]["k"])
        by_index.materials["metal"]["k"] = expected.materials["metal"]["k"]
        self.assertTrue(covtrace.compare(self.render(by_index), self.render(expected)).identical)
        by_index.materials["metal"]["reflectance"] = 0.9, 0.8, 0.7
        self.assertTrue(covtrace.compare(self.render(by_index), self.render(scene())).identical)

    def test_lights(self):
        sky, lamp = self.scene.lights
        self.assertEqual([light.kind for light in self.scene.lights], ["infinite", "point"])
        sky["L"] = 1, 0.5, 0.25
        lamp.to_world = moved(-3, 2, 1)
        self.scene.area_lights[0]["L"] = 5
        self.assert_like(sky="1 .5 .25", lamp="-3 2 1", area="5 5 5")

    def test_the_angle_of_a_sun(self):
        text = TEXT.format(**VALUES) + 'LightSource "distant" "float angle" {}\n'
        narrow, wide = (covtrace.Scene.from_string(text.format(angle)) for angle in (0.5, 20))
        self.assertEqual(narrow.lights[2]["angle"], 0.5)
        narrow.lights[2]["angle"] = 20
        self.assertTrue(covtrace.compare(self.render(narrow), self.render(wide)).identical)
        with self.assertRaises(ValueError):
            narrow.lights[2]["angle"] = 200

    def test_removed_lights(self):
        self.scene.remove_light(-1)
        self.assertEqual([light.kind for light in self.scene.lights], ["infinite"])
        with self.assertRaisesRegex(IndexError, "there is no light 1; the scene has 1"):
            self.scene.remove_light(1)
        self.assertLess(self.render(self.scene).rgb.mean(), self.render(scene()).rgb.mean())

    def test_camera(self):
        camera = self.scene.camera
        camera["fov"], camera["lensradius"], camera["focaldistance"] = 30, 0.125, 5
        camera.look_at((3, 2, 5), (0, 0.5, 0))
        self.assertEqual(dict((n, camera[n]) for n in camera), {"fov": 30, "lensradius": 0.125, "focaldistance": 5})
        reference = scene(eye="3 2 5", target="0 .5 0", fov=30, lens=0.125, focus=5)
        numpy.testing.assert_allclose(camera.to_world, reference.camera.to_world, atol=1e-6)
        camera.to_world = reference.camera.to_world
        self.assert_like(eye="3 2 5", target="0 .5 0", fov=30, lens=0.125, focus=5)

    def test_cameras_have_what_changes_their_picture(self):
        """A lens radius blurred spherical cameras, which have no lens in files."""
        for kind, names in (('"orthographic"', ["lensradius", "focaldistance"]), ('"spherical"', []),
                            ('"spherical" "string mapping" "equirectangular"', []),
                            ('"spherical" "string mapping" "equisolid" "float fov" 200', ["fov"])):
            camera = covtrace.Scene.from_string(f'Camera {kind} WorldBegin Shape "sphere"').camera
            with self.subTest(kind):
                self.assertEqual(list(camera), names)
                with self.assertRaisesRegex(KeyError, f"there are {', '.join(names) or 'none'}"):
                    camera["radius"] = 1
        camera["fov"] = 360
        with self.assertRaisesRegex(covtrace.UsageError, "fov: expected a number"):
            camera["fov"] = 361

    def test_shapes(self):
        lamp, ball, floor = self.scene.shapes
        numpy.testing.assert_array_equal(ball.to_world, moved(0.25, 0, 0))
        self.assertIsNone(ball.end_to_world)
        self.assertEqual(self.scene.materials[ball.material].name, "metal")
        ball.to_world = moved(-1, 0.5, 0)
        ball.material = floor.material
        self.assert_like(place="Translate -1 .5 0", ball="floor")

    def test_motion(self):
        ball = self.scene.shapes[1]
        ball.place(moved(0, 0, 0), moved(1, 0, 0))
        numpy.testing.assert_array_equal(ball.end_to_world, moved(1, 0, 0))
        self.assert_like(place="ActiveTransform EndTime\nTranslate 1 0 0\nActiveTransform All")

    def test_copies_are_apart(self):
        other = self.scene.copy()
        other.materials["floor"]["reflectance"] = 0.5
        self.assertIsNone(self.scene.materials["floor"]["reflectance"])
        self.assertTrue(covtrace.compare(self.render(self.scene), self.render(scene())).identical)
        self.assertFalse(covtrace.compare(self.render(other), self.render(scene())).identical)

    def test_the_time_of_a_change(self):
        """The seconds that making the scene anew takes are told apart from the rendering."""
        statistics = self.render(self.scene).statistics
        self.assertGreater(statistics["seconds_scene"], 0)
        self.assertLess(statistics["seconds_scene"], statistics["seconds_total"])

    def test_refused(self):
        floor, metal = self.scene.materials["floor"], self.scene.materials["metal"]
        for part, name, value in ((floor, "reflectance", 1.5), (floor, "reflectance", (1, 2)), (floor, "reflectance", -0.1),
                                  (floor, "reflectance", "red"), (floor, "reflectance", float("nan")), (metal, "roughness", (1, 2, 3)),
                                  (self.scene.camera, "fov", 0), (self.scene.camera, "fov", 180), (self.scene.camera, "fov", None)):
            with self.subTest(name=name, value=value), self.assertRaises(covtrace.UsageError):
                part[name] = value
        for action in (lambda: floor["colour"], lambda: self.scene.materials["wall"]):
            with self.assertRaises(KeyError):
                action()
        with self.assertRaises(KeyError):
            floor["colour"] = 1
        for action in (lambda: self.scene.lights[2], lambda: self.scene.shapes[-4], lambda: self.scene.remove_light(2)):
            with self.assertRaises(IndexError):
                action()
        with self.assertRaisesRegex(KeyError, "no material 'wall'; the materials are '.*floor"):
            self.scene.materials["wall"]
        with self.assertRaisesRegex(IndexError, "no shape 3; the scene has 3$"):
            self.scene.shapes[3]
        with self.assertRaises(IndexError):
            self.scene.shapes[0].material = 7
        for matrix in (numpy.zeros((4, 4)), numpy.eye(3), numpy.full((4, 4), numpy.nan)):
            with self.assertRaises(covtrace.UsageError):
                self.scene.shapes[0].to_world = matrix
        with self.assertRaises(covtrace.UsageError):
            self.scene.camera.look_at((0, 0, 0), (0, 1, 0))
        self.assertTrue(covtrace.compare(self.render(self.scene), self.render(scene())).identical)


    def test_texts_of_parts(self):
        self.assertRegex(repr(self.scene.materials), "^<[0-9]+ materials: .*'floor'.*>$")
        self.assertRegex(repr(self.scene.materials["metal"]), "^<material 'metal' \\(conductor\\) {")
        self.assertRegex(repr(self.scene.lights[0]), "^<light \\([a-z]+\\) {")
        self.assertEqual(repr(self.scene.shapes), "<3 shapes>")
        self.assertEqual(repr(self.scene.area_lights), "<1 area light>")


class StandIns(unittest.TestCase):
    """A glTF file without camera and lights."""

    def setUp(self):
        positions = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
        root = {"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}],
                "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + base64.b64encode(positions).decode()}]}
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "scene.gltf")
            file.write_text(json.dumps(root))
            self.scene = covtrace.Scene(file)

    def warnings_of(self, **options):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            covtrace.render(self.scene, spp=1, method="uniform", resolution=(16, 9), **options)
        return [str(w.message) for w in told]

    def test_a_camera_that_was_placed_stands_in_for_nothing(self):
        self.assertTrue(any("no camera" in text for text in self.warnings_of()))
        self.scene.camera.look_at((0, 0, 5), (0, 0, 0))
        self.assertFalse(any("no camera" in text for text in self.warnings_of()))

    def test_lights_that_are_not_there(self):
        with self.assertRaisesRegex(IndexError, "no light 0; the scene has none of its own; `environment`"):
            self.scene.lights[0]


class Gltf(unittest.TestCase):
    def scene_of(self, material):
        """A triangle of that material before a camera."""
        positions = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
        root = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}], "scene": 0,
                "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 5]}],
                "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
                "materials": [material],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}],
                "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + base64.b64encode(positions).decode()}]}
        with tempfile.TemporaryDirectory() as folder:
            file = f"{folder}/a.gltf"
            with open(file, "w", encoding="utf-8") as out:
                json.dump(root, out)
            return covtrace.Scene(file)

    def test_a_name_stands_for_all_parts_of_a_material(self):
        # A metal, what is none, and their mixture.
        scene = self.scene_of({"name": "paint", "pbrMetallicRoughness": {"metallicFactor": 0.5, "roughnessFactor": 1}})
        paint = scene.materials["paint"]
        self.assertRegex(repr(paint), r"^<material 'paint' \(coateddiffuse, conductor, mix\) {")
        self.assertEqual(paint["amount"], 0.5)
        paint["reflectance"] = 1, 0, 0
        self.assertEqual([scene.materials[i]["reflectance"] for i in range(2)], [(1, 0, 0)] * 2)
        paint["amount"] = 1
        found = covtrace.render(scene, spp=4, resolution=(24, 16), method="uniform", environment=1)
        self.assertGreater(found.rgb[..., 0].max(), 0.5)
        at = found["albedo"][..., 0] > 0.5
        self.assertTrue(at.any())
        self.assertLess(found["albedo"][..., 1][at].max(), 0.2)  # metals are white at grazing angles alone
        for action in (lambda: paint["colour"], lambda: paint.__setitem__("colour", 1)):
            with self.assertRaisesRegex(Exception, "colour"):
                action()

    def test_look_at_does_not_mirror(self):
        """A camera of glTF, whose world is right-handed: as the keyword `camera` of render shows it."""
        scene = self.scene_of({"name": "lamp", "emissiveFactor": [1, 1, 1], "doubleSided": True})
        options = {"spp": 4, "resolution": (24, 16), "environment": 0}
        there = {"eye": (3, 1, 4), "target": (0.3, 0.3, 0)}
        expected = covtrace.render(scene, **options, camera={**there, "fov": scene.camera["fov"]})
        scene.camera.look_at(**there)
        found = covtrace.render(scene, **options)
        self.assertGreater(found.rgb.mean(), 0.01)
        numpy.testing.assert_allclose(found.rgb, expected.rgb, atol=1e-3)
        self.assertEqual(scene.materials["lamp"].name, "lamp")


if __name__ == "__main__":
    unittest.main()
