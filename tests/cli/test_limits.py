"""Memory: the bytes that films take, and renders that are refused. Samples that are not finite."""

import json
import math
import re
import unittest

import exr
from films import METHODS, FilmTest
from support import DONE, HEADER, LIMIT, SANITIZED, USAGE, WORLD

# Close to its light the sphere is brighter than the largest float; elsewhere the film limits it.
TOO_BRIGHT = HEADER.replace('Film "rgb"', 'Film "rgb" "float maxcomponentvalue" 10') + """\
WorldBegin
LightSource "point" "point3 from" [0 0.5 1] "rgb I" [1 1 1] "float scale" 2e37
Material "diffuse" "rgb reflectance" [.9 .9 .9]
Shape "sphere" "float radius" 1
"""

# A wall, and before it a lamp that shines at the camera alone: the squares of its light are no floats.
BRIGHT_LAMP = HEADER + """\
WorldBegin
LightSource "point" "point3 from" [2 3 4] "rgb I" [10 10 10]
Material "diffuse" "rgb reflectance" [.5 .4 .3]
Shape "trianglemesh" "point3 P" [-9 -9 -1  9 -9 -1  9 9 -1  -9 9 -1] "integer indices" [0 1 2  0 2 3]
Shape "sphere" "float radius" 0.8
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [1 1 1] "float scale" 1e25
  Translate 1 1 1
  Shape "disk" "float radius" 0.1
AttributeEnd
"""


class Memory(FilmTest):
    def test_bytes_per_pixel(self):
        most = {"uniform": 64, "covariance": 160, "hybrid": 312}
        for method in METHODS:
            for spp in ("2", "16"):
                with self.subTest(method=method, spp=spp):
                    self.run_render("moving", method, "--spp", spp, "--stats", "s.json")
                    memory = json.loads((self.folder / "s.json").read_text())["memory"]
                    pixel = {name: memory.get(name, 0) / (70 * 50) for name in ("film", "plan", "prediction")}
                    self.assertLessEqual(sum(pixel.values()), most[method])
                    self.assertGreaterEqual(pixel["film"], 60)

    def test_resolution_has_the_limits_of_a_scene(self):
        for size in ("65537x1", "1x65537", "65536x16385"):
            result = self.run_program("render", "plain.pbrt", "-o", "out.exr", "--resolution", size)
            self.assert_fails(result, LIMIT, "--resolution", "65536")

    def test_most_memory(self):
        for method, size in (("uniform", "100M"), ("covariance", "200M"), ("hybrid", "500M")):
            with self.subTest(method=method):
                result = self.run_program(
                    "render", "plain.pbrt", "-o", "out.exr", "--method", method, "--resolution", "2000x1500", "--max-memory", size
                )
                self.assert_fails(result, LIMIT, "--max-memory", "film", "image")
                parts = re.findall(r" ([0-9.]+)M(?:,|$)", result.stderr.split(": ")[-1].strip())
                whole = float(re.search(r"needs ([0-9.]+)M", result.stderr)[1])
                self.assertAlmostEqual(sum(map(float, parts)), whole, delta=0.5)
                self.assert_no_file()
        self.run_render("plain", "hybrid", "--max-memory", "4G", "--spp", "1")

    def test_long_and_narrow_images(self):
        """Narrow images have borders that take several times the memory of their pixels."""
        for size in ("60000x1", "1x60000"):
            result = self.run_program(
                "render", "plain.pbrt", "-o", "out.exr", "--method", "hybrid", "--resolution", size, "--max-memory", "250M"
            )
            self.assert_fails(result, LIMIT, "--max-memory", "image")
            self.assert_no_file()

    @unittest.skipIf(SANITIZED, "a sanitizer takes several times what the program does")
    def test_what_is_refused_would_not_have_fit(self):
        """The estimate is near the most that the process has in memory at its worst."""
        factor = 1.6
        for method, resolution in (("uniform", "500x400"), ("covariance", "500x400"), ("hybrid", "300x200")):
            with self.subTest(method=method):
                size = ["--resolution", resolution, "--spp", "1", "--max-depth", "1"]
                self.run_render("plain", method, *size, "--stats", "s.json")
                peak = json.loads((self.folder / "s.json").read_text())["memory"]["peak_resident"]
                self.run_render("plain", method, *size, "--max-memory", str(int(factor * peak)))
                result = self.run_program("render", "plain.pbrt", "-o", "x.exr", "--method", method, *size, "--max-memory", str(int(peak / factor)))
                self.assert_fails(result, LIMIT, "--max-memory")

    @unittest.skipIf(SANITIZED, "a sanitizer takes several times what the program does")
    def test_further_layers_count(self):
        """Layers that are asked for by name take memory, which the estimate holds."""
        names = "all,P,Ng,uv,dz,relvariance,featurealbedo,featureN"
        for method in METHODS:
            with self.subTest(method=method):
                size = ["--resolution", "900x700", "--spp", "0.1", "--max-depth", "1", "--denoiser", "none", "--layers", names]
                refused = self.run_program("render", "plain.pbrt", "-o", "x.exr", "--method", method, *size, "--max-memory", "1M")
                needs = float(re.search(r"needs ([0-9.]+)M", refused.stderr)[1])
                self.run_render("plain", method, *size, "--stats", "s.json")
                peak = json.loads((self.folder / "s.json").read_text())["memory"]["peak_resident"] / (1 << 20)
                self.assertLess(peak, 1.02 * needs + 12)


