"""The node Voronoi against Cycles: its dimensions, its features, and the octaves that it has since Blender 4.0."""

import unittest

import bpy
from node_tiles import NodeTilesTest


def cells(output, factor=0.5, added=0.1, dimensions="2D", **values):
    """Shows a share of an output of a node, of the settings and inputs of these names."""
    settings = {name: value for name, value in values.items() if name in ("feature", "distance", "normalize")}
    inputs = {name: value for name, value in values.items() if name not in settings}

    def show(tree):
        if dimensions == "1D":
            inputs["W"] = (tree.node("SeparateXYZ", {}, {0: tree.uv()}), 0)
        else:
            inputs["Vector"] = tree.uv()
        node = tree.node("TexVoronoi", {"voronoi_dimensions": dimensions, **settings}, inputs)
        tree.show(tree.node("VectorMath", {"operation": "MULTIPLY_ADD"}, {0: (node, output), 1: (factor,) * 3, 2: (added,) * 3}))
    return show


class VoronoiTest(NodeTilesTest):
    def test_dimensions(self):
        self.assert_nodes({
            "1D": cells("Distance", 0.8, dimensions="1D", Scale=3.0), "1D colour": cells("Color", dimensions="1D", Scale=3.0),
            "1D place": cells("W", dimensions="1D", Scale=3.0),
            "1D edges": cells("Distance", 1.5, dimensions="1D", Scale=2.0, feature="DISTANCE_TO_EDGE"),
            **{f"4D {feature}": cells("Color", dimensions="4D", Scale=2.0, W=0.7, feature=feature) for feature in ("F1", "F2", "SMOOTH_F1")},
            "4D": cells("Position", dimensions="4D", Scale=2.0, W=0.4), "4D place": cells("W", 1.0, 0.0, dimensions="4D", Scale=2.0, W=0.4),
            "4D edges": cells("Distance", 1.0, dimensions="4D", Scale=2.0, W=0.4, feature="DISTANCE_TO_EDGE"),
        })

    def test_smooth_cells_and_spheres(self):
        smooth = {"feature": "SMOOTH_F1", "Scale": 3.0}
        self.assert_nodes({
            "3D": cells("Color", dimensions="3D", Smoothness=0.6, **smooth), "2D": cells("Distance", 1.0, Smoothness=1.0, **smooth),
            "not smooth": cells("Color", Smoothness=0.0, **smooth), "position": cells("Position", Smoothness=0.3, **smooth),
            "distances": cells("Distance", distance="MANHATTAN", Smoothness=0.5, **smooth),
            **{f"spheres {d}": cells("Radius", 1.0, dimensions=d, Scale=4.0, feature="N_SPHERE_RADIUS") for d in ("1D", "2D", "3D", "4D")},
        })

    @unittest.skipUnless("normalize" in bpy.types.ShaderNodeTexVoronoi.bl_rna.properties, "this Blender has no octaves of Voronoi")
    def test_octaves(self):
        rich = {"Scale": 1.5, "Detail": 1.6, "Roughness": 0.6, "Lacunarity": 2.2}
        self.assert_nodes({
            **{f"{feature} {output} {factor}": cells(output, factor, feature=feature, normalize=factor > 0.5, **rich)
               for feature, output in (("F1", "Distance"), ("F2", "Color"), ("SMOOTH_F1", "Position"))
               for factor in (0.3, 0.9)},
            **{f"edges {normalize}": cells("Distance", 2.0 if normalize else 3.0, 0.0, feature="DISTANCE_TO_EDGE", normalize=normalize, **rich)
               for normalize in (False, True)},
            "normalized": cells("Distance", 1.5, normalize=True, feature="F2", Scale=2.0, Randomness=0.5),
            "normalized edges": cells("Distance", 1.5, normalize=True, feature="DISTANCE_TO_EDGE", Scale=2.0, Randomness=0.5),
            "normalized in 4D": cells("Distance", 0.8, dimensions="4D", normalize=True, distance="CHEBYCHEV", Scale=2.0, W=0.4),
            "whole octaves": cells("Distance", 0.4, **{**rich, "Detail": 2.0}), "no roughness": cells("Distance", 0.8, **{**rich, "Roughness": 0.0}),
        })
