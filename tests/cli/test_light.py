"""--light: lamps beside the scene's own, how bright they are, that films know them, and what tells of dark images."""

import json
import math
import re
import struct
import unittest

import exr
from gltf_file import uri
from support import DONE, TINY, USAGE, CliTest, warnings_of

RADIUS, REFLECTANCE = 3, 0.5
ROOM = f"""\
LookAt 0 0 0  1 0.3 1  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
Sampler "zsobol" "integer pixelsamples" 16
Integrator "path" "integer maxdepth" 1
WorldBegin
LightSource "infinite"
Material "diffuse" "rgb reflectance" [{REFLECTANCE} {REFLECTANCE} {REFLECTANCE}]
Shape "sphere" "float radius" {RADIUS}
"""


def glowing_room(emission):
    """A glTF file: a closed room of 2 by 2 by 2 whose walls glow, and a camera in its middle."""
    corners = [2 * (i >> axis & 1) - 1 for i in range(8) for axis in range(3)]
    sides = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    data = struct.pack("<24f", *corners) + struct.pack("<36H", *[i for a, b, c, d in sides for i in (a, b, c, a, c, d)])
    return json.dumps({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}, {"camera": 0}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        "materials": [{"doubleSided": True, "emissiveFactor": [emission] * 3, "pbrMetallicRoughness": {"metallicFactor": 0}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-1] * 3, "max": [1] * 3},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": len(data), "uri": uri(data)}],
    })


def lamp_and_floor(lamp_height):
    """A glTF file: a floor of 2 by 2 at z = 0 and, turned down to it, a one-sided lamp of that size at the height."""
    data = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    lamp = {"emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}}
    return json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_emissive_strength"],
        "nodes": [{"mesh": 0}, {"mesh": 1, "rotation": [1, 0, 0, 0], "translation": [0, 0, lamp_height]}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}, "doubleSided": True}, lamp],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": m}]} for m in (0, 1)],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": len(data), "uri": uri(data)}],
    })


