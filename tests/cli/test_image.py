"""The image: layers, windows, metadata, and the PNG beside it."""

import json
import math
import re
import statistics
import struct
import unittest
import zlib

import exr
from support import TINY, DONE, USAGE, CliTest, warnings_of

PLAIN = (
    "R G B A raw.R raw.G raw.B albedo.R albedo.G albedo.B N.X N.Y N.Z Z variance.R variance.G variance.B error.Y samples.Y"
).split()
SYMMETRIC = ["xx", "xy", "yy"]
COVARIANCE = (
    ["density.Y", "covweight.Y"]
    + [f"filter.{s}" for s in SYMMETRIC]
    + [f"spectrum.{s}" for s in SYMMETRIC]
    + [f"cov.{i}{j}" for i in range(5) for j in range(i, 5)]
)
ENVIRONMENT = 'LightSource "infinite" "rgb L" [.4 .4 .4]\n'

LAMPS_OUT_OF_FOCUS = """
LookAt 0 0 0  0 0 1  0 1 0
Camera "perspective" "float fov" 40 "float lensradius" .12 "float focaldistance" 2
Film "rgb" "integer xresolution" 160 "integer yresolution" 120
WorldBegin
LightSource "infinite" "rgb L" [.05 .05 .05]
AttributeBegin
    AreaLightSource "diffuse" "rgb L" [4 4 4]
    Translate -1 .5 8
    Shape "sphere" "float radius" .6
AttributeEnd
AttributeBegin
    AreaLightSource "diffuse" "rgb L" [3 2 1]
    Translate 1.4 -.6 9
    Shape "sphere" "float radius" .7
AttributeEnd
"""


