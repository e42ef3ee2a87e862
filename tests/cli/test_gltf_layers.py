"""Layers of glTF's materials against the formulas that Khronos gives for them, evaluated here; what is unlit; tangents of files.

The square of gltf_file shows one value of the BRDF times the cosine: a directional light of 1, one direction of view.
"""

import functools
import json
import math
import unittest

import exr
from gltf_file import cross, direction, lit_square, normalized, png
from support import DONE, CliTest
from test_gltf_materials import PAIRS, dot, ggx, metal

# Nothing below the layers.
NOTHING = {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
           "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
WHITE = {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0},
         "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
GOLD = [1, 0.6, 0.3]
GRAZING = (direction(20, 80), direction(150, 75))


def with_layers(material, **extensions):
    return material | {"extensions": material.get("extensions", {}) | {f"KHR_materials_{name}": e for name, e in extensions.items()}}


def tilted(normal):
    """A picture of a normal, and the normal that its bytes hold."""
    texel = [round((x + 1) / 2 * 255) for x in normalized(normal)]
    return png(1, 1, [(*texel, 255)]), normalized([2 * t / 255 - 1 for t in texel])


def about(normal, w):
    """A direction in a frame about another normal; only its angles to the normal and to others in the frame mean anything."""
    x = normalized(cross([0, 1, 0], normal))
    return [dot(w, x), dot(w, cross(normal, x)), dot(w, normal)]


def curve(x, alpha):
    t = (1 - alpha) ** 2
    a, b, c, d, e = (rough + (fine - rough) * t for rough, fine in
                     ((21.5473, 25.3245), (3.82987, 3.32435), (0.19823, 0.16801), (-1.97760, -1.27393), (-4.32054, -4.85967)))
    return a / (1 + b * x ** c) + d * x + e


def masking(cosine, alpha):
    return math.exp(curve(cosine, alpha) if cosine < 0.5 else 2 * curve(0.5, alpha) - curve(1 - cosine, alpha))


def charlie(v, l, alpha):
    """D V of KHR_materials_sheen for the normal +z."""
    h = normalized([x + y for x, y in zip(v, l)])
    d = (2 + 1 / alpha) * (1 - h[2] ** 2) ** (0.5 / alpha) / (2 * math.pi)
    return d / ((1 + masking(v[2], alpha) + masking(l[2], alpha)) * 4 * v[2] * l[2])


@functools.cache
def sheen_albedo(cosine, alpha, side=200):
    """E of the extension: the mean over directions of the same density, times their solid angle."""
    v = (math.sqrt(1 - cosine * cosine), 0, cosine)
    total = 0
    for i in range(side):
        z = (i + 0.5) / side
        r = math.sqrt(1 - z * z)
        for j in range(side // 2):
            phi = math.pi * (j + 0.5) / (side // 2)
            total += charlie(v, (r * math.cos(phi), r * math.sin(phi), z), alpha) * z
    return total * 2 * math.pi / (side * (side // 2))


class GltfLayers(CliTest):
    def rendered(self, text, depth=1):
        self.write("a.gltf", text)
        result = self.run_program("render", "a.gltf", "-o", "a.exr", "--method", "uniform", "--spp", "4", "--resolution", "4x4", "--max-depth",
                                  str(depth), "--progress", "none")
        self.assertEqual(result.code, DONE, result)
        self.assertNotIn("KHR_", result.stderr)
        pixels = exr.read(self.folder / "a.exr").pixels
        return [pixels[c][5] for c in "RGB"]

    def seen(self, material, v, l, **more):
        return self.rendered(lit_square(material, v, l, **more))

    def assert_close(self, found, expected, relative, about_what):
        for a, b in zip(found, expected):
            self.assertLess(abs(a - b), relative * abs(b) + 1e-5, f"{about_what}: {found}, expected {expected}")

    def test_clearcoat_over_nothing_and_over_gold(self):
        for weight, roughness in ((1, 0.5), (0.4, 0.3)):
            coat = {"clearcoatFactor": weight, "clearcoatRoughnessFactor": roughness}
            for v, l in (*PAIRS, GRAZING):
                share = weight * (0.04 + 0.96 * (1 - v[2]) ** 5)
                shine = share * ggx(v, l, roughness ** 2, roughness ** 2, 0) * l[2]
                self.assert_close(self.seen(with_layers(NOTHING, clearcoat=coat), v, l), [shine] * 3, 0.01, (coat, v, l))
                if (v, l) == GRAZING:
                    continue  # where the metal's curve is not Schlick's
                below = {"pbrMetallicRoughness": {"baseColorFactor": [*GOLD, 1], "roughnessFactor": 0.6}}
                gold = metal(GOLD, 0.36, 0.36, 0, v, l)
                self.assert_close(self.seen(with_layers(below, clearcoat=coat), v, l), [(1 - share) * g + shine for g in gold], 0.02, (coat, v, l))

    def test_clearcoat_textures(self):
        images = [png(1, 1, [(51, 0, 0, 255)]), png(1, 1, [(0, 128, 0, 255)])]
        coat = {"clearcoatFactor": 0.8, "clearcoatTexture": {"index": 0}, "clearcoatRoughnessFactor": 0.9, "clearcoatRoughnessTexture": {"index": 1}}
        alpha = (0.9 * 128 / 255) ** 2
        for v, l in PAIRS:
            share = 0.8 * 0.2 * (0.04 + 0.96 * (1 - v[2]) ** 5)
            self.assert_close(self.seen(with_layers(NOTHING, clearcoat=coat), v, l, images=images), [share * ggx(v, l, alpha, alpha, 0) * l[2]] * 3, 0.01, (v, l))

    def test_clearcoat_has_its_own_normal(self):
        image, normal = tilted([0.3, -0.2, 1])
        coat = {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.4}
        up = [0, 0, 1]
        below = {"pbrMetallicRoughness": {"baseColorFactor": [*GOLD, 1], "roughnessFactor": 0.6}}
        for of_base, of_coat in ((up, normal), (normal, up), (normal, normal)):
            material = with_layers(below, clearcoat=coat | ({"clearcoatNormalTexture": {"index": 0}} if of_coat is normal else {}))
            if of_base is normal:
                material = material | {"normalTexture": {"index": 0}}
            for v, l in PAIRS:
                v_base, l_base, v_coat, l_coat = about(of_base, v), about(of_base, l), about(of_coat, v), about(of_coat, l)
                share = 0.04 + 0.96 * (1 - v_coat[2]) ** 5
                shine = share * ggx(v_coat, l_coat, 0.16, 0.16, 0) * l_coat[2]
                expected = [(1 - share) * g + shine for g in metal(GOLD, 0.36, 0.36, 0, v_base, l_base)]
                self.assert_close(self.seen(material, v, l, images=[image]), expected, 0.02, (of_base, of_coat, v, l))

    def test_sheen_over_nothing_and_over_white(self):
        colour = [0.9, 0.5, 0.1]
        for roughness in (0.3, 0.6, 1):
            alpha = roughness ** 2
            sheen = {"sheenColorFactor": colour, "sheenRoughnessFactor": roughness}
            for v, l in (*PAIRS[1:], GRAZING):
                shine = [c * charlie(v, l, alpha) * l[2] for c in colour]
                self.assert_close(self.seen(with_layers(NOTHING, sheen=sheen), v, l), shine, 0.01, (roughness, v, l))
                left = 1 - max(colour) * max(sheen_albedo(v[2], alpha), sheen_albedo(l[2], alpha))
                self.assert_close(self.seen(with_layers(WHITE, sheen=sheen), v, l), [s + left * l[2] / math.pi for s in shine], 0.01, (roughness, v, l))

    def test_sheen_textures(self):
        # 188 is 0.503 when it is decoded.
        images = [png(1, 1, [(255, 188, 0, 255)]), png(1, 1, [(0, 0, 0, 153)])]
        sheen = {"sheenColorFactor": [0.8, 0.8, 0.8], "sheenColorTexture": {"index": 0}, "sheenRoughnessFactor": 1, "sheenRoughnessTexture": {"index": 1}}
        v, l = GRAZING
        expected = [0.8 * c * charlie(v, l, 0.36) * l[2] for c in (1, 0.503, 0)]
        self.assert_close(self.seen(with_layers(NOTHING, sheen=sheen), v, l, images=images), expected, 0.01, "textures")

    def test_clearcoat_lies_over_sheen(self):
        material = with_layers(NOTHING, sheen={"sheenColorFactor": [1, 0, 0], "sheenRoughnessFactor": 0.5},
                               clearcoat={"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.5})
        v, l = GRAZING
        share = 0.04 + 0.96 * (1 - v[2]) ** 5
        coat = share * ggx(v, l, 0.25, 0.25, 0) * l[2]
        self.assert_close(self.seen(material, v, l), [coat + (1 - share) * charlie(v, l, 0.25) * l[2], coat, coat], 0.01, "both")

    def test_unlit_shows_its_colour_whatever_the_light(self):
        unlit = with_layers({"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.4, 0.1, 1]}}, unlit={})
        for v, l in PAIRS:
            self.assert_close(self.seen(unlit, v, l), [0.8, 0.4, 0.1], 1e-4, (v, l))
        textured = with_layers({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": {"index": 0}}}, unlit={})
        self.assert_close(self.seen(textured, *PAIRS[1], images=[png(1, 1, [(255, 188, 0, 255)])]), [0.5, 0.503, 0], 0.003, "textured")
        # The back of what is not doubleSided is not seen.
        below = direction(0, 150)
        self.assert_close(self.seen(unlit, below, direction(0, 20)), [0, 0, 0], 0, "back")
        self.assert_close(self.seen(unlit | {"doubleSided": True}, below, direction(0, 20)), [0.8, 0.4, 0.1], 1e-4, "both sides")

    def test_unlit_takes_and_gives_no_light(self):
        v, l = direction(180, 45), direction(0, 60)

        def floor_below(material):
            file = json.loads(lit_square(WHITE, v, l))
            if material:
                file["materials"].append(material | {"doubleSided": True})
                file["meshes"].append(json.loads(json.dumps(file["meshes"][0])))
                file["meshes"][1]["primitives"][0]["material"] = 1
                file["nodes"].append({"mesh": 1, "scale": [0.1, 0.1, 0.1], "translation": [10 * x for x in l]})
            return self.rendered(json.dumps(file), depth=4)

        alone = floor_below(None)
        self.assert_close(alone, [l[2] / math.pi] * 3, 0.01, "alone")
        self.assertLess(floor_below(WHITE)[0], 0.5 * alone[0])
        self.assert_close(floor_below(with_layers({}, unlit={})), alone, 1e-4, "unlit")

    def test_the_prediction_knows_what_is_unlit(self):
        # 2 pixels a texel, without noise: a filter that did not know of the texture would mix them.
        texels = [((37 * i) % 256, (91 * i) % 256, (53 * i) % 256, 255) for i in range(64)]
        unlit = with_layers({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, unlit={})
        self.write("a.gltf", lit_square(unlit, direction(0, 0), direction(0, 0), images=[png(8, 8, texels)]))
        seen = {}
        for method in ("uniform", "covariance"):
            result = self.run_program("render", "a.gltf", "-o", f"{method}.exr", "--method", method, "--spp", "64", "--resolution", "32x32", "--progress", "none")
            self.assertEqual(result.code, DONE, result)
            seen[method] = exr.read(self.folder / f"{method}.exr").pixels["G"]
        contrast = max(seen["uniform"]) - min(seen["uniform"])
        self.assertGreater(contrast, 0.5)
        self.assertLess(max(abs(a - b) for a, b in zip(*seen.values())), 0.1 * contrast)

    def test_tangents_of_the_file_count(self):
        # The coordinates say +x; the file's tangent is turned by 40 degrees, and w turns the bitangent.
        strength, rotation, turn, alpha = 0.8, 0.5, math.radians(40), 0.09
        material = {"pbrMetallicRoughness": {"roughnessFactor": 0.3},
                    "extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": strength, "anisotropyRotation": rotation}}}
        along = alpha + (1 - alpha) * strength ** 2
        v, l = direction(20, 30), direction(50, 40)
        mirrored = ((0, 0), (100, 0), (100, 100), (0, 100))
        for w in (1, -1):
            for uv in (((0, 100), (100, 100), (100, 0), (0, 0)), mirrored):
                found = self.seen(material, v, l, uv=uv, tangent=[math.cos(turn), math.sin(turn), 0, w])
                self.assert_close(found, metal([1, 1, 1], along, alpha, turn + w * rotation, v, l), 0.03, (w, uv))

    def test_normal_maps_lie_along_the_tangents_of_the_file(self):
        image, normal = tilted([0.4, 0.3, 1])
        material = WHITE | {"normalTexture": {"index": 0}}
        v, l = direction(0, 10), direction(60, 30)
        for w in (1, -1):
            # The tangent is +y, so that the bitangent is -x for w = 1.
            world = [-w * normal[1], normal[0], normal[2]]
            found = self.seen(material, v, l, images=[image], tangent=[0, 1, 0, w])
            self.assert_close(found, [dot(world, l) / math.pi] * 3, 0.01, w)


if __name__ == "__main__":
    unittest.main()
