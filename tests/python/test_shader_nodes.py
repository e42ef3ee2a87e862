"""The values of Blender's shader nodes, and their images, without Blender: nodes are plain objects with its attributes."""

import types
import unittest

import numpy as np

import without_blender  # before the package
from covtrace_blender import baking
from covtrace_blender.shader_nodes import hashing, images, noise, voronoi
from covtrace_blender.shader_nodes.evaluator import Evaluator
from covtrace_blender.shader_nodes.flat import flat_socket
from covtrace_blender.shader_nodes.place import UvPlace
from covtrace_blender.shader_nodes.unsupported import Unsupported


class Socket:
    def __init__(self, node, name, kind, value=None, is_output=False):
        self.node, self.name, self.identifier, self.is_output = node, name, name, is_output
        self.type, self.default_value, self.links, self.id_data = kind, value, [], None

    @property
    def is_linked(self):
        return bool(self.links)


class Node:
    """inputs: {name: a number, a colour or (node, output's index)}; outputs: {name: type}."""

    count = 0

    def __init__(self, kind, inputs=None, outputs=None, **settings):
        Node.count += 1
        self.type, self.name, self.mute = kind, f"{kind} {Node.count}", False
        self.__dict__.update(settings)
        self.outputs = [Socket(self, name, type_, is_output=True) for name, type_ in (outputs or {"Color": "RGBA"}).items()]
        self.inputs = []
        for name, value in (inputs or {}).items():
            is_link = isinstance(value, tuple) and isinstance(value[0], Node)
            is_vector = hasattr(value, "__len__") and not is_link
            socket = Socket(self, name, "RGBA" if is_vector else "VALUE", None if is_link else value)
            if is_link:
                socket.links.append(types.SimpleNamespace(from_node=value[0], from_socket=value[0].outputs[value[1]],
                                                          is_valid=True, is_muted=False))
            self.inputs.append(socket)


def input_of(node, output=0):
    """A socket that the node's output is linked to."""
    return flat_socket(Node("END", {"end": (node, output)}).inputs[0])


UV = Node("TEX_COORD", outputs={"UV": "VECTOR"}, object=None)


def maths(operation, *values, use_clamp=False):
    return Node("MATH", {str(i): v for i, v in enumerate(values)}, {"Value": "VALUE"}, operation=operation, use_clamp=use_clamp)


def coordinate(axis):
    return Node("SEPXYZ", {"Vector": (UV, 0)}, {"X": "VALUE", "Y": "VALUE", "Z": "VALUE"}), axis


def evaluated(socket, uv=((0.25, 0.5),), is_vector=False):
    nodes = Evaluator(UvPlace(np.array(uv, np.float32), lambda image: image.values))
    return (nodes.vector if is_vector else nodes.number)(socket)


class NodesTest(unittest.TestCase):
    def test_constants_have_no_places(self):
        value = evaluated(input_of(maths("MULTIPLY", (maths("ADD", 1.0, 2.0), 0), 4.0)))
        self.assertEqual(value.shape, ())
        self.assertEqual(float(value), 12)

    def test_links_convert_as_blender_does(self):
        colour = Node("RGB")
        colour.outputs[0].default_value = (0.2, 0.4, 0.6, 1)
        self.assertAlmostEqual(float(evaluated(input_of(colour))), 0.2126 * 0.2 + 0.7152 * 0.4 + 0.0722 * 0.6, places=6)
        # Vectors become their mean, and numbers all three components.
        np.testing.assert_allclose(evaluated(input_of(UV)), [0.25])
        np.testing.assert_allclose(evaluated(input_of(*coordinate(1)), is_vector=True), [[0.5, 0.5, 0.5]])

    def test_groups_hand_their_inputs_in(self):
        inside = Node("GROUP_INPUT", outputs={"number": "VALUE"})
        end = Node("GROUP_OUTPUT", {"result": (maths("MULTIPLY", (inside, 0), 2.0), 0)}, is_active_output=True)
        tree = types.SimpleNamespace(nodes=[inside, end])
        first = Node("GROUP", {"number": coordinate(0)}, {"result": "VALUE"}, node_tree=tree)
        second = Node("GROUP", {"number": (first, 0)}, {"result": "VALUE"}, node_tree=tree)
        np.testing.assert_allclose(evaluated(input_of(second)), [1.0])

    def test_what_has_no_counterpart_is_named(self):
        with self.assertRaisesRegex(Unsupported, "node 'LIGHT_PATH"):
            evaluated(input_of(maths("ADD", (Node("LIGHT_PATH"), 0), 1.0)))
        checker = Node("TEX_CHECKER", {"Vector": 0.0, "Scale": 5.0, "Color1": (1, 0, 0), "Color2": (0, 0, 1)})
        with self.assertRaisesRegex(Unsupported, "generated coordinates"):
            evaluated(input_of(checker), is_vector=True)

    def test_hashes_are_lookup3(self):
        """Against the hash of plain whole numbers, of which every step is reduced to 32 bits."""
        def rotated(x, k):
            return (x << k | x >> 32 - k) & 0xFFFFFFFF

        x, y, z = 12345, 4000000000, 7
        a, b, c = ((0xDEADBEEF + 12 + 13 + key) & 0xFFFFFFFF for key in (x, y, z))
        for target, other, k in (("c", "b", 14), ("a", "c", 11), ("b", "a", 25), ("c", "b", 16), ("a", "c", 4), ("b", "a", 14), ("c", "b", 24)):
            v = {"a": a, "b": b, "c": c}
            v[target] = ((v[target] ^ v[other]) - rotated(v[other], k)) & 0xFFFFFFFF
            a, b, c = v["a"], v["b"], v["c"]
        found = hashing.hashed(*(np.array([k], np.uint32) for k in (x, y, z)))
        self.assertEqual(int(found[0]), c)

    def test_noise_is_the_same_however_far_places_lie_apart(self):
        """Lattices are tables for places close together, and computed place by place for others."""
        places = np.random.default_rng(1).uniform(-3, 3, (500, 3)).astype(np.float32)
        near = noise.signed_noise(places)
        far = np.array([noise.signed_noise(np.vstack((p, p + 1e5)))[0] for p in places[:20]])
        np.testing.assert_allclose(near[:20], far, atol=1e-6)
        self.assertLess(abs(near.mean()), 0.1)
        self.assertGreater(near.std(), 0.2)
        whole = noise.signed_noise(np.array([[1, 2, 3], [4, -5, 6]], np.float32))
        np.testing.assert_allclose(whole, 0, atol=1e-6)

    def test_cells_are_nearest_to_their_points(self):
        """Against all points of a block of cells, one by one."""
        places = np.random.default_rng(2).uniform(0, 4, (50, 3)).astype(np.float32)
        def euclid(d):
            return voronoi.METRICS["EUCLIDEAN"](d, None)

        cells = np.stack(np.meshgrid(*[np.arange(-2, 7)] * 3, indexing="ij"), -1).reshape(-1, 3).astype(np.float32)
        points = cells + hashing.hashed_vector(*cells.T)
        all_distances = np.sort(np.linalg.norm(places[:, None] - points, axis=-1), axis=1)
        for rank in (0, 1):
            distance, _, position = voronoi.nearest(places, 1, euclid, rank == 1)
            # Blender looks into the neighbouring cells alone, which are enough for the nearest of most places.
            close = np.isclose(distance, all_distances[:, rank], atol=1e-4)
            self.assertGreater(close.mean(), 0.85)
            np.testing.assert_allclose(np.linalg.norm(position - places, axis=1), distance, atol=1e-4)

    def test_images_are_interpolated_and_wrapped(self):
        pixels = np.zeros((2, 2, 4), np.float32)
        pixels[1, 0] = 1  # at the bottom left
        uv = np.array([[0.25, 0.25], [0.5, 0.25], [1.25, 0.25], [0.25, 0.75]], np.float32)
        for extension, expected in (("REPEAT", (1, 0.5, 1, 0)), ("EXTEND", (1, 0.5, 0, 0)), ("CLIP", (1, 0.5, 0, 0))):
            np.testing.assert_allclose(images.sample(pixels, uv, extension, False)[:, 0], expected, err_msg=extension)