class Layers(CliTest):
    def layers(self, *arguments, scene=TINY):
        return exr.read(self.rendered(*arguments, scene=scene))

    def test_names(self):
        self.assertCountEqual(self.layers("--method", "uniform").channels, PLAIN)
        self.assertCountEqual(self.layers("--method", "covariance").channels, PLAIN + COVARIANCE)

        self.assertCountEqual(self.layers("--method", "hybrid").channels, PLAIN + COVARIANCE)

    def test_named_layers_that_are_not_there_are_told(self):
        def told(*arguments):
            return [w for _, w in warnings_of(self.render(TINY, "--spp", 2, *arguments)) if "--layers" in w]

        self.assertEqual(len(told("--method", "hybrid", "--layers", "all,inview")), 1)
        self.assertIn("'density'", told("--method", "uniform", "--layers", "raw,density,Z")[0])
        self.assertEqual(told("--method", "uniform", "--layers", "all,inview,A,Z"), [])
        self.assertEqual(told("--method", "hybrid", "--layers", "all,inview", "--quiet"), [])

    def test_hybrid_is_the_default(self):
        self.assertEqual(self.layers().value("covtrace:method"), "hybrid")

    def test_alpha_only_where_the_scene_leaves_holes(self):
        self.assertIn("A", self.layers().channels)
        self.assertNotIn("A", self.layers(scene=TINY + ENVIRONMENT).channels)

    def test_everything_is_finite(self):
        for method in ("uniform", "covariance", "hybrid"):
            image = self.layers("--method", method)
            for name, values in image.pixels.items():
                self.assertTrue(all(map(math.isfinite, values)), f"{method}: {name}")

    def test_uniform_takes_the_same_everywhere(self):
        image = self.layers("--method", "uniform", "--spp", "5")
        self.assertEqual(set(image.pixels["samples.Y"]), {5.0})
        for c in "RGB":
            self.assertEqual(image.pixels[c], image.pixels[f"raw.{c}"])

    def test_average_of_the_samples_is_what_was_asked_for(self):
        for method in ("uniform", "covariance", "hybrid"):
            for spp in (0.5, 1, 1.25, 1.5, 3.5, 4, 6.25):
                with self.subTest(method=method, spp=spp):
                    samples = self.layers("--method", method, "--spp", spp).pixels["samples.Y"]
                    self.assertAlmostEqual(sum(samples) / len(samples), spp, delta=1 / len(samples) + 0.01 * spp)
        # Covariance paths are samples of the halves' shares, and no others.
        for paths in (2, 3):
            samples = self.layers("--spp", 3.5, "--cov-spp", paths).pixels["samples.Y"]
            self.assertAlmostEqual(sum(samples) / len(samples), 3.5, delta=0.035)

    def test_filters_by_their_constants(self):
        rules = {rule: self.layers("--method", "covariance", "--spp", 16, "--density", "tempered", "--filter", rule).pixels for rule in ("verified", "predicted", "matched", "thesis")}
        compared = 0
        for matched, thesis in zip(*(zip(*(rules[r][f"filter.{s}"] for s in SYMMETRIC)) for r in ("matched", "thesis"))):
            self.assertLessEqual(matched[0], thesis[0] * 1.00001)
            # Deviations along the axes are compared; at the limits of 0.5 and 15 pixels rules give
            # the same.
            least, most = (
                (xx + yy) / 2 + side * math.hypot((xx - yy) / 2, xy) for side, (xx, xy, yy) in ((-1, matched), (1, thesis))
            )
            if least > 0.26 and most < 220:
                compared += 1
                for a, b in zip(matched, thesis):
                    self.assertAlmostEqual(b, 2 * math.pi * a, delta=1e-3 * most)
        self.assertGreater(compared, 0)
        for pixel in range(len(rules["verified"]["R"])):
            self.assertEqual(rules["verified"]["raw.G"][pixel], rules["matched"]["raw.G"][pixel])
        # Both have the same predicted filters, but only the first asks the samples whether to use them.
        for s in SYMMETRIC:
            self.assertEqual(rules["verified"][f"filter.{s}"], rules["predicted"][f"filter.{s}"])
        self.assertNotEqual(rules["verified"]["G"], rules["predicted"]["G"])

    def test_counts_follow_the_noise_that_filters_leave(self):
        def samples(spp, *arguments):
            return self.layers("--method", "covariance", "--spp", spp, *arguments).pixels["samples.Y"]

        self.assertEqual(samples(4), samples(4, "--density", "tempered"))
        verified, tempered = samples(16), samples(16, "--density", "tempered")
        # The noise is that of an image of 4 samples per pixel.
        few = self.layers("--method", "covariance", "--spp", 4).pixels
        noise = [n * v / (y * y + 0.01) for n, v, y in zip(few["samples.Y"], few["variance.G"], few["G"])]
        middle = sorted(noise)[len(noise) // 2]

        def share_of_noisy(counts):
            return sum(c for c, v in zip(counts, noise) if v > middle) / sum(counts)

        self.assertGreater(share_of_noisy(verified), 1.02 * share_of_noisy(tempered))

    def test_one_sample_is_not_taken_for_no_noise(self):
        pixels = self.layers("--method", "covariance", "--cov-spp", 1, "--spp", 2).pixels

        def mean_square_error(single):
            return statistics.mean(e * e for e, n in zip(pixels["error.Y"], pixels["samples.Y"]) if (n == 1) == single)

        # The ratio was 0.61, and 0.08 where pixels with one sample counted as free of noise.
        self.assertGreater(mean_square_error(True), 0.3 * mean_square_error(False))

    def test_outlines_of_lamps_out_of_focus_are_sharper_than_predicted(self):
        self.write("scene.pbrt", LAMPS_OUT_OF_FOCUS)

        def rendered(name, *arguments):
            done = self.run_program("render", "scene.pbrt", "-o", name, "--quiet", *map(str, arguments))
            self.assertEqual(done.code, DONE, done.stderr)

        rendered("reference.exr", "--method", "uniform", "--spp", 256, "--seed", 99)
        rendered("image.exr", "--method", "covariance", "--spp", 16, "--seed", 1)
        told = self.run_program("compare", "image.exr", "reference.exr")
        error = float(re.search(r"^relmse +(\S+)$", told.stdout, re.MULTILINE).group(1))
        # It was 0.00077, a part of it noise of the reference, and 0.0020 through the predicted
        # filters of emitters in view alone.
        self.assertLess(error, 0.0013)

    def test_every_voxel_occludes_more_than_the_nearest_at_their_distance(self):
        widths = {}
        for occlusion in ("grid", "voxels"):
            pixels = self.layers("--method", "covariance", "--spp", 4, "--occlusion", occlusion, "--voxels", 12).pixels
            widths[occlusion] = sum(math.log(xx * yy - xy * xy) for xx, xy, yy in zip(*(pixels[f"filter.{s}"] for s in SYMMETRIC)))
        self.assertLess(widths["voxels"], widths["grid"])

    def test_factor_of_the_thesis_density(self):
        thesis = ["--method", "covariance", "--density", "thesis"]

        def rendered(*arguments):
            image = self.layers(*thesis, *arguments, "--stats", "stats.json")
            statistics = json.loads((self.folder / "stats.json").read_text())
            return image.pixels["samples.Y"], image.pixels["density.Y"], statistics

        # A budget of samples makes a factor, which makes the same counts.
        by_budget, density, statistics = rendered("--spp", 7, "--max-spp", 60)
        k = statistics["k"]
        by_factor, _, again = rendered("--k", k, "--max-spp", 60)
        self.assertAlmostEqual(again["k"] / k, 1, delta=1e-4)
        self.assertAlmostEqual(again["spp"], 7, delta=0.01)
        self.assertLessEqual(sum(a != b for a, b in zip(by_budget, by_factor)), 0.01 * len(by_budget))
        # Counts are the density, but for whole numbers, the limit and paths that were needed to know it.
        for n, wanted in zip(by_budget, density):
            self.assertLessEqual(abs(n - min(60, max(2, wanted))), 1.001)

        # The double factor gives twice the samples where no limit is in the way; nothing else
        # decides.
        few, _, statistics = rendered("--k", 0.2, "--cov-spp", 0.25)
        self.assertAlmostEqual(statistics["k"], 0.2, places=6)
        self.assertLess(statistics["spp"], 1)
        self.assertLess(sum(few) / len(few), 1)
        self.assertEqual(min(few), 0)
        _, once, _ = rendered("--k", 50)
        many, twice, _ = rendered("--k", 100)
        for a, b, n in zip(once, twice, many):
            self.assertAlmostEqual(b, 2 * a, delta=0.05 * b)
            self.assertLessEqual(abs(n - max(2, b)), 1.001)
        self.write("scene.pbrt", TINY)
        told = self.run_program("render", "scene.pbrt", "-o", "out.exr", *map(str, [*thesis, "--spp", 7]))
        self.assertRegex(told.stderr, r"out.exr: 7 samples per pixel \(k = [0-9.e+]+\) in ")
        for others in (["--method", "hybrid"], ["--method", "covariance"], [*thesis, "--progressive"]):
            self.assert_fails(self.run_program("render", "scene.pbrt", "-o", "no.exr", "--k", "5", *others), USAGE, "--k")

    def test_image_is_as_bright_as_its_few_samples(self):
        size = ["--resolution", "49x32"]  # in odd widths every second pixel is on the same fields of a checkerboard
        for arguments in (["--spp", "0.5"], ["--spp", "0.25"], ["--spp", "0.125"], ["--spp", "0.5", "--crop", "0,20,49,21"],
                          ["--spp", "1", "--crop", "24,16,25,17"]):
            with self.subTest(arguments=arguments):
                image = self.layers(*size, *arguments)
                sampled = [g for g, n in zip(image.pixels["raw.G"], image.pixels["samples.Y"]) if n > 0]
                brightness = sum(image.pixels["G"]) / len(image.pixels["G"])
                self.assertAlmostEqual(brightness / (sum(sampled) / len(sampled)), 1, delta=0.15)

    def test_features_that_are_not_finite_spoil_nothing(self):
        black = 'Texture "k" "spectrum" "constant" "rgb value" [1e10 1e10 1e10]\nMaterial "conductor" "texture k" "k"\n'
        shape = 'Shape "sphere" "float radius" 1'
        image = self.layers("--spp", "8", scene=TINY.replace(shape, "AttributeBegin\n" + black + shape + "\nAttributeEnd"))
        for name, values in image.pixels.items():
            self.assertTrue(all(map(math.isfinite, values)), name)
        # The floor in front is no darker than its samples.
        rows = range(12 * 24, 16 * 24)
        ratio = sum(image.pixels["G"][i] for i in rows) / sum(image.pixels["raw.G"][i] for i in rows)
        self.assertAlmostEqual(ratio, 1, delta=0.1)

    def test_max_spp(self):
        samples = self.layers("--spp", "8", "--max-spp", "10").pixels["samples.Y"]
        self.assertLessEqual(max(samples), 10)
        # The limit holds for the first samples, too.
        for method in ("covariance", "hybrid", "uniform"):
            self.assertLessEqual(max(self.layers("--method", method, "--spp", "8", "--max-spp", "2").pixels["samples.Y"]), 2)

    def test_chosen_layers(self):
        few = self.layers("--layers", "N,samples")
        self.assertCountEqual(few.channels, ["R", "G", "B", "A", "N.X", "N.Y", "N.Z", "samples.Y"])
        one = self.layers("--layers", "Z")
        self.assertCountEqual(one.channels, ["R", "G", "B", "A", "Z"])
        whole = self.layers("--layers", "all")
        self.assertCountEqual(whole.channels, PLAIN + COVARIANCE)
        for name in few.channels:
            self.assertEqual(few.pixels[name], whole.pixels[name], name)

    def test_what_the_layers_mean(self):
        image = self.layers("--spp", "16")
        middle = (image.height // 2) * image.width + image.width // 2  # on the sphere of radius 1
        self.assertAlmostEqual(image.pixels["Z"][middle], math.sqrt(37) - 1, delta=0.3)
        normal = [image.pixels[f"N.{c}"][middle] for c in "XYZ"]
        self.assertGreater(normal[2], 0.8)
        for channel, value in zip("RGB", (0.5, 0.4, 0.3)):
            self.assertAlmostEqual(image.pixels[f"albedo.{channel}"][middle], value, delta=1e-3)
        corner = 0
        self.assertEqual(image.pixels["A"][corner], 0)
        self.assertEqual(image.pixels["A"][middle], 1)


class Windows(CliTest):
    def test_whole_frame(self):
        image = exr.read(self.rendered())
        self.assertEqual(image.data_window, (0, 0, 24, 16))
        self.assertEqual(image.display_window, (0, 0, 24, 16))

    def test_resolution(self):
        image = exr.read(self.rendered("--resolution", "31x17"))
        self.assertEqual(image.data_window, (0, 0, 31, 17))

    def test_one_pixel(self):
        for method in ("uniform", "covariance", "hybrid"):
            self.assertEqual(exr.read(self.rendered("--resolution", "1x1", "--method", method)).width, 1)
            image = exr.read(self.rendered("--crop", "23,15,24,16", "--method", method))
            self.assertEqual(image.data_window, (23, 15, 24, 16))

    def test_crop_holds_the_pixels_of_the_whole(self):
        whole = exr.read(self.rendered("--method", "uniform"))
        part = exr.read(self.rendered("--method", "uniform", "--crop", "5,3,20,11", output="part.exr"))
        self.assertEqual(part.data_window, (5, 3, 20, 11))
        self.assertEqual(part.display_window, (0, 0, 24, 16))
        for name in part.channels:
            for y in range(3, 11):
                expected = whole.pixels[name][y * 24 + 5 : y * 24 + 20]
                found = part.pixels[name][(y - 3) * 15 : (y - 2) * 15]
                self.assertEqual(found, expected, f"{name}, row {y}")

    def test_crop_in_the_scene(self):
        scene = TINY.replace('"string filename"', '"integer pixelbounds" [4 12 2 6] "string filename"')
        image = exr.read(self.rendered(scene=scene))
        self.assertEqual(image.data_window, (4, 2, 12, 6))
        self.assertEqual(image.display_window, (0, 0, 24, 16))


class Metadata(CliTest):
    def test_header(self):
        image = exr.read(self.rendered("--spp", "3", "--seed", "7", "--isa", "avx2"))
        self.assertEqual(image.attributes["complete"], ("int", 1))
        self.assertEqual(image.attributes["spp"][0], "float")
        self.assertAlmostEqual(image.value("spp"), 3, delta=0.01)
        self.assertEqual(image.attributes["covtrace:seed"], ("string", "7"))
        self.assertEqual(image.attributes["covtrace:isa"], ("string", "avx2"))
        self.assertRegex(image.value("covtrace:version"), r"^\d+\.\d+\.\d+$")
        self.assertEqual(image.attributes["covtrace:commit"][0], "string")
        self.assertRegex(image.value("covtrace:sceneHash"), r"^[0-9a-f]{16}$")
        for camera in ("worldToCamera", "worldToNDC"):
            self.assertEqual(image.attributes[camera][0], "m44f")
        self.assertIn("render", image.value("covtrace:command"))
        self.assertGreater(image.value("covtrace:seconds"), 0)
        self.assertRegex(image.value("capDate"), r"^\d{4}:\d\d:\d\d \d\d:\d\d:\d\d$")

    def test_scene_hash_follows_the_scene(self):
        def scene_hash(scene):
            return exr.read(self.rendered(scene=scene)).value("covtrace:sceneHash")

        self.assertEqual(scene_hash(TINY), scene_hash(TINY))
        self.assertNotEqual(scene_hash(TINY), scene_hash(TINY.replace(".5 .4 .3", ".5 .4 .31")))

    def test_world_to_ndc_maps_the_look_at_point_to_the_middle(self):
        m = exr.read(self.rendered()).value("worldToNDC")
        x, y, w = m[12], m[13], m[15]  # the origin, where the camera looks, times the matrix
        self.assertAlmostEqual(x / w, 0.5, delta=1e-4)
        self.assertAlmostEqual(y / w, 0.5, delta=1e-4)

    def test_reproducible_leaves_out_what_differs_between_runs(self):
        image = exr.read(self.rendered("--reproducible"))
        for name in ("covtrace:command", "covtrace:seconds", "capDate", "utcOffset"):
            self.assertNotIn(name, image.attributes)
        self.assertIn("covtrace:sceneHash", image.attributes)


def read_png(data):
    """Width, height, and rows of 8-bit RGB; checks every checksum."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, header = 8, b"", None
    kind = b""
    while kind != b"IEND":
        (size,) = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + size]
        (checksum,) = struct.unpack_from(">I", data, at + 8 + size)
        assert checksum == zlib.crc32(kind + body), kind
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    assert at == len(data)
    width, height = header[:2]
    assert header[2:] == (8, 2, 0, 0, 0), header
    coded, rows, stride = zlib.decompress(packed), [], 3 * width
    assert len(coded) == height * (stride + 1)
    above = bytearray(stride)
    for y in range(height):
        kind, row = coded[y * (stride + 1)], bytearray(coded[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            a, b = row[i - 3] if i >= 3 else 0, above[i]
            c = above[i - 3] if i >= 3 else 0
            p = a + b - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[i] = (row[i] + (0, a, b, (a + b) // 2, paeth)[kind]) & 0xFF
        rows.append(row)
        above = row
    return width, height, rows


class Png(CliTest):
    def test_png_is_the_image_in_srgb(self):
        image = exr.read(self.rendered("--png", "out.png"))
        width, height, rows = read_png((self.folder / "out.png").read_bytes())
        self.assertEqual((width, height), (24, 16))
        for c, name in enumerate("RGB"):
            for i, v in enumerate(image.pixels[name]):
                v = min(max(v, 0), 1)
                encoded = 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055
                self.assertAlmostEqual(rows[i // 24][3 * (i % 24) + c], 255 * encoded, delta=0.51)

    def test_png_of_a_crop(self):
        self.rendered("--png", "out.png", "--crop", "3,4,10,9")
        width, height, _ = read_png((self.folder / "out.png").read_bytes())
        self.assertEqual((width, height), (7, 5))


class Overrides(CliTest):
    def test_lens_and_shutter(self):
        for arguments in (["--shutter", "0,0.5"], ["--fstop", "2", "--focus", "5"], ["--max-depth", "0"], ["--focus", "3"]):
            with self.subTest(arguments=arguments):
                image = exr.read(self.rendered("--method", "uniform", *arguments))
                self.assertEqual(image.value("complete"), 1)

    def test_half_the_shutter_is_half_the_light(self):
        whole = exr.read(self.rendered("--method", "uniform", "--shutter", "0,1")).pixels["R"]
        half = exr.read(self.rendered("--method", "uniform", "--shutter", "0,0.5")).pixels["R"]
        self.assertAlmostEqual(sum(half) / sum(whole), 0.5, delta=1e-4)

    def test_depth_zero_shows_lights_only(self):
        image = exr.read(self.rendered("--method", "uniform", "--max-depth", "0", "--spp", "16"))
        lit = exr.read(self.rendered("--method", "uniform", "--max-depth", "2", "--spp", "16"))
        self.assertLess(sum(image.pixels["R"]), sum(lit.pixels["R"]))

    def test_a_world_without_anything(self):
        empty = TINY[: TINY.index("WorldBegin")] + "WorldBegin\n"
        for method in ("uniform", "covariance", "hybrid"):
            with self.subTest(method=method):
                result = self.render(empty, "--method", method)
                self.assertEqual(result.code, DONE, result)
                self.assertEqual(set(exr.read(self.folder / "out.exr").pixels["R"]), {0.0})


if __name__ == "__main__":
    unittest.main()
