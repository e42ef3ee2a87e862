"""glTF's extensions of materials against the formulas that Khronos gives for them, evaluated here.

The square of gltf_file shows one value of the BRDF times the cosine: a directional light of 1, one direction of view.
"""

import cmath
import functools
import math
import unittest

import exr
from gltf_file import direction, lit_square, normalized, png
from support import DONE, CliTest


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def ggx(v, l, alpha_t, alpha_b, tangent):
    """D V of KHR_materials_anisotropy for the normal +z; isotropic where both alphas are the same."""
    n, t = (0, 0, 1), (math.cos(tangent), math.sin(tangent), 0)
    b = (-t[1], t[0], 0)
    h = normalized([x + y for x, y in zip(v, l)])
    f = (dot(t, h) / alpha_t) ** 2 + (dot(b, h) / alpha_b) ** 2 + dot(n, h) ** 2
    d = 1 / (math.pi * alpha_t * alpha_b * f * f)

    def stretched(w):
        return math.hypot(alpha_t * dot(t, w), alpha_b * dot(b, w), dot(n, w))

    return d * 0.5 / (dot(n, l) * stretched(v) + dot(n, v) * stretched(l))


def schlick(f0, f90, v, l):
    h = normalized([x + y for x, y in zip(v, l)])
    return [a + (f90 - a) * (1 - dot(v, h)) ** 5 for a in f0]


def fresnel_reflectance(cosine, n):
    """The share of unpolarised light that the border of a dielectric of index n reflects."""
    inside = math.sqrt(1 - (1 - cosine**2) / n**2)
    return (((cosine - n * inside) / (cosine + n * inside)) ** 2 + ((inside - n * cosine) / (inside + n * cosine)) ** 2) / 2


def matching(nm):
    """The colour matching functions of CIE 1931 (Wyman, Sloan and Shirley 2013)."""
    def lobe(peak, centre, left, right):
        return peak * math.exp(-0.5 * ((nm - centre) / (left if nm < centre else right)) ** 2)

    return (lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) - lobe(0.065, 501.1, 20.4, 26.2),
            lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1), lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8))


def film_colour(eta, thickness, n, cosine):
    """Reflectance, as R, G, B, of a film of so many nm on a surface of index n: Airy's sum over the spectrum, mean of both polarisations."""
    cos_film, cos_n = (math.sqrt(1 - (1 - cosine**2) / i**2) for i in (eta, n))
    pairs = (cosine, eta * cos_film, n * cos_n), (1 / cosine, eta / cos_film, n / cos_n)
    total, white = [0, 0, 0], [0, 0, 0]
    for nm in range(360, 831, 2):
        turn = cmath.exp(2j * math.pi * 2 * eta * thickness * cos_film / nm)
        reflectance = 0
        for a, b, c in pairs:
            first, second = (a - b) / (a + b), (b - c) / (b + c)
            reflectance += 0.5 * abs((first + second * turn) / (1 + first * second * turn)) ** 2
        for k, m in enumerate(matching(nm)):
            total[k] += reflectance * m
            white[k] += m
    rows = (3.2404542, -1.5371385, -0.4985314), (-0.969266, 1.8760108, 0.041556), (0.0556434, -0.2040259, 1.0572252)
    return [dot(row, total) / dot(row, white) for row in rows]


@functools.cache
def albedo(f0, alpha, cosine, side=64):
    """Share of the light from this direction that the border reflects: the mean over cosine-weighted directions."""
    v = (math.sqrt(1 - cosine * cosine), 0, cosine)
    total = 0
    for i in range(side):
        r = math.sqrt((i + 0.5) / side)
        for j in range(side):
            phi = 2 * math.pi * (j + 0.5) / side
            l = (r * math.cos(phi), r * math.sin(phi), math.sqrt(1 - r * r))
            total += math.pi * ggx(v, l, alpha, alpha, 0) * schlick([f0], 1, v, l)[0]
    return total / side**2


@functools.cache
def mean_albedo(f0, alpha, steps=12):
    """The same of light from all around."""
    return sum(albedo(f0, alpha, math.sqrt((i + 0.5) / steps)) for i in range(steps)) / steps