class BakingTest(unittest.TestCase):
    def bake(self, node, output=0, ranges=None, **options):
        socket = input_of(node, output)
        baker = baking.Baker(lambda image: image.values)
        return baker.bake(lambda nodes: nodes.number(socket), baking.Surface({"": ranges} if ranges else None), **options)

    def test_constants_stay_constants(self):
        baked = self.bake(maths("ADD", 1.0, 2.0))
        self.assertIsNone(baked.image)
        self.assertEqual(float(baked.constant), 3)

    def test_images_show_the_nodes(self):
        baked = self.bake(maths("MULTIPLY", coordinate(0), coordinate(1)))
        values = baked.image.values[..., 0]
        self.assertEqual(values.shape, (512, 512))
        self.assertTrue(baked.layout.is_unit_square())
        # From the top: the first row is at v = 1.
        self.assertAlmostEqual(values[0, -1], (511.5 / 512) ** 2, places=5)
        self.assertAlmostEqual(values[-1, -1], 511.5 / 512 * 0.5 / 512, places=5)

    def test_what_needs_it_gets_a_finer_image(self):
        stripes = maths("GREATER_THAN", (maths("SINE", (maths("MULTIPLY", coordinate(0), 900.0), 0)), 0), 0.0)
        self.assertEqual(self.bake(stripes).image.values.shape, (2048, 2048, 3))

    def test_ranges_beyond_the_unit_square(self):
        ranges = ((-1.0, 0.0), (3.0, 2.0))
        tiled = self.bake(maths("FRACT", coordinate(0)), ranges=ranges)
        self.assertTrue(tiled.layout.is_unit_square())
        self.assertEqual(tiled.layout.wrap, "repeat")
        every_second = self.bake(maths("PINGPONG", coordinate(0), 1.0), ranges=ranges)
        self.assertEqual((tuple(every_second.layout.extent), every_second.layout.wrap), ((2, 2), "repeat"))
        whole = self.bake(*coordinate(0), ranges=ranges)
        self.assertEqual((tuple(whole.layout.low), tuple(whole.layout.extent), whole.layout.wrap), ((-1, 0), (4, 2), "clamp"))
        np.testing.assert_allclose(whole.image.values[0, [0, -1], 0], (-1 + 2 / 512, 3 - 2 / 512), atol=0.01)
        # (u, v) times scale plus offset are the image's own coordinates.
        su, sv, du, dv = whole.layout.mapping()
        np.testing.assert_allclose((-1 * su + du, 3 * su + du, 0 * sv + dv, 2 * sv + dv), (0, 1, 0, 1), atol=1e-9)
        small = self.bake(*coordinate(0), ranges=((0.2, 0.2), (0.3, 0.9)))
        np.testing.assert_allclose((small.layout.low[0], small.layout.extent[0]), (0.198, 0.104), atol=1e-4)


if __name__ == "__main__":
    unittest.main()
