"""Values of Blender's nodes that hang on the angle of sight, and how few textures tell them, without Blender."""

import unittest

import numpy as np

import without_blender  # before the package
from covtrace_blender import baking
from covtrace_blender.shader_nodes.evaluator import Evaluator, evaluated_at
from covtrace_blender.shader_nodes.place import UvPlace
from covtrace_blender.values import Between, ByAngle
from test_shader_nodes import UV, Node, coordinate, input_of, maths

COSINES = np.linspace(0, 1, 2001)


def fresnel(index):
    return Node("FRESNEL", {"IOR": index}, {"Factor": "VALUE"})


def facing(blend):
    return Node("LAYER_WEIGHT", {"Blend": blend}, {"Facing": "VALUE"})


def reflectance(cosine, eta):
    """Fresnel's, as Cycles has it, which is that from within behind the surface."""
    c, eta = np.abs(cosine), np.where(cosine < 0, 1 / eta, eta)
    g = np.sqrt(np.maximum(eta**2 - 1 + c**2, 1e-12))
    a, b = (g - c) / (g + c), (c * (g + c) - 1) / (c * (g - c) + 1)
    return np.where(eta**2 - 1 + c**2 > 0, 0.5 * a**2 * (1 + b**2), 1)


def power(cosine, blend):
    """Layer Weight's Facing, as Cycles has it."""
    return 1 - cosine ** (2 * blend if blend < 0.5 else 0.5 / (1 - blend))


def mixed(share, first, second):
    """A number between two others."""
    return maths("ADD", (maths("MULTIPLY", (maths("SUBTRACT", 1.0, share), 0), first), 0), (maths("MULTIPLY", share, second), 0))


class SightTest(unittest.TestCase):
    def baked(self, node, output=0, **options):
        socket = input_of(node, output)
        return baking.Baker(lambda image: image.values).bake(lambda nodes: nodes.number(socket), baking.Surface(), **options)

    def test_few_constants_tell_borders_and_facing(self):
        cases = [(fresnel(index), lambda c, index=index: reflectance(c, index), -1) for index in (1.05, 1.2, 1.45, 1.8, 2.5)]
        cases += [(facing(blend), lambda c, blend=blend: power(c, blend), 0) for blend in (0.2, 0.35, 0.5, 0.8, 0.95)]
        for node, exact, first in cases:
            with self.subTest(node.type, inputs=node.inputs[0].default_value):
                value = self.baked(node).value()
                self.assertIsInstance(value, ByAngle)
                self.assertTrue((np.diff(value.cosines) > 0).all() and value.cosines[0] == first and value.cosines[-1] == 1)
                self.assertLessEqual(sum(cosine >= 0 for cosine in value.cosines), 20)
                for cosines in (COSINES, *([-COSINES[1:]] if first < 0 else [])):
                    found = np.interp(cosines, value.cosines, [part.constant for part in value.parts])
                    errors = np.abs(found - exact(cosines))
                    self.assertLess(errors.mean(), 0.003)
                    if cosines is COSINES:  # at the critical angle, behind the surface, the slope has no bound
                        self.assertLess(errors.max(), 0.01)

    def test_edges_of_ramps_stay_sharp(self):
        value = self.baked(maths("GREATER_THAN", (facing(0.5), 0), 0.3)).value()
        found = np.interp(COSINES, value.cosines, [part.constant for part in value.parts])
        self.assertLess(np.mean(np.abs(found - (1 - COSINES > 0.3))), 0.01)

    def test_both_sides_are_told_apart(self):
        geometry = Node("NEW_GEOMETRY", outputs={"Backfacing": "VALUE"})
        value = self.baked(geometry).value()
        found = np.interp((-1, -0.3, -1e-5, 0, 0.2, 1), value.cosines, [part.constant for part in value.parts])
        np.testing.assert_allclose(found, (1, 1, 1, 0, 0, 0), atol=1e-6)

    def test_extremes_of_both_nodes_are_numbers(self):
        for node in (fresnel(0.0), fresnel(0.7), fresnel(1.0), fresnel(1000.0), facing(-1.0), facing(0.0), facing(1.0), facing(7.0)):
            with self.subTest(node.type, inputs=node.inputs[0].default_value):
                nodes = Evaluator(UvPlace(np.zeros((2001, 2), np.float32), None))
                nodes.place.sight = np.linspace(-1, 1, 2001)
                values = nodes.number(input_of(node))
                self.assertTrue(((values >= 0) & (values <= 1)).all())

    def test_what_the_angle_mixes_is_two_images(self):
        index = 1.6
        value = self.baked(mixed((fresnel(index), 0), coordinate(0), coordinate(1))).value()
        self.assertIsInstance(value, Between)
        shares = np.interp(COSINES, value.share.cosines, [part.constant for part in value.share.parts])
        first, second = (image.image.values[..., 0] for image in (value.first, value.second))
        v, u = np.mgrid[:first.shape[0], :first.shape[1]] + 0.5
        u, v = u / first.shape[1], 1 - v / first.shape[0]
        for k in (0, 400, 1000, 2000):
            share = reflectance(COSINES[k], index)
            np.testing.assert_allclose((1 - shares[k]) * first + shares[k] * second, (1 - share) * u + share * v, atol=0.01)

    def test_all_else_is_a_handful_of_smaller_images(self):
        product = maths("MULTIPLY", (facing(0.5), 0), coordinate(0))
        waves = maths("SINE", (maths("MULTIPLY", (product, 0), 5.0), 0))
        value = self.baked(maths("MULTIPLY_ADD", (waves, 0), 0.5, 0.5)).value()
        self.assertIsInstance(value, ByAngle)
        self.assertTrue(2 < len(value.parts) <= 6)
        for part in value.parts:
            self.assertLessEqual(max(part.image.values.shape[:2]), baking.LARGEST // 2)
        u = (np.arange(value.parts[0].image.values.shape[1]) + 0.5) / value.parts[0].image.values.shape[1]
        rows = np.array([part.image.values[0, :, 0] for part in value.parts])
        for cosine in (0, 0.2, 0.5, 0.9, 1):
            found = [np.interp(cosine, value.cosines, column) for column in rows.T]
            self.assertLess(np.mean(np.abs(found - (np.sin((1 - cosine) * u * 5) * 0.5 + 0.5))), 0.03)

    def test_means_remain_where_no_texture_may_be(self):
        baked = self.baked(facing(0.5), by_angle=False)
        self.assertTrue(baked.is_mean)
        self.assertAlmostEqual(float(baked.constant), 1 / 3, delta=0.01)
        self.assertFalse(self.baked(maths("ADD", 1.0, 2.0), by_angle=False).is_mean)

    def test_only_what_hangs_on_the_angle_is_evaluated_again(self):
        asked = []

        class Place(UvPlace):
            def uv_of(self, node, name):
                asked.append(node)
                return super().uv_of(node, name)

        socket = input_of(mixed((fresnel(1.5), 0), coordinate(0), 0.5))
        values = evaluated_at(lambda nodes: nodes.number(socket), Place(np.array([[0.2, 0], [0.8, 0]], np.float32), None), (0, 0.5, 1), 2, 1)
        shares = reflectance(np.array([0, 0.5, 1]), 1.5)
        np.testing.assert_allclose(values, [[(1 - share) * u + share * 0.5 for share in shares] for u in (0.2, 0.8)], atol=1e-5)
        self.assertEqual(len(asked), 1)


if __name__ == "__main__":
    unittest.main()
