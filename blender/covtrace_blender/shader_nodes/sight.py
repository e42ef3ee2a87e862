"""Nodes that hang on the angle of sight. A surface has the same values from all sides here: the means over all directions, each
direction counting by its cosine."""

import numpy as np

from ..fresnel import exponent_of_facing, reflectance

ANGLES = 8  # four leave a colour by Fresnel 6 % off, and each costs an evaluation
COSINES = np.sqrt((np.arange(ANGLES) + 0.5) / ANGLES)  # each stands for as much of the directions


def mean_over_angles(get, place):
    """The value of `get(place)`, or its mean where nodes ask the place for the angle of sight."""
    found = get(place)
    if not place.hangs_on_angle:
        return found
    values = [found]
    for cosine in COSINES[1:]:
        place.sight = cosine
        values.append(get(place))
    place.sight = COSINES[0]
    return sum(values) / np.float32(ANGLES)


def _fresnel(node, output, inputs):
    return reflectance(inputs.place.cosine(), np.maximum(inputs.number("IOR"), 1.0001))


def _layer_weight(node, output, inputs):
    blend = inputs.number("Blend")
    if output.identifier == "Facing":
        return 1 - inputs.place.cosine() ** exponent_of_facing(blend)
    return reflectance(inputs.place.cosine(), np.maximum(1 / np.maximum(1 - blend, 1e-5), 1.0001))


NODES = {"FRESNEL": _fresnel, "LAYER_WEIGHT": _layer_weight}
