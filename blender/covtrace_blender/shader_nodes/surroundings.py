"""Nodes that look around a place on the surface, which no baking does: as if nothing were near."""

import numpy as np

# The warning about a material with one of these nodes, by the type of the node.
TOLD = {"AMBIENT_OCCLUSION": "Ambient Occlusion is 1, as if nothing were near",
        "BEVEL": "the Normal of Bevel is the surface's own"}


def _occlusion(node, output, inputs):
    return inputs.vector("Color") if output.identifier == "Color" else np.float32(1)


def _bevel(node, output, inputs):
    return inputs.vector("Normal") if inputs.socket("Normal").is_linked else inputs.place.coordinates(node, "WORLD NORMAL")


NODES = {"AMBIENT_OCCLUSION": _occlusion, "BEVEL": _bevel}
