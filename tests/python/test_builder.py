"""Scenes of covtrace.SceneBuilder: they move, and scenes that it can't build are refused."""

import copy
import gc
import pathlib
import pickle
import tempfile
import unittest
import warnings

import numpy

import covtrace


class Builder(unittest.TestCase):
    def test_a_moving_mesh_is_blurred(self):
        def centre_spread(distance):
            scene = covtrace.SceneBuilder()
            scene.camera(eye=(0, 0, -5), target=(0, 0, 0), fov=40, resolution=(60, 20))
            end = numpy.eye(4)
            end[0, 3] = distance
            vertices = [[-0.3, -9, 0], [0.3, -9, 0], [0.3, 9, 0], [-0.3, 9, 0]]
            scene.mesh(vertices, numpy.array([[0, 1, 2], [0, 2, 3]]), emission=(1, 1, 1),
                       transform=numpy.eye(4), end_transform=end, two_sided=True)
            row = covtrace.render(scene, method="uniform", spp=64).rgb[:, :, 1].mean(axis=0)
            return (row > 0.02).sum() / 60

        # 40 degrees over the 20 rows: 2 * 5 * tan(20 degrees) units high, three times as wide.
        # The pixel filter adds up to its radius of 1.5 pixels on both sides.
        width = 3 * 10 * numpy.tan(numpy.radians(20))
        self.assertAlmostEqual(centre_spread(0.0), 0.6 / width + 1.5 / 60, delta=2.5 / 60)
        self.assertAlmostEqual(centre_spread(2.0), 2.6 / width + 1.5 / 60, delta=2.5 / 60)

    def test_one_number_is_a_grey_colour(self):
        def render(*colour):
            scene = covtrace.SceneBuilder()
            scene.camera(eye=(0, 0, -5), target=(0, 0, 0), fov=40, resolution=(16, 16))
            scene.light("infinite", L=colour[0])
            scene.material("ball", "diffuse", reflectance=colour[1])
            scene.shape("sphere", material="ball")
            scene.mesh([[-1, 1, 2], [1, 1, 2], [0, 2, 2]], [[0, 1, 2]], emission=colour[2])
            return covtrace.render(scene, method="uniform", spp=4).rgb

        numpy.testing.assert_array_equal(render(2, 0.5, 3.0), render((2, 2, 2), (0.5,) * 3, (3, 3, 3)))

    def broken(self, break_it):
        """A scene with a ball, broken by a function; returns the scene and the place of the breaking call."""
        scene = covtrace.SceneBuilder()
        scene.camera(eye=(0, 0, -5), target=(0, 0, 0), fov=40, resolution=(8, 8))
        scene.light("infinite", L=(1, 1, 1))
        scene.material("grey", "diffuse", reflectance=(0.5, 0.5, 0.5))
        scene.shape("sphere", material="grey")
        break_it(scene)
        scene.shape("disk", material="grey")
        return scene, f"{__file__}:{break_it.__code__.co_firstlineno}: SceneBuilder."

    def test_errors_name_the_call(self):
        triangle = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        for break_it, call in (
            (lambda s: s.material("red", "no-such-kind"), "material('red', 'no-such-kind'): "),
            (lambda s: s.shape("sphere", material="nobody"), "shape('sphere'): "),
            (lambda s: s.light("point", I=(1, 1, 1), **{"float scale": "x"}), "light('point'): "),
            (lambda s: s.mesh(triangle, [[0, 1, 2]], material="nobody"), "mesh(): "),
        ):
            scene, place = self.broken(break_it)
            with self.subTest(call), self.assertRaises(covtrace.SceneError) as caught:
                covtrace.render(scene, spp=1)
            self.assertTrue(str(caught.exception).startswith(place + call), caught.exception)
            self.assertEqual(caught.exception.file, __file__)
            self.assertEqual(caught.exception.line, break_it.__code__.co_firstlineno)
            self.assertNotIn("covtrace-", str(caught.exception))

    def test_warnings_name_the_call(self):
        scene, place = self.broken(lambda s: s.shape("sphere", material="grey", **{"float no-such": 1}))
        with self.assertWarns(covtrace.SceneWarning) as caught:
            covtrace.render(scene, spp=1)
        self.assertTrue(str(caught.warning).startswith(place + "shape('sphere'): "), caught.warning)
        self.assertEqual(caught.filename, __file__)
        dark = covtrace.SceneBuilder()
        dark.camera()
        dark.shape("sphere")
        with self.assertWarns(covtrace.SceneWarning) as caught:
            covtrace.render(dark, spp=1, resolution=(4, 4))
        self.assertTrue(str(caught.warning).startswith("SceneBuilder: the scene has no lights"), caught.warning)

    def test_earlier_definitions_are_named_by_their_calls(self):
        scene, place = self.broken(lambda s: [s.texture("t", numpy.ones((2, 2))) for _ in range(2)])
        with self.assertRaises(covtrace.SceneError) as caught:
            covtrace.render(scene, spp=1)
        call = place + "texture('t')"
        self.assertEqual(str(caught.exception), f'{call}: texture "t" is already defined at {call}')

    def test_another_camera_takes_the_place_of_the_first(self):
        def seen_from(*eyes):
            scene = covtrace.SceneBuilder()
            scene.light("infinite", L=(1, 1, 1))
            scene.shape("sphere")
            for eye in eyes:
                scene.camera(eye=eye, target=(0, 0.5, 0), resolution=(16, 8))
            return covtrace.render(scene, spp=2).rgb
        numpy.testing.assert_array_equal(seen_from((0, 0, -5), (3, 1, 4)), seen_from((3, 1, 4)))

    def test_scenes_of_builders_can_be_changed(self):
        builder = covtrace.SceneBuilder()
        builder.camera(eye=(0, 0, -2), target=(0, 0, 0), fov=40, resolution=(8, 8))
        builder.light("infinite", L=(1, 1, 1))
        builder.texture("grey", numpy.full((2, 2, 3), 0.25))
        builder.material("wall", "diffuse", **{"texture reflectance": "grey"})
        builder.shape("bilinearmesh", material="wall",
                      P=[[-9, -9, 0], [9, -9, 0], [-9, 9, 0], [9, 9, 0]])
        scene = covtrace.Scene(builder)
        numpy.testing.assert_array_equal(covtrace.render(scene, spp=4).rgb, covtrace.render(builder, spp=4).rgb)
        folder = pathlib.Path(scene._files.path)
        for other in (copy.copy(scene), copy.deepcopy(scene)):
            other.materials["wall"]["reflectance"] = 0.75
            self.assertAlmostEqual(covtrace.render(other, spp=4).rgb.mean(), 0.75, delta=1e-3)
        self.assertAlmostEqual(covtrace.render(scene, spp=4).rgb.mean(), 0.25, delta=1e-3)
        self.assertTrue(folder.is_dir())
        with self.assertRaisesRegex(TypeError, "cannot be pickled; another process gets the file's path"):
            pickle.dumps(scene)
        del scene, other
        gc.collect()
        self.assertFalse(folder.exists())
        broken, place = self.broken(lambda s: s.material("red", "no-such-kind"))
        with self.assertRaises(covtrace.SceneError) as caught:
            covtrace.Scene(broken)
        self.assertTrue(str(caught.exception).startswith(place), caught.exception)

    def test_parameters_types(self):
        scene = covtrace.SceneBuilder()
        scene.camera(eye=(0, 0, -2), target=(0, 0, 0), kind="orthographic", screenwindow=(-1, 1, -1, 1), resolution=(8, 8))
        scene.light("infinite", L=(1, 1, 1))
        for name, grey in (("dark", 0.2), ("bright", 0.6)):
            scene.material(name, "diffuse", reflectance=(grey, grey, grey))
        scene.material("both", "mix", materials=["dark", "bright"], amount=1)
        corners = [[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]]
        scene.shape("trianglemesh", material="both", P=corners, N=[[0, 0, 1]] * 4,
                    uv=numpy.zeros((4, 2)), indices=[[0, 1, 2], [0, 2, 3]])
        scene.shape("curve", P=[[0, 5, 0], [0, 6, 0], [0, 7, 0], [0, 8, 0]], type="ribbon", N=[[0, 0, 1]] * 2)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            image = covtrace.render(scene, spp=1, method="uniform")
        numpy.testing.assert_allclose(image.rgb, 0.6, atol=1e-5)

    def test_values_of_textures(self):
        scene = covtrace.SceneBuilder()
        for values, message in (
            ("brick.png", r"Image.read\('brick.png'\).rgb"),
            (numpy.full((2, 2, 3), 128, numpy.uint8), "uint8 and numbers up to 128; expected linear values"),
            ([[0.5, float("nan")]], "not finite"),
            (numpy.ones((2, 2, 2)), "shape"),
            (numpy.ones((0, 2)), "shape"),
        ):
            with self.subTest(message), self.assertRaisesRegex(covtrace.UsageError, message):
                scene.texture("t", values)
        scene.texture("mask", numpy.eye(2, dtype=numpy.uint8))

    def test_end_transforms_hold_at_the_shutters_end(self):
        def columns(shutter):
            scene = covtrace.SceneBuilder()
            scene.camera(eye=(0, 0, -4), target=(0, 0, 0), fov=60, resolution=(64, 16),
                         shutter=shutter)
            scene.integrator(3, 256)
            start, end = numpy.eye(4), numpy.eye(4)
            start[0, 3], end[0, 3] = -1.5, 1.5
            quad = [[-.1, -.5, 0], [.1, -.5, 0], [.1, .5, 0], [-.1, .5, 0]]
            scene.mesh(quad, [[0, 1, 2], [0, 2, 3]], emission=(1, 1, 1), two_sided=True,
                       transform=start, end_transform=end)
            row = covtrace.render(scene, method="uniform", threads=1).rgb[8, :, 0]
            return numpy.count_nonzero(row > 1e-3)
        expected = columns((0, 1))
        self.assertGreater(expected, 8)  # at rest it lights three
        for shutter in ((2, 3), (0, 0.25), (-1, 0)):
            self.assertLessEqual(abs(columns(shutter) - expected), 2, shutter)

    def test_resolutions_may_be_texts(self):
        builder = covtrace.SceneBuilder()
        for text in ("12x8", "12X8"):
            builder.camera(resolution=text)
            self.assertEqual(covtrace.Scene(builder).resolution, (12, 8))
        for wrong in ("12", 12, (1, 2, 3), (1.5, 2), ("12", "8"), (numpy.nan, 8), (numpy.inf, 8)):
            with self.subTest(wrong), self.assertRaisesRegex(covtrace.UsageError, r"resolution is .*; expected \(width, height\)"):
                builder.camera(resolution=wrong)

    def test_methods_of_other_libraries_tell_what_is_meant(self):
        for name, told in (("add_sphere", r"shape\('sphere'"), ("render", r"covtrace\.render"), ("frobnicate", "attribute 'frobnicate'$")):
            with self.subTest(name), self.assertRaisesRegex(AttributeError, told):
                getattr(covtrace.SceneBuilder(), name)

    def test_integers_are_integers(self):
        scene = covtrace.SceneBuilder()
        scene.camera(resolution=(8, 8))
        scene.shape("curve", degree=2, **{"point3 P": [[0, 0, 1], [0, 1, 1], [0, 2, 1]]})
        covtrace.render(scene, spp=1, threads=1)

    def test_cameras_of_all_kinds_take_their_parameters_by_value(self):
        for values in ({"lensradius": 0.1, "apertureblades": 5, "aperturerotation": 9, "apertureratio": 2},
                       {"kind": "spherical", "mapping": "equirectangular", "longitude": (60, 120), "latitude": (-30, 30)},
                       {"kind": "spherical", "mapping": "equisolid", "fov": 220, "screenwindow": (-2, 2, -1, 1)}):
            scene = covtrace.SceneBuilder()
            scene.camera(resolution=(8, 8), **values)
            scene.light("infinite", L=1)
            with self.subTest(values), warnings.catch_warnings():
                warnings.simplefilter("error")
                covtrace.Scene(scene)
        for name, value in (("eye", "spherical"), ("target", (0, 1)), ("up", None), ("shutter", (0, 1, 2))):
            with self.subTest(name), self.assertRaisesRegex(covtrace.UsageError, f"^{name} is .*; expected \\("):
                scene.camera(**{name: value})

    def test_wrong_arrays(self):
        scene = covtrace.SceneBuilder()
        good = numpy.array([[0, 1, 2]])
        for vertices, triangles in (([[0, 0]], good), (numpy.zeros((3, 3)), good + 1),
                                    (numpy.zeros((3, 3)), good - 1),
                                    (numpy.zeros((3, 3)), good * 1.0)):
            with self.assertRaises(ValueError):
                scene.mesh(vertices, triangles)
        with self.assertRaises(ValueError):
            scene.mesh(numpy.zeros((3, 3)), good, uv=numpy.zeros((2, 2)))
        with self.assertRaises(ValueError):
            scene.material('x" "float roughness" 3', "diffuse")
        for values in (1.0, numpy.zeros(9), numpy.zeros((2, 2, 3, 1))):
            with self.subTest(values=values), self.assertRaisesRegex(ValueError, "shape"):
                scene.texture("t", values)
        with self.assertRaises(ValueError):
            scene.text()  # no camera

    def test_what_the_scene_reads_is_not_written_over(self):
        scene = covtrace.SceneBuilder()
        scene.camera(eye=(0, 0, -5), target=(0, 0, 0), resolution=(4, 4))
        scene.texture("own", numpy.ones((2, 2)))
        scene.light("infinite", filename="sky.exr")
        with tempfile.TemporaryDirectory() as folder:
            sky = pathlib.Path(folder, "sky.exr")
            covtrace.Image.from_arrays(numpy.ones((2, 2, 3))).write(sky)
            before = sky.read_bytes()
            for name in ("sky.exr", "./sky.exr", str(sky)):
                with self.subTest(name=name), self.assertRaisesRegex(covtrace.UsageError, "sky.exr"):
                    scene.write(folder, name)
            pathlib.Path(folder, "texture-0.exr").symlink_to("sky.exr")
            with self.assertRaisesRegex(covtrace.UsageError, "texture-0.exr.*sky.exr"):
                scene.write(folder)
            pathlib.Path(folder, "texture-0.exr").unlink()
            self.assertEqual(sky.read_bytes(), before)
            with self.assertRaisesRegex(covtrace.UsageError, "texture-0.exr"):
                scene.write(folder, "./texture-0.exr")
            for _ in range(2):  # over its own files
                scene.write(folder)
            scene.light("infinite", filename="texture-0.exr")
            with self.assertRaisesRegex(covtrace.UsageError, "texture-0.exr"):
                scene.write(folder)


if __name__ == "__main__":
    unittest.main()
