"""covtrace.Image and covtrace.compare: files, arrays, layers, measures."""

import copy
import json
import pathlib
import pickle
import tempfile
import unittest

import numpy

import covtrace
import scenes


OCIO_CONFIG = (pathlib.Path(__file__).parents[1] / "ocio" / "config.ocio").read_text()


class Images(unittest.TestCase):
    def test_pictures_have_exposure_and_view(self):
        image = covtrace.Image.from_arrays(numpy.full((2, 2, 3), 0.25))

        def shown(**arguments):
            with tempfile.TemporaryDirectory() as folder:
                image.write(pathlib.Path(folder) / "a.png", **arguments)
                return covtrace.Image.read(pathlib.Path(folder) / "a.png").rgb[0, 0, 0]

        self.assertAlmostEqual(shown(), 0.25, delta=0.003)
        self.assertAlmostEqual(shown(exposure=1), 0.5, delta=0.004)
        self.assertAlmostEqual(shown(exposure=-1, view="srgb"), 0.125, delta=0.002)
        self.assertNotAlmostEqual(shown(view="agx"), shown(view="filmic"), delta=0.01)
        for wrong in ({"view": "raw"}, {"view": 3}, {"exposure": "x"}, {"exposure": None}, {"exposure": float("nan")}):
            with self.subTest(wrong), self.assertRaises(covtrace.UsageError):
                shown(**wrong)

    def test_names_of_other_libraries_are_known_or_tell_what_is_meant(self):
        image = covtrace.Image.from_arrays(numpy.zeros((3, 2, 3)), {"Z": numpy.ones((3, 2))})
        self.assertEqual((image.width, image.height, image.shape), (2, 3, image.rgb.shape))
        for name, told in (("save", r"write\('picture.png'\)"), ("show", "notebook"), ("Z", r"items, such as \['Z'\]"),
                           ("mean", "rgb is its array"), ("to_pil", "linear and float32"), ("psnr", r"covtrace\.compare"),
                           ("frobnicate", "Image has no attribute 'frobnicate'$")):
            with self.subTest(name), self.assertRaisesRegex(AttributeError, told):
                getattr(image, name)
        with self.assertRaisesRegex(AttributeError, "^Image has no attribute 'exposure' to set; .*exposure=1"):
            image.exposure = 1  # it was set and changed no picture
        with self.assertRaisesRegex(AttributeError, r"^rgb of Image cannot be set; image\.rgb\[:\] = values"):
            image.rgb = image.rgb * 2
        with self.assertRaisesRegex(TypeError, r"Image\.read\(file\)"):
            covtrace.Image("image.exr")

    def test_names_of_the_module_tell_what_is_meant(self):
        for name, told in (("load", r"Scene\(file\) .*Image\.read\(file\)"), ("imread", r"Image\.read\(file\)"),
                           ("frobnicate", "module 'covtrace' has no attribute 'frobnicate'$")):
            with self.subTest(name), self.assertRaisesRegex(AttributeError, told):
                getattr(covtrace, name)

    def test_images_may_be_derived_from(self):
        class Named(covtrace.Image):
            title: str

        image = Named(covtrace.Image.from_arrays(numpy.zeros((3, 2, 3)))._planes)
        image.title = "black"
        self.assertEqual((image.title, image.shape, image.complete), ("black", (3, 2, 3), True))
        with self.assertRaisesRegex(AttributeError, "no attribute 'name' to set"):
            image.name = "black"

    def test_pictures_by_an_opencolorio_config(self):
        image = covtrace.Image.from_arrays(numpy.full((2, 2, 3), (0.4, 0.2, 0.1)))
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            config = folder / "config.ocio"
            config.write_text(OCIO_CONFIG)

            def shown(**arguments):
                image.write(folder / "a.png", **{"ocio_config": config, **arguments})
                return covtrace.Image.read(folder / "a.png").rgb[0, 0]

            def decoded(values):
                """Display values as the reader decodes them, as sRGB."""
                values = numpy.array(values)
                return numpy.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)

            def crossed(r, g, b):
                return decoded(numpy.power((0.75 * r + 0.25 * g, 0.125 * r + 0.75 * g + 0.125 * b, 0.5 * g + 0.5 * b), 1 / 2.4))

            numpy.testing.assert_allclose(shown(), crossed(0.4, 0.2, 0.1), atol=0.006)
            numpy.testing.assert_allclose(shown(exposure=1), crossed(0.8, 0.4, 0.2), atol=0.006)
            numpy.testing.assert_allclose(shown(view="Untouched"), decoded((0.4, 0.2, 0.1)), atol=0.004)
            numpy.testing.assert_allclose(shown(view="Warm", ocio_display="Screen", ocio_look="dim - half"), crossed(0.2, 0.1, 0.05), atol=0.006)
            numpy.testing.assert_allclose(shown(ocio_source="dark", exposure=-2), crossed(0.4, 0.2, 0.1), atol=0.006)
            for wrong, names in (({"view": "agx"}, "'Crossed', 'Warm', 'Untouched'"), ({"ocio_display": "Wall"}, "'Screen', 'Projector'"),
                                 ({"ocio_look": "cold"}, "'warm', 'dim - half'"), ({"ocio_source": "log"}, "'linear', 'untouched', 'crossed', 'dark'"),
                                 ({"ocio_config": None, "ocio_look": "warm"}, "ocio_look"), ({"ocio_config": 3}, "ocio_config"),
                                 ({"view": 3}, "view"), ({"view": ""}, "view"), ({"ocio_look": ""}, "ocio_look"),
                                 ({"ocio_config": ""}, "ocio_config"), ({"ocio_config": None, "view": ""}, "view")):
                with self.subTest(wrong), self.assertRaisesRegex(covtrace.UsageError, names):
                    shown(**wrong)
            with self.assertRaisesRegex(covtrace.SceneError, "cannot open"):
                shown(ocio_config=folder / "none.ocio")
            config.write_text(OCIO_CONFIG.replace("slope: [1.5", "tilt: [1.5"))
            with self.assertWarnsRegex(covtrace.SceneWarning, "config.ocio:17: .*unknown key 'tilt'"):
                shown()
            config.write_text("hello")
            with self.assertRaisesRegex(covtrace.SceneError, "config.ocio:1:1: "):
                shown()

    def image(self):
        rng = numpy.random.default_rng(2)
        return covtrace.Image.from_arrays(rng.random((5, 7, 3)), {"N": {c: rng.random((5, 7)) for c in "XYZ"}, "Z": rng.random((5, 7))},
                                          {"note": "hello"})

    def test_layers_as_of_a_dictionary(self):
        image = self.image()
        self.assertEqual(list(image), ["", "Z", "N"])
        self.assertEqual((list(image.keys()), len(image)), (list(image), 3))
        for name, values in image.items():
            numpy.testing.assert_array_equal(values, image[name])
        self.assertEqual([v.shape for v in image.values()], [(5, 7, 3), (5, 7), (5, 7, 3)])

    def test_layers_tell_what_is_meant(self):
        for name, told in (("normal", "'N' has normals"), ("rgb", "image.rgb"), ((0, 0), r"image\.rgb\[y, x\]"), ("hue", "'', 'Z', 'N'\"$")):
            with self.subTest(name), self.assertRaisesRegex(KeyError, told):
                self.image()[name]

    def test_arrays(self):
        image = self.image()
        view = numpy.asarray(image)
        self.assertTrue(numpy.shares_memory(view, image.rgb))
        self.assertEqual((view.shape, view.dtype), ((5, 7, 3), numpy.float32))
        self.assertFalse(numpy.shares_memory(numpy.array(image), image.rgb))
        self.assertEqual(numpy.asarray(image, dtype=float).dtype, float)
        numpy.testing.assert_allclose(numpy.clip(image, 0.2, 0.4), image.rgb.clip(0.2, 0.4))

    def test_pickles_and_copies(self):
        text = scenes.LIT
        rendered = covtrace.render(covtrace.Scene.from_string(text), spp=1, resolution=(16, 12), crop=(4, 2, 10, 9))
        for image in (self.image(), rendered):
            for again in (pickle.loads(pickle.dumps(image)), copy.copy(image), copy.deepcopy(image)):
                self.assertEqual(list(again.channels), list(image.channels))
                for name, values in image.channels.items():
                    numpy.testing.assert_array_equal(again.channels[name], values)
                    self.assertFalse(numpy.shares_memory(again.channels[name], values))
                for what in ("metadata", "complete", "statistics", "data_window", "display_window"):
                    self.assertEqual(getattr(again, what), getattr(image, what))
        self.assertEqual(rendered.data_window, (4, 2, 10, 9))

    def test_notebooks_show_the_picture(self):
        image = self.image()
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.png"
            file.write_bytes(image._repr_png_())
            shown = covtrace.Image.read(file).rgb
        numpy.testing.assert_allclose(shown, image.rgb, atol=0.005)

    def test_round_trip(self):
        rng = numpy.random.default_rng(1)
        rgb = rng.random((5, 7, 3), dtype=numpy.float32)
        normal = {c: rng.random((5, 7)) for c in "XYZ"}
        image = covtrace.Image.from_arrays(rgb, {"N": normal, "Z": rng.random((5, 7))},
                                           {"note": "hello"})
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.exr"
            image.write(file)
            again = covtrace.Image.read(file)
            image.write(pathlib.Path(folder) / "a.png")
            self.assertEqual(covtrace.Image.read(pathlib.Path(folder) / "a.png").size, (7, 5))
        numpy.testing.assert_array_equal(again.rgb, rgb)
        numpy.testing.assert_array_equal(again["N.Y"], normal["Y"].astype(numpy.float32))
        self.assertEqual(again["N"].shape, (5, 7, 3))
        self.assertEqual(again.metadata["note"], "hello")
        self.assertTrue(covtrace.compare(image, again).identical)
        self.assertIn("N", again)
        self.assertNotIn("M", again)
        with self.assertRaises(KeyError):
            again["M"]

    def test_root_channels_around_depth(self):
        # Files sort their channels by name: B, G, R, Z, id.
        shape = (2, 3)
        given = {name: numpy.full(shape, i, dtype=numpy.float32)
                 for i, name in enumerate(("B", "G", "R", "Z", "id"))}
        image = covtrace.Image.from_arrays(layers=given)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.exr"
            image.write(file)
            for one in (image, covtrace.Image.read(file)):
                numpy.testing.assert_array_equal(one.rgb[0, 0], [2, 1, 0])
                self.assertEqual(one["Z"][0, 0], 3)
                self.assertEqual(one["id"][0, 0], 4)

    def test_compare(self):
        reference = numpy.full((8, 8, 3), 0.5)
        c = covtrace.compare(1.1 * reference, reference)
        self.assertAlmostEqual(c.mse, 0.0025, places=6)
        self.assertAlmostEqual(c.relmse, 0.0025 / 0.26, places=6)
        self.assertAlmostEqual(c.relmse_median, 0.0025 / 0.2525, places=6)
        numpy.testing.assert_allclose(c.mean_ratio, 1.1, rtol=1e-6)
        numpy.testing.assert_allclose(c.decile_ratio, [numpy.nan] * 9 + [1.1], rtol=1e-6)
        self.assertEqual(c.flip_map.shape, (8, 8))
        self.assertFalse(c.identical)
        with self.assertRaises(covtrace.UsageError):
            covtrace.compare(reference, numpy.zeros((4, 4, 3)))

    def test_compare_sees_what_is_dark(self):
        reference = numpy.ones((16, 80, 3)) * numpy.repeat(numpy.geomspace(0.001, 1, 10), 8)[None, :, None]
        image = reference.copy()
        image[:, :8] *= 0.4
        c = covtrace.compare(image, reference)
        numpy.testing.assert_allclose(c.mean_ratio, 1, atol=1e-3)
        numpy.testing.assert_allclose(c.decile_ratio, [0.4] + [1] * 9, rtol=1e-5)
        dim = covtrace.compare(0.001 * image, 0.001 * reference)
        self.assertAlmostEqual(dim.relmse_median / c.relmse_median, 1, places=4)

    def test_compare_where_nothing_is_finite(self):
        reference = numpy.full((6, 8, 3), 0.5)
        c = covtrace.compare(numpy.full((6, 8, 3), numpy.nan), reference)
        self.assertEqual(c.nonfinite, 3 * 6 * 8)
        for measure in (c.mse, c.relmse, c.relmse_trimmed, c.relmse_median, c.psnr, c.flip, *c.decile_ratio):
            self.assertTrue(numpy.isnan(measure))
        numpy.testing.assert_array_equal(c.flip_map, numpy.zeros((6, 8)))

    def test_arrays_become_layers_as_they_came(self):
        rng = numpy.random.default_rng(4)
        sizes = {"": 3, "N": 3, "albedo": 3, "beauty": 4, "uv": 2, "filter": 3, "cov": 15}
        given = {name: rng.random((5, 7, n), dtype=numpy.float32) for name, n in sizes.items()} | {"Z": rng.random((5, 7))}
        image = covtrace.Image.from_arrays(layers=given)
        for channel in ("R", "N.X", "albedo.R", "beauty.A", "uv.Y", "filter.xy", "cov.44", "Z"):
            self.assertIn(channel, image.channels)
        again = covtrace.Image.from_arrays(layers=dict(image.items()))
        self.assertEqual(list(again.channels), list(image.channels))
        for name, values in given.items():
            numpy.testing.assert_array_equal(again[name], values.astype(numpy.float32))
        self.assertIs(image.get("cov"), image["cov"])
        self.assertIsNone(image.get("nothing"))

    def test_metadata_is_the_images(self):
        image = covtrace.Image.from_arrays(numpy.ones((2, 2, 3)), metadata={"gain": numpy.float32(2.5)})
        self.assertEqual(image.metadata, {"gain": 2.5})
        metadata = image.metadata
        metadata["shot"] = "a12"
        image.metadata.update(take=3, window=numpy.arange(2))
        metadata |= {"extra": 1}
        self.assertEqual((metadata.pop("extra"), metadata.pop("extra", None)), (1, None))
        del image.metadata["gain"]
        expected = {"shot": "a12", "take": 3, "window": [0, 1]}
        self.assertEqual(image.metadata, expected)
        self.assertEqual(pickle.loads(pickle.dumps(image)).metadata, expected)
        self.assertEqual(json.loads(json.dumps(image.metadata)), expected)
        with self.assertRaisesRegex(covtrace.UsageError, "metadata is .*; expected names with numbers"):
            image.metadata["shot"] = object()
        with tempfile.TemporaryDirectory() as folder:
            image.write(pathlib.Path(folder) / "a.exr")
            written = covtrace.Image.read(pathlib.Path(folder) / "a.exr").metadata
        self.assertEqual({name: written[name] for name in expected}, expected)
        image.metadata = {"take": 4}
        self.assertEqual(dict(image._planes.metadata), {"take": 4})

    def test_integers_of_pictures_are_refused(self):
        picture = numpy.full((2, 2, 3), 200, numpy.uint8)
        for call in (lambda: covtrace.Image.from_arrays(picture), lambda: covtrace.compare(picture, picture / 255)):
            with self.assertRaisesRegex(covtrace.UsageError, "rgb has the type uint8 and numbers up to 200; expected linear"):
                call()
        numpy.testing.assert_array_equal(covtrace.Image.from_arrays(picture // 200).rgb, 1)

    def test_layers_of_a_wrong_shape(self):
        for values in (3.0, [1.0, 2.0], numpy.zeros((2, 2, 2)), numpy.zeros((0, 2))):
            with self.subTest(shape=numpy.shape(values)):
                with self.assertRaisesRegex(ValueError, "'Z' must be a \\(height, width\\) array"):
                    covtrace.Image.from_arrays(layers={"Z": values})

    def test_names_of_channels(self):
        values = numpy.ones((4, 4), numpy.float32)
        for arguments in ({"layers": {"": values}}, {"layers": {"x" * 300: values}},
                          {"rgb": numpy.ones((4, 4, 3)), "layers": {"R": values}}):
            with self.assertRaises(ValueError):
                covtrace.Image.from_arrays(**arguments)


if __name__ == "__main__":
    unittest.main()
