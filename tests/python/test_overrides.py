"""Keywords of covtrace.render by which something else takes the place of the scene's camera and light, or that change nothing."""

import json
import pathlib
import tempfile
import unittest
import warnings

import numpy

import covtrace
import scenes


class Overrides(unittest.TestCase):
    def test_texts_for_time_and_resolution(self):
        scene = covtrace.Scene.from_string(scenes.LIT)
        image = covtrace.render(scene, method="uniform", spp=1e9, time="0.3s", resolution="12x8")
        self.assertEqual(image.size, (12, 8))
        self.assertLess(image.statistics["seconds_total"], 30)
        image = covtrace.render(scene, method="uniform", spp=1, time="1M30S", resolution="12X8", texture_memory="2GiB")  # as the program
        self.assertEqual(image.size, (12, 8))
        for wrong in ({"time": "3x"}, {"time": ""}, {"time": "1h30"}, {"time": "-1s"}, {"time": "0s"}, {"resolution": "12"},
                      {"resolution": "12x"}, {"resolution": "0x4"}, {"resolution": "-3x4"}):
            with self.subTest(wrong), self.assertRaises(covtrace.UsageError):
                covtrace.render(scene, **wrong)

    def test_environment(self):
        scene = covtrace.Scene.from_string(scenes.SKY)

        def mean(**arguments):
            return covtrace.render(scene, method="uniform", spp=1, **arguments).rgb.mean((0, 1))

        numpy.testing.assert_allclose(mean(), 3, rtol=1e-4)
        numpy.testing.assert_allclose(mean(environment=0.5), 0.5, rtol=1e-4)
        numpy.testing.assert_allclose(mean(environment="0.5"), 0.5, rtol=1e-4)
        numpy.testing.assert_allclose(mean(environment="1,2,4"), (1, 2, 4), rtol=1e-4)
        numpy.testing.assert_allclose(mean(environment=(1, 2, 4), environment_scale=2), (2, 4, 8), rtol=1e-4)
        numpy.testing.assert_allclose(mean(environment_scale=0.5, environment_rotation=90), 1.5, rtol=1e-4)
        with tempfile.TemporaryDirectory() as folder:
            sky = pathlib.Path(folder) / "sky.exr"
            covtrace.Image.from_arrays(numpy.full((4, 8, 3), 7.0)).write(sky)
            numpy.testing.assert_allclose(mean(environment=sky), 7, rtol=1e-4)
            numpy.testing.assert_allclose(mean(environment=str(sky), environment_rotation=-30), 7, rtol=1e-4)

    def test_lamps(self):
        room = covtrace.Scene.from_string("""LookAt 0 0 0  1 0.3 1  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 16 "integer yresolution" 8
Integrator "path" "integer maxdepth" 1
WorldBegin
LightSource "infinite"
Shape "sphere" "float radius" 3
""")

        def mean(light):
            return covtrace.render(room, method="uniform", spp=4, light=light).rgb.mean((0, 1))

        with self.assertWarnsRegex(covtrace.SceneWarning, 'the camera sees nothing.* by camera="eye '):
            covtrace.render(room, method="uniform", spp=1, environment=0, camera="eye 0,0,9 target 0,0,99 fov 40")
        with self.assertWarnsRegex(covtrace.SceneWarning, '100 % of the surfaces in view are black.*light="camera"'):
            self.assertEqual(mean(None).max(), 0)
        direct = 0.5 / numpy.pi / (4 * numpy.pi * 9)
        # Few samples choose the sky, which does not get there.
        numpy.testing.assert_allclose(mean("0,0,0 power 200"), 200 * direct, rtol=0.02)
        numpy.testing.assert_allclose(mean(["0,0,0 power 200", "0,0,0 power 100 radius 0.5"]), 300 * direct, rtol=0.02)
        red, green, _ = mean("0,0,0 colour 1,0.5,0 power 9")
        numpy.testing.assert_allclose(green / red, 0.5, rtol=1e-3)
        with self.assertWarnsRegex(covtrace.SceneWarning, '"0,0,0 power '):
            numpy.testing.assert_allclose(mean("camera"), 0.3, rtol=0.02)

    def test_preset(self):
        scene = covtrace.Scene.from_string(scenes.SKY)
        self.assertEqual(covtrace.render(scene, preset="draft").statistics["spp"], 4)
        self.assertEqual(covtrace.render(scene, preset="final", spp=2).statistics["spp"], 2)
        with self.assertRaises(covtrace.UsageError):
            covtrace.render(scene, preset="best")

    def test_camera(self):
        scene = covtrace.Scene.from_string(scenes.SKY)

        def sees_ball(text=None, **camera):
            image = covtrace.render(scene, method="uniform", spp=1, camera=text or camera, max_depth=0)
            return bool((image["Z"][2:4, 3:5] > 1).all())  # 0 is the sky

        self.assertTrue(sees_ball(eye=(0, 0, 0), target=(0, 0, -9), fov=10))
        self.assertFalse(sees_ball(eye=(0, 0, 0), target=(0, 0, 9), fov=10))
        self.assertTrue(sees_ball(eye=(0, 9, -9), target=(0, 0, -9), fov=10, up=(1, 0, 0)))
        self.assertTrue(sees_ball("eye 0,9,-9 target 0,0,-9 fov 1e1 up 1,0,0"))
        self.assertFalse(sees_ball("eye 0,0,0 target 0,0,9 fov 10"))

    def test_the_view_that_a_summary_tells(self):
        """The line of `view` is what `camera` takes, and shows the same picture."""
        scene = covtrace.Scene.from_string(scenes.SKY)
        self.assertRegex(scene.summary(), r"\nextent +x \S+ to \S+, y \S+ to \S+, z \S+ to \S+\n")
        view = next(line.split(None, 1)[1] for line in scene.summary().splitlines() if line.startswith("view"))
        one, other = (covtrace.render(scene, method="uniform", spp=1, camera=camera) for camera in (None, view))
        numpy.testing.assert_allclose(other["Z"], one["Z"], atol=1e-3)

    def test_choices_of_gltf_files(self):
        file = json.loads(scenes.gltf())
        [seen] = [n for n, node in enumerate(file["nodes"]) if "camera" in node]
        away = len(file["nodes"])
        file["nodes"].append({**file["nodes"][seen], "name": "Away", "translation": [90, 0, 5]})
        file["scenes"] = [{"name": "All", "nodes": list(range(away + 1))}, {"name": "Empty view", "nodes": [0, away]}]
        file["nodes"][seen]["name"] = "Seen"
        file["animations"][0]["name"] = "Slide"
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "two.gltf"
            path.write_text(json.dumps(file))

            def sees(what, **arguments):
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    return bool(covtrace.render(what, method="uniform", spp=1, resolution=(16, 16), environment=0,
                                                **arguments).rgb.max() > 1)

            self.assertTrue(sees(path))
            self.assertTrue(sees(path, camera="Seen", gltf_scene="All", animation="Slide"))
            self.assertTrue(sees(path, camera=0, gltf_scene=0, animation="none"))
            for unseen in ({"camera": "Away"}, {"camera": 1}, {"gltf_scene": "Empty view"}, {"gltf_scene": 1}):
                self.assertFalse(sees(path, **unseen), unseen)
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    scene = covtrace.Scene(path, **unseen)
                self.assertFalse(sees(scene), unseen)
                with self.assertRaisesRegex(covtrace.UsageError, "when the file is read"):
                    sees(scene, **unseen)
            with self.assertWarnsRegex(covtrace.SceneWarning, 'the others are 1 "Away"'):
                covtrace.Scene(path)
            with self.assertRaisesRegex(covtrace.UsageError, 'camera: there is no camera "Awry"; .* did you mean "Away"'):
                covtrace.Scene(path, camera="Awry")
            with self.assertRaisesRegex(covtrace.UsageError, 'gltf_scene: there is no scene "2"'):
                covtrace.Scene(path, gltf_scene=2)
            for wrong in (True, -1, "", 1.5, b"Away"):
                for name in ("camera", "gltf_scene", "animation", "variant"):
                    with self.assertRaisesRegex(covtrace.UsageError, name):
                        covtrace.Scene(path, **{name: wrong})
            pbrt = pathlib.Path(folder) / "sky.pbrt"
            pbrt.write_text(scenes.SKY)
            with self.assertRaisesRegex(covtrace.UsageError, "pbrt files have one"):
                covtrace.Scene(pbrt, camera="Seen")

    def test_errors(self):
        scene = covtrace.Scene.from_string(scenes.SKY)
        for wrong in (
                {"camera": "eye"}, {"camera": "eye 0,0,1 target 0,0 fov 40"}, {"camera": "eye 0,0,1 fov 40"},
                {"camera": "eye 0,0,1 target 0,0,0 fov 40 fov 40"}, {"camera": "eye 0,0,1 target 0,0,0 fov wide"},
                {"camera": {"eye": (0, 0, 1), "fov": 40}},
                {"camera": {"eye": (0, 0, 1), "target": (0, 0, 1), "fov": 40}},
                {"camera": {"eye": (0, 0, 1), "target": (0, 0, 0), "fov": 180}},
                {"camera": {"eye": (0, 0, 1), "target": (0, 0, 0), "fov": float("nan")}},
                {"camera": {"eye": (0, 0, 1), "target": (0, 0, 0), "fov": 40, "up": (0, 0, 1)}},
                {"camera": {"eye": (0, 0, 1), "target": (0, 0), "fov": 40}},
                {"camera": {"eye": (0, 0, 1), "target": (0, 0, 0), "fov": 40, "roll": 1}},
                {"environment": "no/such.exr"}, {"environment": "1,2"}, {"environment": "-1"}, {"environment": -1}, {"environment": (1, 2)},
                {"environment": (1, 2, -3)}, {"environment": float("nan")},
                {"environment_rotation": "much"}, {"environment_rotation": float("inf")},
                {"environment_scale": 0}, {"environment_scale": "x"},
                {"light": "x"}, {"light": ""}, {"light": 1}, {"light": "camera radius 1"}, {"light": "camera power 0"},
                {"light": "1,2"}, {"light": ["camera", "0,0,0 colour 0,0,0"]}, {"light": "camera power 1 power 2"}, {"light": "0,0,0 power 1e-50"}, {"light": "0,0,0 colour 0,0,1.2e-5"}, {"light": [None]}):
            with self.subTest(wrong), self.assertRaises(covtrace.UsageError):
                covtrace.render(scene, **wrong)


    def test_what_is_wrong_is_told_in_a_line(self):
        with self.assertRaises(covtrace.UsageError) as raised:
            covtrace.render(covtrace.Scene.from_string(scenes.LIT), environment=numpy.ones((8, 16, 3)))
        self.assertRegex(str(raised.exception), r"\Aenvironment is array\(\[\[\[1\., 1\., 1\.\],[^\n]{0,120}…; expected an image's path[^\n]*\Z")

    def test_cameras_tell_what_they_lack(self):
        scene = covtrace.Scene.from_string(scenes.FURNACE)
        for camera, lacking in (("eye 0,0,9 target 0,0,0", "'fov'"), ({"eye": (0, 0, 9)}, "'target' and 'fov'")):
            with self.subTest(camera), self.assertRaisesRegex(covtrace.UsageError, f"expected {lacking}, too: "):
                covtrace.render(scene, camera=camera)

    def test_words_of_lamps_in_any_case(self):
        scene = covtrace.Scene.from_string(scenes.LIT)
        small, large = (covtrace.render(scene, spp=1, denoiser="none", light=light) for light in ("camera power 3", "Camera Power 3"))
        numpy.testing.assert_array_equal(small.rgb, large.rgb)

    def test_names_of_other_programs(self):
        scene = covtrace.Scene.from_string(scenes.FURNACE)
        for wrong, meant in (("samples", "did you mean 'spp'"), ("resolutoin", "did you mean 'resolution'"), ("res", "did you mean 'resolution'"),
                             ("fov", "did you mean 'camera'"),
                             ("png", r"image\.write\('picture\.png'"), ("frames", "shutter="), ("qqq", r"help\(covtrace\.render\)")):
            for call in (covtrace.render, covtrace.start):
                with self.subTest(wrong), self.assertRaisesRegex(TypeError, f"^{call.__name__}.. has no argument '{wrong}'; .*{meant}"):
                    call(scene, **{wrong: 4})
        with self.assertRaisesRegex(covtrace.UsageError, r"light is \(0, 1, 2\); expected 'camera' or '0,2\.5,1'"):
            covtrace.render(scene, light=(0, 1, 2))


class Idle(unittest.TestCase):
    def test_an_option_that_changes_nothing_is_told(self):
        for name, value in (("even_counts", True), ("progressive", True), ("cov_spp", 1), ("density", "thesis")):
            with self.subTest(name), self.assertWarnsRegex(covtrace.SceneWarning, f"--{name.replace('_', '-')} changes nothing"):
                covtrace.render(covtrace.Scene.from_string(scenes.LIT), method="uniform", spp=1, **{name: value})


if __name__ == "__main__":
    unittest.main()
