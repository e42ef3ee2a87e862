"""Light that meets several microfacets of a rough surface, by a parameter of ours."""

import json
import math
import struct
import unittest

import exr
from gltf_file import direction, lit_square, uri
from support import DONE, CliTest

SIDE = 24
BALL = f"""\
LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" 18
Film "rgb" "integer xresolution" {SIDE} "integer yresolution" {SIDE}
Sampler "zsobol" "integer pixelsamples" 256
Integrator "path" "integer maxdepth" 100
WorldBegin
LightSource "infinite"
Material {{}}
Shape "sphere" "float radius" 0.7
"""
METAL = '"conductor" "rgb reflectance" [1 1 1] "bool remaproughness" false '
GLASS = '"dielectric" "bool remaproughness" false '
COATED = ('"coatedconductor" "rgb reflectance" [1 1 1] "bool remaproughness" false "float interface.roughness" 0 "float thickness" 0 '
          '"integer maxdepth" 100 ')


def box_in_gltf(material):
    """The text of a file with a box of this material in the middle of the picture, without lights."""
    document = json.loads(lit_square(material, direction(30, 40), direction(0, 0)))
    corners = [2 * c - 1 for i in range(8) for c in (i & 1, i >> 1 & 1, i >> 2)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    indices = [i for a, b, c, d in faces for i in (a, b, c, a, c, d)]
    data = struct.pack("<24f", *corners) + struct.pack("<36H", *indices)
    del document["extensions"], document["nodes"][2]
    document["cameras"][0]["orthographic"] |= {"xmag": 2.5, "ymag": 2.5}
    document["buffers"] = [{"byteLength": len(data), "uri": uri(data)}]
    document["bufferViews"] = [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}]
    document["accessors"] = [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-1] * 3, "max": [1] * 3},
                             {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]
    document["meshes"][0]["primitives"][0] |= {"attributes": {"POSITION": 0}, "indices": 1}
    return json.dumps(document)


class MultipleScattering(CliTest):
    def seen(self, material):
        """Mean of the middle of a ball in a white surrounding."""
        result = self.render(BALL.format(material), "--method", "uniform")
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(result.stderr.count("\n"), 1, result)
        green = exr.read(self.folder / "out.exr").pixels["G"]
        middle = range(SIDE // 4, 3 * SIDE // 4)
        return sum(green[y * SIDE + x] for y in middle for x in middle) / len(middle) ** 2

    def assert_vanishes(self, material, parameter, loss, tolerance=0.01):
        """Asserts that a ball is as bright as the sky with the parameter, and darker by `loss` at least without it."""
        self.assertLess(self.seen(material), 1 - loss)
        self.assertAlmostEqual(self.seen(material + f'"bool {parameter}" true'), 1, delta=tolerance)

    def test_white_metal_vanishes_in_a_furnace(self):
        for alpha, loss in ((0.04, 0), (0.25, 0.05), (0.81, 0.4)):
            with self.subTest(alpha=alpha):
                self.assert_vanishes(METAL + f'"float roughness" {alpha} ', "multiplescattering", loss)

    def test_clear_glass_vanishes_in_a_furnace(self):
        for alpha, loss in ((0.25, 0.04), (0.81, 0.2)):
            with self.subTest(alpha=alpha):
                self.assert_vanishes(GLASS + f'"float roughness" {alpha} ', "multiplescattering", loss)

    def colour_seen(self, name, scene):
        """Mean colour, each channel with its standard error, of the middle of what stands in a white surrounding."""
        self.write(name, scene)
        result = self.run_program("render", name, "-o", "out.exr", "--method", "uniform", "--spp", 256, "--max-depth", 100, "--environment", 1,
                                  "--resolution", f"{SIDE}x{SIDE}", "--progress", "none")
        self.assertEqual(result.code, DONE, result)
        self.assertNotIn("left out", result.stderr)
        pixels = exr.read(self.folder / "out.exr").pixels
        middle = [y * SIDE + x for y in range(SIDE // 4, 3 * SIDE // 4) for x in range(SIDE // 4, 3 * SIDE // 4)]
        return [(sum(pixels[c][i] for i in middle) / len(middle), math.sqrt(sum(pixels["variance." + c][i] for i in middle)) / len(middle))
                for c in "RGB"]

    def assert_all_colours_return(self, name, scene):
        """Asserts each colour within 1 % and five standard errors, of which chance leaves one in 1.7 million outside."""
        for mean, error in self.colour_seen(name, scene):
            self.assertAlmostEqual(mean, 1, delta=0.01 + 5 * error)

    def test_clear_glass_under_a_film_vanishes_in_a_furnace(self):
        # Nanometres of the film, also of two that vary over the ball.
        patches = 'Texture "patches" "float" "checkerboard" "float uscale" 8 "float vscale" 4 "float tex1" 120 "float tex2" 410\n'
        for alpha, eta, film_eta, thickness in ((1, 1.5, 2.5, 100), (0.5, 1.5, 2.5, 450), (1, 1.5, 1.22, 150), (1, 2.4, 1.22, 100),
                                                (0.25, 2.4, 1.6, 300), (1, 1.5, 2.5, None)):
            with self.subTest(alpha=alpha, eta=eta, film_eta=film_eta, thickness=thickness):
                film = f'"float filmthickness" {thickness}' if thickness else '"texture filmthickness" "patches"'
                material = (f'{GLASS} "float eta" {eta} "float roughness" {alpha} "float filmeta" {film_eta} {film} '
                            '"bool multiplescattering" true')
                self.assert_all_colours_return("ball.pbrt", BALL.replace("Material", patches + "Material").format(material))

    def test_clear_glass_of_gltf_under_a_film_vanishes_in_a_furnace(self):
        film = {"iridescenceFactor": 1, "iridescenceIor": 2.5, "iridescenceThicknessMaximum": 100}
        for about, extensions in (("body", {"KHR_materials_volume": {"thicknessFactor": 1}}), ("pane", {})):
            with self.subTest(about):
                extensions |= {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_iridescence": film}
                material = {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.9}, "extensions": extensions}
                self.assert_all_colours_return("box.gltf", box_in_gltf(material))

    def test_white_metal_below_a_coat_vanishes_in_a_furnace(self):
        # Random walks are noisy: the standard deviation of the mean is 0.006.
        self.assert_vanishes(COATED + '"float conductor.roughness" 0.5 ', "conductor.multiplescattering", 0.1, 0.03)


if __name__ == "__main__":
    unittest.main()
