"""Each shader node that is baked, against Cycles."""

import unittest
import unittest.mock

import bpy
from node_tiles import NodeTilesTest
from node_trees import BLUE, ORANGE, Tree
from covtrace_blender import baking  # after what finds it


class ShaderNodesTest(NodeTilesTest):
    @staticmethod
    def of_textures(textures):
        """{name: (kind, settings, inputs, output)} on UV coordinates."""
        def build(kind, settings, inputs, output):
            def show(tree):
                node = tree.node(kind, settings, {**inputs, "Vector": tree.uv()})
                if output == "Distance":  # which goes beyond 1, as no matt colour does
                    node, output_shown = tree.node("Math", {"operation": "MULTIPLY"}, {0: (node, output), 1: 0.5}), 0
                else:
                    output_shown = output
                tree.show(node, output_shown)
            return show
        return {name: build(*texture) for name, texture in textures.items()}

    def test_patterns(self):
        wave = {"Scale": 1.0, "Distortion": 2.0}
        self.assert_nodes(self.of_textures({
            "checker": ("TexChecker", {}, {"Scale": 2.5, "Color1": BLUE, "Color2": ORANGE}, "Color"),
            "checker factor": ("TexChecker", {}, {"Scale": 3.0}, "Fac"),
            "brick": ("TexBrick", {"offset": 0.3, "squash": 0.7}, {
                "Scale": 1.5, "Color1": BLUE, "Color2": ORANGE, "Mortar Smooth": 0.4, "Mortar Size": 0.05}, "Color"),
            "brick factor": ("TexBrick", {}, {"Scale": 1.0, "Mortar Size": 0.08}, "Fac"),
            **{kind: ("TexGradient", {"gradient_type": kind}, {}, "Color") for kind in (
                "LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "RADIAL", "QUADRATIC_SPHERE", "SPHERICAL")},
            "waves": ("TexWave", {"wave_type": "BANDS", "bands_direction": "DIAGONAL"}, wave, "Color"),
            "rings": ("TexWave", {"wave_type": "RINGS", "wave_profile": "TRI"}, {"Scale": 1.0, "Phase Offset": 1.0}, "Color"),
            "saw": ("TexWave", {"wave_profile": "SAW"}, {"Scale": 0.7}, "Fac"),
        }), samples=64)

    def test_thin_lines_are_as_wide_as_they_are(self):
        """Mortar of 4.1 texels, which texels of 0 and 1 would make 4."""
        self.assert_nodes(self.of_textures({"brick": ("TexBrick", {}, {
            "Scale": 5.0, "Mortar Smooth": 0.0, "Mortar Size": 0.02}, "Fac")}), mean_tolerance=0.01, samples=512, has_structure=False)

    def test_noise(self):
        rich = {"Scale": 4.0, "Detail": 2.5, "Roughness": 0.6, "Distortion": 0.5}
        self.assert_nodes(self.of_textures({
            "noise": ("TexNoise", {}, rich, "Color"),
            "noise number": ("TexNoise", {}, {"Scale": 6.0, "Detail": 0.0}, "Fac"),
            "noise 2D": ("TexNoise", {"noise_dimensions": "2D"}, rich, "Color"),
            "noise 4D": ("TexNoise", {"noise_dimensions": "4D"}, {**rich, "W": 0.7}, "Color"),
            "voronoi": ("TexVoronoi", {}, {"Scale": 4.0, "Randomness": 0.9}, "Color"),
            "voronoi 2D": ("TexVoronoi", {"voronoi_dimensions": "2D"}, {"Scale": 4.0}, "Color"),
            "voronoi F1": ("TexVoronoi", {"distance": "MINKOWSKI"}, {"Scale": 3.0, "Exponent": 1.5}, "Distance"),
            "voronoi F2": ("TexVoronoi", {"feature": "F2", "distance": "MANHATTAN"}, {"Scale": 1.5}, "Distance"),
            "voronoi edge": ("TexVoronoi", {"feature": "DISTANCE_TO_EDGE"}, {"Scale": 2.0}, "Distance"),
            "voronoi position": ("TexVoronoi", {"distance": "CHEBYCHEV"}, {"Scale": 3.0}, "Position"),
        }))

    def test_fractals(self):
        def musgrave(kind, **inputs):
            def show(tree):
                values = {"Scale": 3.0, "Detail": 2.6, "Dimension": 1.2, "Lacunarity": 2.2, **inputs, "Vector": tree.uv()}
                node = tree.node("TexMusgrave", {"musgrave_type": kind}, values)
                tree.show(tree.node("Math", {"operation": "MULTIPLY_ADD", "use_clamp": True}, {0: node, 1: 0.25, 2: 0.3}))
            return show

        def magic(depth):
            return lambda tree: tree.show(tree.node("TexMagic", {"turbulence_depth": depth}, {
                "Scale": 0.6, "Distortion": 1.2, "Vector": tree.uv()}))

        fractals = {"fBM": musgrave("FBM"), "multifractal": musgrave("MULTIFRACTAL"),
                    "hetero": musgrave("HETERO_TERRAIN", Offset=0.4), "hybrid": musgrave("HYBRID_MULTIFRACTAL", Offset=0.3, Gain=2.0),
                    "ridged": musgrave("RIDGED_MULTIFRACTAL", Scale=1.3, Offset=1.2, Gain=1.0)}
        self.assert_nodes({**(fractals if bpy.app.version < (4, 1) else {}), **{f"magic {depth}": magic(depth) for depth in (0, 2, 10)}})

    @unittest.skipUnless("noise_type" in bpy.types.ShaderNodeTexNoise.bl_rna.properties, "this Blender has a node Musgrave")
    def test_fractals_of_noise(self):
        def noise(kind, factor=0.25, added=0.3, output=0, **inputs):
            normalize = inputs.pop("normalize", False)

            def show(tree):
                values = {"Scale": 3.0, "Detail": 1.6, "Roughness": 0.4, "Lacunarity": 2.2, "Distortion": 0.2, **inputs, "Vector": tree.uv()}
                node = tree.node("TexNoise", {"noise_type": kind, "normalize": normalize}, values)
                if output:
                    tree.show(tree.node("VectorMath", {"operation": "MULTIPLY"}, {0: (node, output), 1: (0.4, 0.4, 0.4)}))
                else:
                    tree.show(tree.node("Math", {"operation": "MULTIPLY_ADD", "use_clamp": True}, {0: node, 1: factor, 2: added}))
            return show

        self.assert_nodes({
            "fBM": noise("FBM"), "normalized": noise("FBM", 1.0, 0.0, normalize=True), "multifractal": noise("MULTIFRACTAL"),
            "hetero": noise("HETERO_TERRAIN", Offset=0.4), "hybrid": noise("HYBRID_MULTIFRACTAL", Offset=0.3, Gain=2.0),
            "ridged": noise("RIDGED_MULTIFRACTAL", Scale=1.3, Offset=1.2, Gain=1.0), "colour": noise("MULTIFRACTAL", output=1)})

    def test_noise_of_one_dimension(self):
        def build(kind):
            def show(tree):
                steps = tree.node("Math", {"operation": "MULTIPLY"}, {0: tree.number(), 1: 5.0})
                tree.show(tree.node(kind, {"noise_dimensions": "1D"}, {"W": steps, "Scale": 1.0}), 1)
            return show
        self.assert_nodes({"noise": build("TexNoise")})

    def test_adjustments(self):
        adjustments = {
            "hue": ("HueSaturation", {"Hue": 0.7, "Saturation": 0.8, "Value": 0.9, "Fac": 0.8}, "Color"),
            "contrast": ("BrightContrast", {"Bright": -0.1, "Contrast": 0.2}, "Color"),
            "gamma": ("Gamma", {"Gamma": 2.2}, "Color"),
            "invert": ("Invert", {"Fac": 0.7}, "Color"),
            "grey": ("RGBToBW", {}, "Color"),
        }

        def build(kind, inputs, socket):
            return lambda tree: tree.show(tree.node(kind, {}, {**inputs, socket: tree.colours()}))

        def ramp(interpolation):
            def show(tree):
                node = tree.node("ValToRGB", {}, {0: tree.number()})
                node.color_ramp.interpolation = interpolation
                node.color_ramp.elements[0].color, node.color_ramp.elements[1].color = BLUE, ORANGE
                node.color_ramp.elements.new(0.4).color = (0.2, 0.9, 0.3, 1)
                tree.show(node)
            return show

        def curves(tree):
            node = tree.node("RGBCurve", {}, {"Fac": 0.8, "Color": tree.colours()})
            node.mapping.curves[3].points.new(0.5, 0.7)
            node.mapping.curves[0].points.new(0.3, 0.2)
            node.mapping.curves[1].points[1].location = (0.8, 0.9)
            node.mapping.update()
            tree.show(node)

        def separate(mode):
            def show(tree):
                parts = tree.node("SeparateColor", {"mode": mode}, {0: tree.colours()})
                tree.show(tree.node("CombineColor", {}, {0: (parts, 2), 1: (parts, 0), 2: (parts, 1)}))
            return show

        def combine(mode):
            return lambda tree: tree.show(tree.node("CombineColor", {"mode": mode}, {0: tree.number(), 1: tree.number(1), 2: 0.6}))

        self.assert_nodes({**{name: build(*values) for name, values in adjustments.items()},
                           **{f"ramp {kind}": ramp(kind) for kind in ("LINEAR", "CONSTANT", "EASE")}, "curves": curves,
                           **{f"separate {mode}": separate(mode) for mode in ("HSV", "HSL")},
                           **{f"combine {mode}": combine(mode) for mode in ("HSV", "HSL")}})

    def test_blends(self):
        def build(blend, share):
            def show(tree):
                inputs = {0: share, 6: tree.colours(), 7: (0.7, 0.4, 0.2, 1)}
                tree.show(tree.node("Mix", {"data_type": "RGBA", "blend_type": blend, "clamp_result": True}, inputs), 2)
            return show
        blends = ("MIX", "DARKEN", "MULTIPLY", "LIGHTEN", "SCREEN", "DODGE", "ADD", "OVERLAY", "SOFT_LIGHT", "LINEAR_LIGHT",
                  "DIFFERENCE", "SUBTRACT", "DIVIDE", "HUE", "SATURATION", "COLOR")
        self.assert_nodes({blend: build(blend, 0.7) for blend in blends})

    def test_further_blends(self):
        def old(tree):
            tree.show(tree.node("MixRGB", {"blend_type": "BURN"}, {0: 0.3, 1: tree.colours(), 2: (0.7, 0.4, 0.2, 1)}))

        def numbers(tree):
            tree.show(tree.node("Mix", {"data_type": "FLOAT"}, {0: tree.number(), 2: 0.2, 3: tree.number(1)}))

        def vectors(tree):
            tree.show(tree.node("Mix", {"data_type": "VECTOR"}, {0: 0.4, 4: tree.uv(), 5: (0.3, 0.9, 0.4)}), 1)

        self.assert_nodes({"burn": old, "numbers": numbers, "vectors": vectors})

    def test_arithmetic(self):
        two = {0: 1, 1: 0.35, 2: 0.2}

        def build(operation):
            def show(tree):
                inputs = {**two, 0: tree.number()}
                node = tree.node("Math", {"operation": operation, "use_clamp": True}, inputs)
                tree.show(tree.node("Math", {"operation": "MULTIPLY_ADD"}, {0: node, 1: 0.7, 2: tree.number(1)}))
            return show

        for operations in (("ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "POWER", "LOGARITHM", "SQRT", "ABSOLUTE",
                            "EXPONENT", "MINIMUM", "MAXIMUM", "LESS_THAN", "GREATER_THAN", "COMPARE", "SMOOTH_MIN"),
                           ("SMOOTH_MAX", "ROUND", "FRACT", "MODULO", "WRAP", "SNAP", "PINGPONG", "SINE", "COSINE", "TANGENT",
                            "ARCSINE", "ARCTAN2", "TANH", "DEGREES", "RADIANS", "INVERSE_SQRT")):
            with self.subTest(operations[0]):
                # Sums beyond 1 shine in Cycles.
                self.assert_nodes({operation: build(operation) for operation in operations}, self.squeeze)
            bpy.data.batch_remove([o for o in bpy.data.objects if o.type == "MESH"])

    @staticmethod
    def squeeze(plane):
        for loop in plane.data.uv_layers[0].data:
            loop.uv = (loop.uv[0], 0.3 * loop.uv[1])

    def test_ranges_and_vectors(self):
        def mapped(kind, clamp=True):
            def show(tree):
                tree.show(tree.node("MapRange", {"interpolation_type": kind, "clamp": clamp}, {
                    "Value": tree.number(), "From Min": 0.2, "From Max": 0.9, "To Min": 0.1, "To Max": 0.8}))
            return show

        def clamped(tree):
            tree.show(tree.node("Clamp", {"clamp_type": "RANGE"}, {0: tree.number(), 1: 0.7, 2: 0.3}))

        def vector(operation):
            def show(tree):
                tree.show(tree.node("VectorMath", {"operation": operation}, {0: tree.uv(), 1: (0.4, 0.7, 0.3)}),
                          1 if operation in ("DOT_PRODUCT", "DISTANCE", "LENGTH") else 0)
            return show

        def placed(kind):
            def show(tree):
                mapping = tree.node("Mapping", {"vector_type": kind}, {
                    "Vector": tree.uv(), **({"Location": (0.1, 0.2, 0)} if kind == "TEXTURE" else {}), "Rotation": (0.1, 0.2, 0.6), "Scale": (1.3, 0.8, 1.1)})
                tree.show(tree.node("VectorMath", {"operation": "ABSOLUTE"}, {0: mapping}))
            return show

        self.assert_nodes({**{kind: mapped(kind) for kind in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP")},
                           "unclamped": mapped("LINEAR", False), "clamp": clamped,
                           **{name: vector(name) for name in ("MULTIPLY", "DISTANCE", "NORMALIZE", "FRACTION", "PROJECT",
                                                              *(("ROUND",) if bpy.app.version >= (5, 1, 0) else ()))},
                           **{f"mapping {kind}": placed(kind) for kind in ("TEXTURE", "NORMAL")}})

    def test_nodes_that_look_around_see_nothing_near(self):
        """On planes in the open that is so; without them what hangs on these nodes had the socket's own value."""
        def occluded(output):
            def show(tree):
                node = tree.node("AmbientOcclusion", inputs={"Color": tree.colours()})
                share = tree.node("Math", {"operation": "MULTIPLY"}, {0: (node, output), 1: tree.number()})
                tree.show(share if output == "AO" else node)
            return show

        def bevelled(tree):
            away = tree.node("VectorMath", {"operation": "ADD"}, {0: tree.node("Bevel", {"samples": 4}, {"Radius": 0.01}), 1: tree.colours()})
            tree.show(tree.node("VectorMath", {"operation": "MULTIPLY"}, {0: away, 1: (0.5, 0.5, 0.5)}))

        self.assert_nodes({"AO": occluded("AO"), "colour": occluded("Color"), "bevel": bevelled}, warnings=[
            *(f"material '{name}': Ambient Occlusion is 1, as if nothing were near" for name in ("AO", "colour")),
            "material 'bevel': the Normal of Bevel is the surface's own"])

    def test_turned_vectors(self):
        def turned(kind, invert, **inputs):
            def show(tree):
                node = tree.node("VectorRotate", {"rotation_type": kind, "invert": invert}, {
                    "Vector": tree.uv(), "Center": (0.3, 0.2, 0.1), **inputs})
                half = tree.node("VectorMath", {"operation": "MULTIPLY"}, {0: node, 1: (0.5, 0.5, 0.5)})  # no colours above 1
                tree.show(tree.node("VectorMath", {"operation": "ABSOLUTE"}, {0: half}))
            return show

        def by_number(tree):
            angle = tree.node("Math", {"operation": "MULTIPLY"}, {0: tree.number(1), 1: 2.0})
            turned("AXIS_ANGLE", False, Axis=(0.2, 0.3, 1), Angle=angle)(tree)

        def by_vectors(kind):
            def show(tree):
                angles = tree.node("VectorMath", {"operation": "MULTIPLY"}, {0: tree.uv(), 1: (1.1, 0.7, 0.9)})
                if kind in ("angles", "inverted angles"):
                    turned("EULER_XYZ", kind == "inverted angles", Rotation=angles)(tree)
                else:
                    mapping = tree.node("Mapping", {"vector_type": kind}, {
                        "Vector": tree.uv(), **({"Location": (0.1, 0.2, 0)} if kind in ("POINT", "TEXTURE") else {}),
                        "Rotation": angles, "Scale": (0.7, 0.8, 1.1)})
                    half = tree.node("VectorMath", {"operation": "MULTIPLY"}, {0: mapping, 1: (0.5, 0.5, 0.5)})
                    tree.show(tree.node("VectorMath", {"operation": "ABSOLUTE"}, {0: half}))
            return show

        self.assert_nodes({**{f"{kind} by vectors": by_vectors(kind) for kind in
                              ("POINT", "TEXTURE", "VECTOR", "NORMAL", "angles", "inverted angles")},
                           "axis": turned("AXIS_ANGLE", False, Axis=(0.2, 0.3, 1), Angle=0.7), "by a number": by_number,
                           "inverted": turned("Y_AXIS", True, Angle=0.7), "no axis": turned("AXIS_ANGLE", False, Axis=(0, 0, 0), Angle=0.7),
                           "angles": turned("EULER_XYZ", False, Rotation=(0.1, 0.2, 0.6)),
                           "inverted angles": turned("EULER_XYZ", True, Rotation=(0.1, 0.2, 0.6))})

    def test_generated_coordinates_of_planes(self):
        def generated(tree):
            tree.show(tree.node("TexNoise", {}, {"Scale": 3.0, "Detail": 0.0}), 1)

        def of_object(tree):
            tree.show(tree.node("TexVoronoi", {}, {"Scale": 3.0, "Vector": (tree.node("TexCoord"), "Object")}), 1)

        self.assert_nodes({"generated": generated, "object": of_object})

    def test_uv_beyond_the_unit_square(self):
        def repeated(tree):
            tree.show(tree.node("TexChecker", {}, {"Scale": 1.0, "Vector": tree.uv(), "Color1": BLUE, "Color2": ORANGE}))

        def endless(tree):
            tree.show(tree.node("TexNoise", {}, {"Scale": 1.5, "Detail": 0.0, "Vector": tree.uv()}), 1)

        def widened(plane):
            for loop in plane.data.uv_layers[0].data:
                loop.uv = (3 * loop.uv[0] - 1, 2 * loop.uv[1] + 0.5)

        self.assert_nodes({"repeated": repeated, "endless": endless}, widened)

    def test_what_has_not_changed_is_baked_once(self):
        tree = Tree()
        noise = tree.node("TexNoise", {}, {"Scale": 3.0, "Vector": tree.uv()})
        tree.show(noise, 1)
        plane = self.tile(0, tree.material)
        baked = baking.Baker._pixels
        with unittest.mock.patch.object(baking.Baker, "_pixels", side_effect=baked) as counted:
            def bakes():
                before = counted.call_count
                self.export()
                return counted.call_count - before

            self.assertEqual(bakes(), 1)
            plane.location.x += 1
            self.assertEqual(bakes(), 0)
            noise.inputs["Scale"].default_value = 4
            self.assertEqual(bakes(), 1)
            for loop in plane.data.uv_layers[0].data:
                loop.uv = (3 * loop.uv[0], loop.uv[1])
            self.assertEqual(bakes(), 1)
            noise.inputs["Scale"].keyframe_insert("default_value", frame=1)
            noise.inputs["Scale"].default_value = 5
            noise.inputs["Scale"].keyframe_insert("default_value", frame=2)
            self.scene.frame_set(1)
            self.assertEqual(bakes(), 0)
            self.scene.frame_set(2)
            self.assertEqual(bakes(), 1)

    def test_nodes_shine(self):
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)

        def shining(tree):
            shader = tree.node("Emission", {}, {"Strength": 1.5, "Color": (
                tree.node("TexNoise", {}, {"Scale": 3.0, "Detail": 0.0, "Vector": tree.uv()}), 1)})
            tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])

        self.assert_nodes({"noise": shining})