def later_reflections(f0, alpha, v):
    """Factor on what a metal's border reflects once: 1 + R (1 - E) / E with the light that meets several facets (Kulla and Conty 2017)."""
    kept, mean, fresnel = albedo(1, alpha, v[2]), mean_albedo(1, alpha), f0 + (1 - f0) / 21
    return 1 + fresnel * mean / (1 - fresnel * (1 - mean)) * (1 - kept) / kept


def metal(f0, alpha_t, alpha_b, tangent, v, l):
    """The pixel of a metal of this colour at the normal; anisotropic ones have the later reflections of their mean square roughness."""
    once = ggx(v, l, alpha_t, alpha_b, tangent) * l[2]
    mean = math.sqrt((alpha_t**2 + alpha_b**2) / 2)
    return [f * once * later_reflections(c, mean, v) for c, f in zip(f0, schlick(f0, 1, v, l))]


PAIRS = ((direction(0, 0), direction(0, 0)), (direction(30, 40), direction(30, 40)), (direction(0, 20), direction(90, 35)),
         (direction(100, 50), direction(70, 45)))
BLACK = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0, "roughnessFactor": 0.5}


class GltfMaterials(CliTest):
    def seen(self, material, v, l, spp=4, **more):
        self.write("a.gltf", lit_square(material, v, l, **more))
        result = self.run_program("render", "a.gltf", "-o", "a.exr", "--method", "uniform", "--spp", str(spp), "--resolution", "4x4",
                                  "--max-depth", "1", "--progress", "none")
        self.assertEqual(result.code, DONE, result)
        self.assertNotIn("left out", result.stderr)
        pixels = exr.read(self.folder / "a.exr").pixels
        return [sum(pixels[c]) / 16 for c in "RGB"]

    def assert_close(self, found, expected, relative, about):
        for a, b in zip(found, expected):
            self.assertLess(abs(a - b), relative * abs(b) + 1e-5, f"{about}: {found}, expected {expected}")

    def test_the_square_is_a_plain_material_first(self):
        gold = [1, 0.6, 0.3]
        for v, l in PAIRS:
            found = self.seen({"pbrMetallicRoughness": {"baseColorFactor": [*gold, 1], "roughnessFactor": 0.6}}, v, l)
            self.assert_close(found, metal(gold, 0.36, 0.36, 0, v, l), 0.02, (v, l))

    def test_anisotropy(self):
        gold, alpha = [1, 0.6, 0.3], 0.3 ** 2
        # The texture turns the tangent by 90 degrees and halves the strength.
        turned = png(2, 2, [(128, 255, 128, 255)] * 4)
        for strength, rotation, textured in ((0.7, 0, False), (0.7, 0.6, False), (0.4, 1.5, False), (0.7, -2.2, False), (0.9, 0.4, True)):
            extension = {"anisotropyStrength": strength, "anisotropyRotation": rotation}
            if textured:
                extension["anisotropyTexture"] = {"index": 0}
            share = strength * (128 / 255 if textured else 1)
            along = alpha + (1 - alpha) * share ** 2
            tangent = rotation + (math.pi / 2 if textured else 0)
            for v, l in PAIRS:
                found = self.seen({"pbrMetallicRoughness": {"baseColorFactor": [*gold, 1], "roughnessFactor": 0.3},
                                   "extensions": {"KHR_materials_anisotropy": extension}}, v, l, images=[turned] if textured else [])
                expected = metal(gold, along, alpha, tangent, v, l)
                self.assert_close(found, expected, 0.03, (strength, rotation, textured, v, l))

    def test_anisotropy_follows_mirrored_coordinates(self):
        # Where u runs to the left, so does the tangent; where v is turned, so is the bitangent.
        mirrored_u = ((100, 100), (0, 100), (0, 0), (100, 0))
        mirrored_v = ((0, 0), (100, 0), (100, 100), (0, 100))
        v, l = direction(20, 30), direction(50, 40)
        for uv, tangent in ((mirrored_u, math.pi - 0.5), (mirrored_v, -0.5)):
            found = self.seen({"pbrMetallicRoughness": {"roughnessFactor": 0.3},
                               "extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 0.8, "anisotropyRotation": 0.5}}}, v, l, uv=uv)
            self.assert_close(found, metal([1, 1, 1], 0.09 + 0.91 * 0.64, 0.09, tangent, v, l), 0.03, uv)

    def test_diffuse_transmission(self):
        colour, factor = [0.9, 0.5, 0.1], 0.6
        half = png(2, 2, [(0, 0, 0, 128)] * 4)
        matt = {"KHR_materials_specular": {"specularFactor": 0}}
        for images, share in (([], factor), ([half], factor * 128 / 255)):
            extension = {"diffuseTransmissionFactor": factor, "diffuseTransmissionColorFactor": colour}
            if images:
                extension["diffuseTransmissionTexture"] = {"index": 0}
            material = {"pbrMetallicRoughness": BLACK, "extensions": matt | {"KHR_materials_diffuse_transmission": extension}}
            for v, l in ((direction(0, 0), direction(0, 180)), (direction(30, 40), direction(80, 120)), (direction(0, 140), direction(0, 20))):
                expected = [share * c / math.pi * abs(l[2]) for c in colour]
                self.assert_close(self.seen(material, v, l, spp=2048, images=images), expected, 0.03, (v, l))
            self.assert_close(self.seen(material, *PAIRS[1], images=images), [0, 0, 0], 0, PAIRS[1])

    def test_rough_panes(self):
        """Without a volume light passes by the lobe that it is reflected by, mirrored; a pane's two faces reflect 2R/(1 + R)."""
        colour, alpha = [0.9, 0.5, 0.1], 0.6 ** 2
        material = {"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": 0.6},
                    "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}
        for v, l in PAIRS:
            fresnel = fresnel_reflectance(dot(v, normalized([x + y for x, y in zip(v, l)])), 1.5)
            reflected = 2 * fresnel / (1 + fresnel)
            lobe = ggx(v, l, alpha, alpha, 0) * l[2] / albedo(1, alpha, v[2])
            self.assert_close(self.seen(material, v, l), [reflected * lobe] * 3, 0.02, (v, l))
            below = (l[0], l[1], -l[2])
            self.assert_close(self.seen(material, v, below), [(1 - reflected) * c * lobe for c in colour], 0.02, (v, below))

    def test_iridescence(self):
        film = {"iridescenceFactor": 0.7, "iridescenceIor": 1.8, "iridescenceThicknessMinimum": 100, "iridescenceThicknessMaximum": 500}
        textured = {**film, "iridescenceThicknessTexture": {"index": 0}, "iridescenceTexture": {"index": 0}}
        image = png(2, 2, [(128, 51, 0, 255)] * 4)  # half of the weight, a fifth of the way from least to most
        for v, l in PAIRS:
            cosine = dot(v, normalized([x + y for x, y in zip(v, l)]))
            for extension, weight, thickness in ((film, 0.7, 500), (textured, 0.7 * 128 / 255, 180)):
                found = self.seen({"pbrMetallicRoughness": BLACK, "extensions": {"KHR_materials_iridescence": extension}}, v, l,
                                  images=[image] if extension is textured else [])
                share = [(1 - weight) * bare + weight * coloured
                         for bare, coloured in zip(schlick([0.04] * 3, 1, v, l), film_colour(1.8, thickness, 1.5, cosine))]
                # The spectrum is known to some hundredths of the strongest colour
                scale = ggx(v, l, 0.25, 0.25, 0) * l[2]
                for a, b in zip(found, share):
                    self.assertAlmostEqual(a / scale, b, delta=0.06 * max(share), msg=f"{thickness} nm at {v} {l}: {found} / {scale}, {share}")

    def test_specular(self):
        colour, factor, ior = [1, 0.5, 0.1], 0.6, 1.7
        f0 = [min(1, c * ((ior - 1) / (ior + 1)) ** 2) * factor for c in colour]
        extensions = {"KHR_materials_specular": {"specularFactor": factor, "specularColorFactor": colour}, "KHR_materials_ior": {"ior": ior}}
        for v, l in PAIRS:
            found = self.seen({"pbrMetallicRoughness": BLACK, "extensions": extensions}, v, l)
            self.assert_close(found, [f * ggx(v, l, 0.25, 0.25, 0) * l[2] for f in schlick(f0, factor, v, l)], 0.04, (v, l))
        # At grazing angles Fresnel's curve is not Schlick's.
        v, l = direction(0, 75), direction(180, 75)
        found = self.seen({"pbrMetallicRoughness": BLACK, "extensions": extensions}, v, l)
        self.assert_close(found, [f * ggx(v, l, 0.25, 0.25, 0) * l[2] for f in schlick(f0, factor, v, l)], 0.2, (v, l))

    def test_specular_textures(self):
        # The alpha of one, and the sRGB colour of the other: 188 is 0.503 when it is decoded.
        images = [png(2, 2, [(0, 0, 0, 51)] * 4), png(2, 2, [(255, 188, 0, 255)] * 4)]
        extension = {"specularTexture": {"index": 0}, "specularColorTexture": {"index": 1}, "specularColorFactor": [1, 1, 1]}
        v = l = direction(30, 40)
        found = self.seen({"pbrMetallicRoughness": BLACK, "extensions": {"KHR_materials_specular": extension}}, v, l, images=images)
        self.assert_close(found, [0.2 * 0.04 * c * ggx(v, l, 0.25, 0.25, 0) * l[2] for c in (1, 0.503, 0)], 0.03, "textures")

    def test_specular_leaves_the_base_its_hue(self):
        # Without any specular reflection all light is diffuse.
        v, l = direction(0, 30), direction(90, 60)
        white = {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 0.5}
        found = self.seen({"pbrMetallicRoughness": white, "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}, v, l)
        self.assert_close(found, [l[2] / math.pi] * 3, 0.003, "no specular")
        red = {"KHR_materials_specular": {"specularColorFactor": [20, 0, 0]}}
        found = self.seen({"pbrMetallicRoughness": white | {"roughnessFactor": 0.1}, "extensions": red}, v, l)
        # The light that the strongest channel reflects is missing from all of them (far from the highlight).
        self.assertAlmostEqual(found[0], found[1], delta=0.002)
        self.assert_close(found, [(1 - 0.8) * l[2] / math.pi] * 3, 0.1, "red specular")

    def test_specular_glossiness(self):
        diffuse, specular, glossiness = [0.8, 0.4, 0.1], [0.3, 0.2, 0.05], 0.6
        alpha = (1 - glossiness) ** 2
        extension = {"diffuseFactor": [*diffuse, 1], "specularFactor": specular, "glossinessFactor": glossiness}
        material = {"extensions": {"KHR_materials_pbrSpecularGlossiness": extension}}
        images = [png(1, 1, [(188, 188, 188, 255)]), png(1, 1, [(255, 255, 255, 128)])]
        textured = {"extensions": {"KHR_materials_pbrSpecularGlossiness":
                                   extension | {"diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1}}}}
        for v, l in PAIRS:
            for what, of_diffuse, a, arguments in ((material, 1, alpha, {}), (textured, 0.503, (1 - glossiness * 128 / 255) ** 2, {"images": images})):
                fresnel = schlick(specular, 1, v, l)
                shine = [f * ggx(v, l, a, a, 0) for f in fresnel]
                # Khronos has 1 - F for the light that reaches the base; what a rough border really leaves it is known by its albedo.
                left = (1 - albedo(max(specular), a, v[2])) * (1 - albedo(max(specular), a, l[2])) / (1 - mean_albedo(max(specular), a))
                self.assertLess(abs(left / (1 - max(fresnel)) - 1), 0.15)
                base = [left * (1 - max(specular)) * of_diffuse * d / math.pi for d in diffuse]
                self.assert_close(self.seen(what, v, l, **arguments), [(s + b) * l[2] for s, b in zip(shine, base)], 0.03, (v, l, what))

    def test_alpha_of_specular_glossiness(self):
        extension = {"diffuseFactor": [1, 1, 1, 0.2]}
        v = l = direction(0, 30)
        for mode, seen in (("MASK", False), ("OPAQUE", True)):
            material = {"alphaMode": mode, "extensions": {"KHR_materials_pbrSpecularGlossiness": extension}}
            self.write("a.gltf", lit_square(material, v, l))
            told = self.run_program("info", "a.gltf")
            self.assertEqual("no shapes" not in told.stdout, seen, told)


if __name__ == "__main__":
    unittest.main()
