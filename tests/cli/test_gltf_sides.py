"""glTF's one-sided surfaces: the camera sees their fronts, light meets both sides."""

import json
import re
import unittest

import exr
from gltf_file import direction, lit_square
from support import DONE, CliTest

UP, DOWN = direction(0, 0), direction(0, 180)
MATT = {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0}}
TWO_SIDED = {"doubleSided": True}
MIRROR = {"pbrMetallicRoughness": {"roughnessFactor": 0}}


class Sides(CliTest):
    def seen(self, text):
        """Green in the middle, and whether there is a surface."""
        self.write("a.gltf", text)
        result = self.run_program("render", "a.gltf", "-o", "a.exr", "--method", "uniform", "--spp", "4", "--resolution", "4x4", "--progress", "none")
        self.assertEqual(result.code, DONE, result)
        pixels = exr.read(self.folder / "a.exr").pixels
        return pixels["G"][5], pixels.get("A", [1] * 16)[5] == 1

    @staticmethod
    def with_card(material, light, rotation, height=10, base=MATT):
        """A large square seen from above, and before it a small card of `material`, turned by `rotation`."""
        file = json.loads(lit_square(base, UP, light))
        file["materials"].append(material)
        primitive = file["meshes"][0]["primitives"][0]
        file["meshes"].append({"primitives": [primitive | {"material": 1}]})
        file["nodes"].append({"mesh": 1, "scale": [0.1, 0.1, 0.1], "translation": [0, 0, height], "rotation": rotation})
        return json.dumps(file)

    def test_the_camera_sees_fronts(self):
        lit, is_there = self.seen(lit_square(MATT, UP, UP))
        self.assertTrue(is_there)
        self.assertEqual(self.seen(lit_square(MATT, DOWN, DOWN)), (0, False))
        for more in (TWO_SIDED, {"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}):
            self.assertTrue(self.seen(lit_square(MATT | more, DOWN, DOWN))[1], more)
        self.assertAlmostEqual(self.seen(lit_square(MATT | TWO_SIDED, DOWN, DOWN))[0], lit, delta=1e-4)

    def test_mirrored_nodes_keep_their_fronts(self):
        # A transform that mirrors turns the rule of winding about, too: only z moves the front.
        for scale, is_there in (([1, 1, -1], False), ([-1, 1, 1], True), ([-1, -1, 1], True)):
            file = json.loads(lit_square(MATT, UP, UP))
            file["nodes"][0]["scale"] = scale
            self.assertEqual(self.seen(json.dumps(file))[1], is_there, scale)

    def test_what_is_behind_a_back_is_seen_in_its_shadow(self):
        over, slant = [1, 0, 0, 0], direction(0, 70)  # the slanted light leaves the card's shadow beside the view
        alone = self.seen(lit_square(MATT, UP, slant))[0]
        card = MATT | {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}}
        self.assertAlmostEqual(self.seen(self.with_card(card, slant, over))[0], alone, delta=0.02 * alone)
        self.assertLess(self.seen(self.with_card(card | TWO_SIDED, slant, over))[0], 0.2 * alone)
        self.assertLess(self.seen(self.with_card(card, slant, [0, 0, 0, 1]))[0], 0.2 * alone)
        # Light does not pass what the camera passes.
        under = self.seen(lit_square(MATT, UP, UP))[0]
        self.assertLess(self.seen(self.with_card(card, UP, over))[0], 0.05 * under)

    def test_a_lamp_at_the_camera_stands_behind_the_backs(self):
        black = {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}}
        heights = []
        for material in (black, black | TWO_SIDED):
            self.write("a.gltf", self.with_card(material, UP, [1, 0, 0, 0]))
            result = self.run_program("render", "a.gltf", "-o", "a.exr", "--method", "uniform", "--spp", "1", "--resolution", "4x4", "--light", "camera")
            self.assertEqual(result.code, DONE, result)
            heights.append(max(abs(float(v)) for v in re.search(r'"([^" ]*) power', result.stderr)[1].split(",")))
        behind, before = heights
        self.assertAlmostEqual(behind, 10, delta=0.01)  # the card hangs there
        self.assertGreater(before, 20)

    def test_mirrors_show_fronts_too(self):
        # The card hangs face down over a mirror: the camera looks through its back and sees its front below.
        shining = MATT | {"emissiveFactor": [0.5, 0.5, 0.5]}
        self.assertAlmostEqual(self.seen(self.with_card(shining, UP, [1, 0, 0, 0], base=MIRROR))[0], 0.5, delta=0.05)


if __name__ == "__main__":
    unittest.main()