class Light(CliTest):
    def seen(self, *arguments, scene=ROOM):
        """The channels and the warnings, as texts."""
        result = self.render(scene, "--method", "uniform", *arguments)
        self.assertEqual(result.code, DONE, result)
        return exr.read(self.folder / "out.exr").pixels, [text for _, text in warnings_of(result)]

    @staticmethod
    def mean(values):
        return sum(values) / len(values)

    def test_dark_images_tell_the_way_out(self):
        image, warnings = self.seen()
        self.assertEqual(max(image["G"]), 0)
        self.assertEqual(len(warnings), 1, warnings)
        for part in ("100 % of the surfaces in view are black", "--light camera", "--light 'x,y,z'", "--environment"):
            self.assertIn(part, warnings[0])
        self.assertEqual(self.render(ROOM, "--quiet").stderr, "")
        # An environment that is there already is no way out.
        _, warnings = self.seen("--environment", "0.5")
        self.assertIn("no light reaches them, that of --environment neither; --light camera", warnings[-1])
        self.assertNotIn("sky's light", warnings[-1])
        # Night skies, and pictures that are dark in half of what they show, are as they are meant.
        for scene in (ROOM.replace("0 0 0  1 0.3 1", "0 0 9  0 0 99"), ROOM.replace('LightSource "infinite"', 'LightSource "point" "rgb I" [.1 .1 .1]')):
            self.assertEqual(self.seen(scene=scene)[1], [])

    def test_cameras_that_see_nothing_tell_another(self):
        away = ROOM.replace("0 0 0  1 0.3 1", "0 0 -9  0 0 -99").replace('LightSource "infinite"', 'LightSource "point"')
        self.assertIn("LookAt 0 0 -9  0 0 -99", away)
        _, warnings = self.seen(scene=away)
        self.assertEqual(len(warnings), 1, warnings)
        self.assertIn("the camera sees nothing", warnings[0])
        view = re.search("--camera '(.*)'", warnings[0])[1]
        image, warnings = self.seen("--camera", view, scene=away)
        self.assertFalse(any("sees nothing" in w for w in warnings), warnings)
        self.assertGreater(max(image["albedo.G"]), 0)

    def test_pictures_that_are_far_too_bright_tell_the_exposure(self):
        bright = ROOM.replace('LightSource "infinite"', 'LightSource "point" "rgb I" [900 900 900] "point3 from" [0 0 0] #')
        picture = ("--png", str(self.folder / "out.png"))
        image, warnings = self.seen(*picture, scene=bright)
        self.assertEqual(len(warnings), 1, warnings)
        stops = float(re.search("--exposure (-[0-9]+)", warnings[0])[1])
        self.assertLess(sorted(image["G"])[len(image["G"]) // 2] * 2**stops, 0.5)
        # Neither with that exposure, nor where no picture is cut, nor where it is not far beyond white
        for arguments, scene in (((*picture, "--exposure", str(stops)), bright), ((), bright), ((*picture, "--view", "agx"), bright),
                                 (picture, bright.replace("900 900 900", "90 90 90"))):
            self.assertEqual(self.seen(*arguments, scene=scene)[1], [], arguments)
        # The option takes the exposure near the end of single precision, too.
        brightest = bright.replace("900 900 900", "1e36 1e36 1e36")
        told = [w for w in self.seen(*picture, scene=brightest)[1] if "--exposure" in w]
        stops = re.search("--exposure (-[0-9]+)", told[0])[1]
        self.assertLess(float(stops), -100)
        self.assertFalse(any("--exposure" in w for w in self.seen(*picture, "--exposure", stops, scene=brightest)[1]))

    def test_a_dim_lamp_is_no_darkness(self):
        dim = ROOM.replace('LightSource "infinite"', 'LightSource "point" "rgb I" [1e-5 1e-5 1e-5] "point3 from" [0 0 0] #')
        for method in ("uniform", "hybrid"):
            with self.subTest(method=method):
                image, warnings = self.seen("--method", method, scene=dim)
                self.assertGreater(max(image["G"]), 0)
                self.assertLess(max(image["G"]), 1e-4)
                self.assertEqual(warnings, [])
                self.assertIn("100 % of the surfaces in view are black", self.seen("--method", method)[1][0])

    def test_samples_that_missed_the_light_are_no_darkness(self):
        # The strong lamps are behind the wall, and a single sample seldom asks the one in the room.
        behind = "".join(f'LightSource "point" "rgb I" [99 99 99] "point3 from" [{x} 3.5 0]\n' for x in range(-4, 5))
        rare = ROOM.replace('LightSource "infinite"', behind + 'LightSource "point" "rgb I" [9 9 9]')
        image, warnings = self.seen("--spp", "1", "--guides", "none", scene=rare)
        met = sum(value > 0 for value in image["G"]) / len(image["G"])
        self.assertGreater(met, 0)
        self.assertLess(met, 0.4)
        self.assertEqual(warnings, [])

    def test_a_lamp_at_the_camera_suits_the_view(self):
        image, warnings = self.seen("--light", "camera")
        for value in image["G"]:
            self.assertAlmostEqual(value, 0.6 * REFLECTANCE, delta=0.01)
        self.assertEqual(len(warnings), 1, warnings)
        text = re.search('"(.*)"', warnings[0])[1]
        self.assertRegex(text, r"^0,0,0 power [\d.]+$")
        again, warnings = self.seen("--light", text)
        self.assertEqual(warnings, [])
        for a, b in zip(again["G"], image["G"]):
            self.assertAlmostEqual(a, b, delta=1e-3)
        # Two of them share the light, and the film's speed takes nothing of it.
        slow = ROOM.replace('"float fov" 40', '"float fov" 40 "float shutterclose" 0.02')
        for arguments, scene in ((("--light", "camera", "--light", "camera"), ROOM), (("--light", "camera"), slow)):
            self.assertAlmostEqual(self.mean(self.seen(*arguments, scene=scene)[0]["G"]), 0.6 * REFLECTANCE, delta=0.01)

    def test_white_rooms_are_not_burnt_out(self):
        # Each of 8 bounces of a sphere sends on the same share of the lamp's even light.
        for reflectance in (0.3, 0.8):
            white = ROOM.replace("[0.5 0.5 0.5]", f"[{reflectance} {reflectance} {reflectance}]").replace('maxdepth" 1', 'maxdepth" 8')
            image, _ = self.seen("--light", "camera", "--spp", "64", scene=white)
            with_others = (1 - reflectance**8) / (1 - reflectance)
            expected = reflectance * min(0.6 * with_others, 1.2)
            self.assertAlmostEqual(self.mean(image["G"]) / expected, 1, delta=0.02, msg=reflectance)

    def test_what_is_told_of_a_lamp_is_that_lamp(self):
        image, warnings = self.seen("--light", "0.0123456,-0.5,0 radius 0.4 colour 1,0.5,0")
        text = re.search('"(.*)"', warnings[0])[1]
        self.assertRegex(text, r"^0\.0123456,-0\.5,0 radius 0\.4 colour 1,0\.5,0 power [\d.]+$")
        again, _ = self.seen("--light", text)
        for channel in "RGB":
            self.assertEqual(again[channel], image[channel])

    def test_borders_of_media_are_not_what_it_lights(self):
        border = 'AttributeBegin\nMaterial "interface"\nShape "sphere" "float radius" 0.2\nAttributeEnd\n'
        image, _ = self.seen("--light", "camera", scene=ROOM + border)
        self.assertAlmostEqual(self.mean(image["G"]), 0.6 * REFLECTANCE, delta=0.01)

    def test_a_lamp_has_its_power_and_colour(self):
        power = 200
        expected = REFLECTANCE / math.pi * power / (4 * math.pi * RADIUS**2)
        off_the_middle = ROOM.replace("0 0 0  1 0.3 1", "-1 -0.3 -1  1 0.3 1")
        for more, radius in (("", 0), (" radius 0.4", 0.4)):
            image, _ = self.seen("--light", f"0,0,0 power {power} colour 1,0.5,0" + more, scene=off_the_middle)
            y = [0.2126 * r + 0.7152 * g for r, g in zip(image["R"], image["G"])]
            # The camera looks through the lamp, which it does not see.
            self.assertAlmostEqual(self.mean(y) / expected, 1, delta=0.02, msg=more)
            self.assertLess(max(y), 1.3 * expected)
            self.assertAlmostEqual(self.mean(image["G"]) / self.mean(image["R"]), 0.5, delta=0.001)
            self.assertEqual(max(image["B"]), 0)

    def test_spheres_throw_soft_shadows(self):
        scene = TINY.replace('LightSource "point" "point3 from" [2 3 4] "rgb I" [10 10 10]', "").replace(
            '  AreaLightSource "diffuse" "rgb L" [3 3 3]\n', "")
        hard, _ = self.seen("--light", "3,4,-1 power 800", "--spp", "64", scene=scene)
        soft, _ = self.seen("--light", "3,4,-1 power 800 radius 1.5", "--spp", "64", scene=scene)
        difference = [abs(a - b) for a, b in zip(hard["G"], soft["G"])]
        self.assertGreater(max(difference), 0.02)
        self.assertAlmostEqual(self.mean(soft["G"]) / self.mean(hard["G"]), 1, delta=0.1)

    def test_lamps_take_the_place_of_the_lights_of_a_scene_without(self):
        dark = TINY.split("WorldBegin")[0] + 'WorldBegin\nShape "sphere" "float radius" 1\n'
        image, warnings = self.seen("--light", "camera", scene=dark)
        self.assertEqual(image["G"][0], 0)
        self.assertGreater(max(image["G"]), 0.1)
        self.assertNotIn("no lights", "".join(warnings))
        image, _ = self.seen("--light", "camera", "--environment", "0.25", scene=dark)
        self.assertAlmostEqual(image["G"][0], 0.25, places=4)

    def test_walls_let_in_the_light_that_stands_in(self):
        dark = ROOM.replace('LightSource "infinite"\n', "")
        image, warnings = self.seen("--spp", "256", scene=dark)
        self.assertRegex(warnings[-1], "walls keep the light from outside from most of what is seen; the outermost \\(1 of 1 shapes\\)")
        # The wall before the camera is as bright as a piece of it that stands alone.
        alone = 'CoordSysTransform "camera"\nTranslate 0 0 3\nShape "disk"\n'

        def middle(picture):
            return self.mean([picture["G"][24 * y + x] for y in (7, 8) for x in (11, 12)])

        piece, warnings = self.seen("--spp", "256", scene=dark.split("Shape")[0] + alone)
        self.assertNotIn("walls", "".join(warnings))
        self.assertAlmostEqual(middle(piece) / middle(image), 1, delta=0.02)
        # A ball that hangs between there and the key light throws a shadow.
        ball = 'CoordSysTransform "camera"\nTranslate -0.953 1.335 1.856\nShape "sphere" "float radius" 0.3\n'
        with_ball, warnings = self.seen("--spp", "256", scene=dark + ball)
        self.assertIn("the outermost (1 of 2 shapes)", warnings[-1])
        self.assertLess(middle(with_ball), 0.7 * middle(image))
        # A pane before the camera shows the wall, and no sky.
        pane = 'Material "thindielectric"\nCoordSysTransform "camera"\nTranslate 0 0 1\nShape "disk" "float radius" 0.15\n'
        through, warnings = self.seen("--spp", "256", "--max-depth", "2", scene=dark + pane)
        self.assertIn("the outermost (1 of 2 shapes)", warnings[-1])
        self.assertAlmostEqual(middle(through) / middle(image), 0.96, delta=0.04)
        # An environment comes in as the light does whose place it takes; a lamp needs none of it, nor a file that has a light.
        image, warnings = self.seen("--spp", "64", "--environment", "0.8", scene=dark)
        self.assertIn("the outermost (1 of 1 shapes)", warnings[-1])
        for value in image["G"]:
            self.assertAlmostEqual(value, 0.8 * REFLECTANCE, delta=0.02)
        for arguments, scene in ((("--environment", "0.8", "--light", "camera power 0.001"), dark), (("--environment", "0.8"), ROOM),
                                 (("--environment", "0"), dark)):
            image, warnings = self.seen(*arguments, scene=scene)
            self.assertLess(max(image["G"]), 0.01)
            self.assertNotIn("outermost", "".join(warnings))
        # Outside, and where half of the room is open, the light that stands in is enough.
        for open_scene in (dark.replace("0 0 0  1 0.3 1", "0 0 9  0 0 0"), dark.replace('"float radius" 3', '"float radius" 3 "float zmax" 0')):
            _, warnings = self.seen(scene=open_scene)
            self.assertIn("no lights", "".join(warnings))
            self.assertNotIn("walls", "".join(warnings))

    def test_rooms_in_houses_get_a_lamp(self):
        dark = ROOM.replace('LightSource "infinite"\n', "") + 'Shape "sphere" "float radius" 9\n'
        image, warnings = self.seen(scene=dark)
        self.assertAlmostEqual(self.mean(image["G"]), 0.6 * REFLECTANCE, delta=0.01)
        self.assertRegex(warnings[-1], "walls keep the sky and the key light from most of what is seen; a lamp at the camera")
        told = re.search('option light.*"(.*)"', warnings[-1])[1]
        again, _ = self.seen("--light", told, scene=dark)
        self.assertAlmostEqual(self.mean(again["G"]), self.mean(image["G"]), delta=0.003)

    def test_a_camera_on_a_wall_sees_the_room(self):
        self.write("room.gltf", glowing_room(0))
        arguments = ["render", "room.gltf", "-o", "out.exr", "--resolution", "24x24", "--spp", "4", "--progress", "none", "--camera"]
        for z, least in ((0, 0.3), (1, 0.1)):
            result = self.run_program(*arguments, f"eye 0,0,{z} target 0,0,-9 fov 60")
            self.assertIn("walls keep", result.stderr)
            self.assertGreater(self.mean(exr.read(self.folder / "out.exr").pixels["G"]), least)

    def test_frames_of_dark_rooms_are_lit_through_the_walls(self):
        self.write("room.gltf", glowing_room(0))
        result = self.run_program("render", "room.gltf", "-o", "out.exr", "--resolution", "24x24", "--spp", "4", "--progress", "none",
                                  "--frames", "0-1")
        self.assertEqual(result.code, DONE, result)
        self.assertIn("the outermost (1 of 1 shapes) let it in", result.stderr)
        for frame in (0, 1):
            self.assertGreater(self.mean(exr.read(self.folder / f"out.000{frame}.exr").pixels["G"]), 0.1)

    def test_the_camera_gets_none_in_a_medium(self):
        # The light that a medium sends to an eye beside a lamp is infinite.
        fog = 'MakeNamedMedium "fog" "string type" "homogeneous" "float scale" 0.1\nMediumInterface "" "fog"\nCamera'
        image, warnings = self.seen(scene=ROOM.replace('LightSource "infinite"\n', "").replace("Camera", fog, 1).replace('"path"', '"volpath"'))
        self.assertEqual(max(image["G"]), 0)
        self.assertNotIn("walls", "".join(warnings))
        self.assertIn("100 % of the surfaces in view are black", warnings[-1])

    def test_light_that_walls_let_pass_is_no_darkness(self):
        dark = ROOM.replace('LightSource "infinite"\n', "")
        ball = 'Material "diffuse"\nTranslate 1.5 0.45 1.5\nShape "sphere" "float radius" 0.9\n'
        mix = ('MakeNamedMaterial "wall" "string type" "diffuse"\nMakeNamedMaterial "glass" "string type" "dielectric"\n'
               'Material "mix" "string materials" ["wall" "glass"] "float amount" ')
        cloth = 'Material "diffusetransmission" "rgb transmittance" '
        for wall, is_dark in (('Material "dielectric"', False), (mix + "0.9", False), (mix + "0.1", True),
                              (cloth + "[.6 .6 .6]", False), (cloth + "[.1 .1 .1]", True)):
            _, warnings = self.seen(scene=re.sub('Material "diffuse" .*', wall, dark) + ball)
            self.assertEqual("walls" in "".join(warnings), is_dark, wall)
        for alpha, is_dark in ((0.1, False), (0.99, True)):
            _, warnings = self.seen(scene=dark.replace('"float radius" 3', f'"float radius" 3 "float alpha" {alpha}') + ball)
            self.assertEqual("walls" in "".join(warnings), is_dark, alpha)

    def test_rooms_that_glow_are_not_dark(self):
        for emission, is_dark in ((0.8, False), (0.01, True)):
            self.write("room.gltf", glowing_room(emission))
            result = self.run_program("render", "room.gltf", "-o", "out.exr", "--resolution", "24x24", "--spp", "1", "--progress", "none")
            self.assertEqual(result.code, DONE, result)
            told = "".join(text for _, text in warnings_of(result))
            self.assertIn("no lights", told)
            self.assertEqual("walls" in told, is_dark, emission)

    def test_lamps_that_leave_the_view_dark_get_the_light_that_stands_in(self):
        arguments = ["render", "lamp.gltf", "-o", "out.exr", "--resolution", "16x16", "--spp", "16", "--progress", "none",
                     "--camera", "eye 0,-1,0.5 target 0,0,0 fov 40"]
        # Above the floor the lamp lights it, below it nothing that is seen
        for height, others, is_told in ((2, [], False), (-1, [], True), (-1, ["--environment", "0"], False),
                                        (-1, ["--light", "0,0,1 power 9"], False), (-1, ["--frames", "0"], True)):
            self.write("lamp.gltf", lamp_and_floor(height))
            result = self.run_program(*arguments, *others)
            self.assertEqual(result.code, DONE, result)
            told = "".join(text for _, text in warnings_of(result))
            self.assertEqual("surfaces that glow, which leave most of what is seen dark" in told, is_told, (height, others))
            image = exr.read(self.folder / ("out.0000.exr" if "--frames" in others else "out.exr")).pixels
            if "--environment" in others:
                self.assertEqual(max(image["G"]), 0)
            else:
                self.assertGreater(self.mean(image["G"]), 0.05)

    def test_words_of_lamps_in_any_case(self):
        small, large = (self.seen("--light", text)[0] for text in ("camera power 3", "Camera Power 3"))
        self.assertEqual(small["G"], large["G"])

    def test_lamps_in_view_are_no_surfaces_that_light_reaches(self):
        # From below the lamp fills most of the view, and what is seen of the floor beside it is dark
        self.write("lamp.gltf", lamp_and_floor(-1))
        result = self.run_program("render", "lamp.gltf", "-o", "out.exr", "--resolution", "16x16", "--spp", "16", "--progress", "none",
                                  "--camera", "eye 1.5,0,-4 target 0.2,0,-0.5 fov 25")
        self.assertEqual(result.code, DONE, result)
        self.assertIn("surfaces that glow, which leave most of what is seen dark", "".join(text for _, text in warnings_of(result)))
        image = exr.read(self.folder / "out.exr").pixels["G"]
        self.assertGreater(sum(value > 4 for value in image), len(image) / 2)
        self.assertGreater(min(image), 0.01)

    def test_scenes_without_shapes_are_told(self):
        sky = ROOM.split("Material")[0]
        self.assertIn("the scene has no shapes", self.seen(scene=sky)[1][0])
        self.assertRegex(self.run_program("info", "scene.pbrt").stdout, r"(?m)^warning    the scene has no shapes")
        fog = sky.replace("Camera", 'MakeNamedMedium "fog" "string type" "homogeneous"\nMediumInterface "" "fog"\nCamera', 1).replace('"path"', '"volpath"')
        for seen in (ROOM, fog):
            self.assertNotIn("no shapes", "".join(self.seen(scene=seen)[1]))

    def test_films_know_them(self):
        arguments = ["--checkpoint", "a.film", "--light", "camera", "--spp", "2", "--quiet"]
        self.assertEqual(self.render(ROOM, *arguments).code, DONE)
        self.assertEqual(self.render(ROOM, *arguments, "--resume").code, DONE)
        for other in (["--light", "1,0,0"], ["--light", "0,0,0 power 2"]):
            self.assert_fails(self.render(ROOM, *arguments, *other, "--resume"), USAGE, "film of another render", "--light")

    def test_errors(self):
        for wrong in ("x", "1,2", "nan,0,0", "camera radius 1", "camera power", "camera power 0", "camera power 1 power 2", "0,0,0 radius -1",
                      "0,0,0 colour 1,2", "0,0,0 colour 0,0,0", "0,0,0 colour 0,0,1.2e-5", "0,0,0 power 1e-50", "0,0,0 size 1", "camera camera"):
            self.assert_fails(self.render(ROOM, f"--light={wrong}"), USAGE, "--light", "'camera' or '0,2.5,1'")

    def test_measure_takes_it(self):
        self.write("scene.pbrt", TINY)
        arguments = ["measure", "scene.pbrt", "--pixel", "12,10", "--samples", "4096", "--paths", "16", "--json"]
        self.assertNotEqual(self.run_program(*arguments).stdout, self.run_program(*arguments, "--light", "3,3,3 power 400").stdout)


if __name__ == "__main__":
    unittest.main()
