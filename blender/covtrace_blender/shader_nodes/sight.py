"""Nodes that hang on the angle of sight, and what they feed: at any angles, or in the mean over all directions, each of which counts by
its cosine."""

import numpy as np

from ..fresnel import facing, reflectance

ANGLES = 8  # of means; four leave a colour by Fresnel 6 % off, and each costs an evaluation
COSINES = np.sqrt((np.arange(ANGLES) + 0.5) / ANGLES)  # each stands for as much of the directions


def mean_over_angles(get, nodes):
    """The value of `get(nodes)` of an Evaluator, or its mean where nodes ask their place for the angle of sight."""
    found = get(nodes)
    if not nodes.place.hangs_on_angle:
        return found
    values = [found]
    for cosine in COSINES[1:]:
        nodes.look_at(cosine)
        values.append(get(nodes))
    nodes.look_at(COSINES[0])
    return sum(values) / np.float32(ANGLES)


def is_cosine(node):
    """Whether a node Vector Math is the product of the direction of sight and the normal, of which the node Geometry has both."""
    sources = [next(iter(socket.links), None) for socket in node.inputs[:2]]
    return node.operation == "DOT_PRODUCT" and all(link and link.from_node.type == "NEW_GEOMETRY" for link in sources) and \
        {link.from_socket.identifier for link in sources} == {"Incoming", "Normal"}


def _of_border(place, eta):
    """The reflectance of a border of this index, which is that from within behind the surface."""
    return reflectance(place.cosine(), np.where(place.is_behind(), 1 / eta, eta))


def _fresnel(node, output, inputs):
    return _of_border(inputs.place, np.maximum(inputs.number("IOR"), 1e-5))


def _layer_weight(node, output, inputs):
    blend = inputs.number("Blend")
    if output.identifier == "Facing":
        return facing(inputs.place.cosine(), blend)
    return _of_border(inputs.place, 1 / np.maximum(1 - blend, 1e-5))


NODES = {"FRESNEL": _fresnel, "LAYER_WEIGHT": _layer_weight}