class NotFinite(FilmTest):
    def test_counted_located_and_reproducible(self):
        self.write("bright.pbrt", TOO_BRIGHT)
        for method in METHODS:
            with self.subTest(method=method):
                result = self.run_render("bright", method, "--stats", "s.json", "--film", "a.film")
                where = re.search(r"(\d+) samples were not finite .*--debug-pixel (\d+,\d+,\d+)", result.stderr)
                self.assertIsNotNone(where, result)
                stats = json.loads((self.folder / "s.json").read_text())
                self.assertEqual(int(where[1]), stats["covariance"]["rejected"] + stats["radiance"]["rejected"])
                self.assertIn(f"{where[1]} samples, at x,y,sample = ", self.assert_sound("a.film"))
                image = exr.read(self.folder / "out.exr")
                for name, values in image.pixels.items():
                    self.assertTrue(all(map(math.isfinite, values)), name)
                places = stats["covariance"]["first_rejected"] + stats["radiance"]["first_rejected"]
                for place in places:
                    shown = self.run_program("render", "bright.pbrt", "--method", method, "--debug-pixel", ",".join(map(str, place)))
                    self.assertEqual(shown.code, DONE, shown)
                    self.assertIn("not finite", shown.stdout)
                    self.assertIn("vertex 0", shown.stdout)

    def test_light_without_a_known_error(self):
        """The rest of the image has a known error: --error asks for it, and the film keeps it."""
        self.write("lamp.pbrt", BRIGHT_LAMP)
        film = ["--error", "0.0001", "--checkpoint", "c.film", "--resume"]
        for spp in (32, 64):
            self.run_render("lamp", "hybrid", "--spp", spp, *film)
            image = exr.read(self.folder / "out.exr")
            self.assertAlmostEqual(image.value("spp"), spp, delta=0.1)
            self.assertIn(f"{spp} samples per pixel", self.assert_sound("c.film"))
        self.assertGreater(max(image.pixels["error.Y"]), 1e38)

    def test_a_lamp_of_such_light_in_a_dim_room(self):
        """The room is brought to a display's brightness, and the lamp does not spoil it."""
        dim = BRIGHT_LAMP.replace("[10 10 10]", "[1e-5 1e-5 1e-5]")
        for scale in ("1e17", "1e33"):
            with self.subTest(scale=scale):
                self.write("lamp.pbrt", dim.replace("1e25", scale))
                self.run_render("lamp", "hybrid", "--spp", "8", "--resolution", "72x48")
                pixels = exr.read(self.folder / "out.exr").pixels
                own, raw = (sorted(pixels[name]) for name in ("G", "raw.G"))
                for part in (0.25, 0.5, 0.75):
                    self.assertAlmostEqual(own[int(part * len(own))] / raw[int(part * len(raw))], 1, delta=0.2)
                self.assertGreater(max(own), 1e15)
                error = sorted(pixels["error.Y"])
                self.assertLess(error[len(error) // 2], 1e-6)
                if scale == "1e17":
                    self.assertLess(error[-1], 1e38)

    def test_finite_samples(self):
        """The mean of a pixel's samples is the pixel."""
        self.run_render("plain", "uniform", "--spp", "2")
        raw = exr.read(self.folder / "out.exr").pixels["raw.G"]
        for x, y in ((35, 25), (10, 40), (60, 5)):
            values = []
            for sample in range(2):
                shown = self.run_program("render", "plain.pbrt", "--method", "uniform", "--debug-pixel", f"{x},{y},{sample}")
                values.append(float(re.search(r"radiance [^,]+,([^,]+),", shown.stdout)[1]))
            self.assertAlmostEqual(sum(values) / 2, raw[y * 70 + x], delta=1e-5 * (1 + abs(sum(values))))
        for pixel in ("70,1,0", "-9223372036854775808,0,0", "1,1,4294967296"):
            result = self.run_program("render", "plain.pbrt", "--method", "uniform", "--debug-pixel=" + pixel)
            self.assert_fails(result, USAGE, "--debug-pixel")


if __name__ == "__main__":
    unittest.main()
