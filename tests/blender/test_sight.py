"""Materials that hang on the angle of sight, on balls beside Cycles."""

import bpy
import numpy as np
from addon_support import CyclesTest, render
from node_trees import BLUE, ORANGE, Tree

SIZE = 48  # pixels of the picture's height
RINGS = (0, 0.5, 0.8, 0.9, 0.96)  # of the ball's radius; pixels' filters of both show what is beyond it at its very rim


class SightTest(CyclesTest):
    def setUp(self):
        super().setUp()
        self.camera.data.type, self.camera.data.ortho_scale = "ORTHO", 2.1
        self.scene.render.resolution_x = self.scene.render.resolution_y = SIZE
        self.scene.covtrace.method = "uniform"
        self.background.inputs["Color"].default_value = (0.6, 0.5, 0.4, 1)
        self.scene.cycles.transparent_max_bounces = 8

    # -- nodes

    @staticmethod
    def facing(tree, blend=0.35):
        return tree.node("LayerWeight", None, {"Blend": blend}), "Facing"

    @staticmethod
    def fresnel(tree, index=1.8):
        return tree.node("Fresnel", None, {"IOR": index}), 0

    @staticmethod
    def product(tree):
        """The cosine, as one's own formulas of Fresnel's have it."""
        geometry = tree.node("NewGeometry")
        return tree.node("VectorMath", {"operation": "DOT_PRODUCT"}, {0: (geometry, "Normal"), 1: (geometry, "Incoming")}), "Value"

    def ramp(self, tree, factor, first=(0.05, 0.8, 0.1, 1), second=(0.9, 0.1, 0.6, 1)):
        node = tree.node("ValToRGB", None, {"Fac": factor})
        node.color_ramp.elements[0].color, node.color_ramp.elements[1].color = first, second
        return node, "Color"

    def scaled(self, tree, number, factor, further=0.0):
        return tree.node("Math", {"operation": "MULTIPLY_ADD"}, {0: number, 1: factor, 2: further}), 0

    def mixed(self, tree, share, first, second):
        return tree.node("MixShader", None, {0: share, 1: first, 2: second})

    # -- comparison

    def rings(self, engine, samples):
        """(rings, 3): means over rings of the disc that a ball shows."""
        image = render(engine, samples)
        picture = np.stack([np.reshape(image[f"Combined.{c}"], (SIZE, SIZE)) for c in "RGB"], -1)
        y, x = np.mgrid[:SIZE, :SIZE] + 0.5
        radius = np.hypot(x - SIZE / 2, y - SIZE / 2) / (SIZE / 2.1)
        return np.array([picture[(radius >= low) & (radius < high)].mean(0) for low, high in zip(RINGS, RINGS[1:])])

    def assert_ball_as_in_cycles(self, make, tolerance=0.02, samples=256, warnings=0, differs=True):
        """make(tree): the node of the shader. differs: whether the rim must look other than the middle, so that a mean would fail."""
        tree = Tree("by angle")
        shader = make(tree)
        tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
        bpy.ops.mesh.primitive_uv_sphere_add(radius=1, segments=64, ring_count=32)
        bpy.ops.object.shade_smooth()
        ball = bpy.context.object
        ball.data.materials.append(tree.material)
        text = self.export()
        ours, theirs = self.rings("COVTRACE", samples), self.rings("CYCLES", samples)
        bpy.data.objects.remove(ball)
        np.testing.assert_allclose(ours, theirs, atol=tolerance * theirs.max())
        if differs:
            self.assertGreater(np.ptp(theirs, axis=0).max(), 5 * tolerance * theirs.max())
        self.assertEqual(len(self.warnings), warnings, self.warnings)
        return text

    # -- tests

    def test_light_by_the_angle(self):
        for name, factor in (("facing", lambda tree: self.facing(tree)), ("fresnel", lambda tree: self.fresnel(tree, 2.0)),
                             ("steep", lambda tree: self.facing(tree, 0.8)),
                             ("product", self.product), ("layer", lambda tree: (tree.node("LayerWeight", None, {"Blend": 0.6}), "Fresnel"))):
            with self.subTest(name):
                self.assert_ball_as_in_cycles(lambda tree: tree.node("Emission", None, {"Color": self.ramp(tree, factor(tree))}), samples=64)
        with self.subTest("strength"):
            def rim(tree):
                light = tree.node("Emission", None, {"Color": ORANGE, "Strength": self.scaled(tree, self.facing(tree), 3.0)})
                return tree.node("AddShader", None, {0: tree.node("BsdfDiffuse", None, {"Color": BLUE}), 1: light})
            self.assert_ball_as_in_cycles(rim)

    def test_paint_and_roughness_by_the_angle(self):
        def paint(tree):
            return tree.node("BsdfPrincipled", None, {"Base Color": self.ramp(tree, self.facing(tree)), "Metallic": 1.0, "Roughness": 0.3})

        def satin(tree):
            return tree.node("BsdfGlossy", None, {"Color": ORANGE, "Roughness": self.facing(tree, 0.5)})

        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        self.lamp("AREA", location=(0, 0, 4), energy=300, size=2)
        for make in (paint, satin):
            with self.subTest(make.__name__):
                self.assert_ball_as_in_cycles(make, 0.03)

    def test_mixtures_by_the_angle(self):
        def two(tree, factor):
            return self.mixed(tree, factor, tree.node("BsdfDiffuse", None, {"Color": BLUE}),
                              tree.node("BsdfGlossy", None, {"Color": ORANGE, "Roughness": 0.3}))

        def glow(tree):
            light = self.mixed(tree, 0.5, tree.node("Emission", None, {"Color": ORANGE, "Strength": 2.0}), tree.node("BsdfTransparent"))
            return self.mixed(tree, self.facing(tree), tree.node("BsdfDiffuse", None, {"Color": BLUE}), light)

        for name, make in (("fresnel", lambda tree: two(tree, self.fresnel(tree))), ("facing", lambda tree: two(tree, self.facing(tree))),
                           ("glow", glow)):
            with self.subTest(name):
                self.assert_ball_as_in_cycles(make, 0.03)

    def test_what_lets_light_pass_by_the_angle(self):
        def x_ray(tree):
            return self.mixed(tree, self.facing(tree), tree.node("BsdfTransparent"), tree.node("Emission", None, {"Color": BLUE, "Strength": 2.0}))

        def bubble(tree):
            """The far side reflects as from within."""
            return self.mixed(tree, self.fresnel(tree, 1.3), tree.node("BsdfTransparent"), tree.node("Emission", None, {"Color": ORANGE}))

        def veil(tree):
            return tree.node("BsdfPrincipled", None, {"Base Color": BLUE, "Alpha": self.facing(tree, 0.3)})

        def dimmed(tree):
            return tree.node("BsdfTransparent", None, {"Color": self.facing(tree, 0.6)})

        def halo(tree):
            light = tree.node("Emission", None, {"Color": ORANGE, "Strength": self.facing(tree)})
            return tree.node("AddShader", None, {0: tree.node("BsdfTransparent"), 1: light})

        makes = [(x_ray, 0), (bubble, 0), (dimmed, 1), (halo, 0)]
        if bpy.app.version >= (4, 0):  # the diffuse part of the earlier Principled is brighter at its rim, with an even alpha, too
            makes.append((veil, 0))
        for make, warnings in makes:
            with self.subTest(make.__name__):
                self.assert_ball_as_in_cycles(make, warnings=warnings)

    def test_both_sides_look_their_own_way(self):
        """A hull that is seen where it faces away, as outlines are drawn."""
        def hull(tree):
            back = tree.node("NewGeometry"), "Backfacing"
            return self.mixed(tree, back, tree.node("BsdfTransparent"), tree.node("Emission", None, {"Color": self.ramp(tree, self.facing(tree))}))

        self.assert_ball_as_in_cycles(hull)

    def test_places_and_angles_together(self):
        def two_images(tree):
            colour = tree.node("MixRGB", None, {0: self.facing(tree), 1: (tree.colours(), 0), 2: ORANGE})
            return tree.node("BsdfDiffuse", None, {"Color": (colour, 0)})

        def images(tree):
            product = tree.node("Math", {"operation": "MULTIPLY"}, {0: self.facing(tree, 0.5), 1: tree.number()})
            return tree.node("Emission", None, {"Color": self.ramp(tree, self.scaled(tree, (product, 0), 1.5, -0.2))})

        def on_body(tree):
            noise = tree.node("TexNoise", None, {"Scale": 2.0})
            colour = tree.node("MixRGB", None, {0: self.fresnel(tree), 1: (noise, "Color"), 2: BLUE})
            return tree.node("Emission", None, {"Color": (colour, 0)})

        for make, is_mixed in ((two_images, True), (images, False), (on_body, True)):
            with self.subTest(make.__name__):
                text = self.assert_ball_as_in_cycles(make)
                self.assertEqual('"mix" "texture tex1"' in text, is_mixed)

    def test_images_as_they_are_stay_so(self):
        """A mixture by the angle bakes nothing of its parts."""
        image = bpy.data.images.new("colours", 8, 8, float_buffer=True)
        image.pixels = np.random.default_rng(0).random((64, 4)).astype(np.float32).ravel()

        def shown(tree):
            colour = tree.node("TexImage", {"image": image}, {"Vector": tree.uv()})
            return self.mixed(tree, self.facing(tree), tree.node("BsdfDiffuse", None, {"Color": (colour, 0)}),
                              tree.node("Emission", None, {"Color": ORANGE}))

        text = self.assert_ball_as_in_cycles(shown, 0.03)
        self.assertEqual(text.count('"imagemap"'), 1)

    def test_bumps_of_the_nodes_are_told(self):
        def bumpy(tree):
            bump = tree.node("Bump", None, {"Height": tree.number(), "Strength": 0.1})
            weight = tree.node("LayerWeight", None, {"Blend": 0.35, "Normal": (bump, 0)})
            return tree.node("Emission", None, {"Color": self.ramp(tree, (weight, "Facing"))})

        self.assert_ball_as_in_cycles(bumpy, 0.03, 64, warnings=1)
        self.assertIn("smooth normal", self.warnings[0])

    def test_what_takes_no_texture_is_the_mean(self):
        def glass(tree):
            index = self.scaled(tree, self.facing(tree, 0.5), 0.3, 1.0)
            return tree.node("BsdfGlass", None, {"IOR": index, "Roughness": 0.0})

        tree = Tree("mean")
        tree.link(glass(tree), 0, tree.tree.nodes["Material Output"].inputs["Surface"])
        self.plane(tree.material)
        text = self.export()
        self.assertEqual(len([w for w in self.warnings if "hangs on the angle of sight; it is the mean" in w]), 1, self.warnings)
        self.assertNotIn('"facing"', text)
