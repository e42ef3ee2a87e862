"""The walk over a tree of nodes."""

import numpy as np

from ..working_space import luminance
from . import adjustments, blending, colours, coordinates, gradients, images, light_path, maths, musgrave, noise_nodes, patterns, ramps
from . import sight, surroundings, voronoi_node
from .unsupported import Unsupported


def _conversion(node, output, inputs):
    return (inputs.vector if output.type in ("RGBA", "VECTOR") else inputs.number)(0)


# Values by the type of the node: function(node, output, Inputs) to a number or a vector, as the output's type is.
NODES = {**adjustments.NODES, **blending.NODES, **colours.NODES, **coordinates.NODES, **gradients.NODES, **images.NODES,
         **light_path.NODES, **maths.NODES, **musgrave.NODES, **noise_nodes.NODES, **patterns.NODES, **ramps.NODES, **sight.NODES,
         **surroundings.NODES, **voronoi_node.NODES, "CONVERSION": _conversion}


class Inputs:
    """The inputs of one node, by their identifiers or names."""

    def __init__(self, evaluator, node):
        self._evaluator, self.node, self.place = evaluator, node, evaluator.place

    def socket(self, name):
        if isinstance(name, int):
            return self.node.inputs[name]
        for found in (lambda s: s.identifier == name, lambda s: s.name == name and getattr(s, "enabled", True)):
            for socket in self.node.inputs:
                if found(socket):
                    return socket
        return None

    def has(self, name):
        return self.socket(name) is not None

    def number(self, name):
        return self._evaluator.number(self._found(name))

    def vector(self, name):
        return self._evaluator.vector(self._found(name))

    def coordinates(self, unlinked="GENERATED"):
        """The input Vector of textures, which has a meaning where nothing is linked to it."""
        socket = self._found("Vector")
        if socket.is_linked:
            return self._evaluator.vector(socket)
        if unlinked == "UV":
            return self.place.uv_of(self.node, "")
        return self.place.coordinates(self.node, unlinked)

    def _found(self, name):
        socket = self.socket(name)
        if socket is None:
            raise Unsupported(self.node, f"it has no input {name}")
        return socket


class Evaluator:
    """Evaluates FlatSockets at the places of `place`."""

    def __init__(self, place):
        self.place = place
        self._known = {}

    def number(self, socket):
        """(n,) or (): what a socket of one number gets."""
        return self._get(socket, False)

    def vector(self, socket):
        """(n, 3) or (3,): what a socket of colours or vectors gets."""
        return self._get(socket, True)

    def _get(self, socket, wants_vector):
        link = next(iter(socket.links), None)
        if link is None:
            value = np.asarray(socket.default_value, np.float32)
            value, kind = (value, "VALUE") if value.ndim == 0 else (value[:3], socket.type)
        else:
            value, kind = self.output(link.from_node, link.from_socket)
        is_vector = kind in ("RGBA", "VECTOR")
        if is_vector == wants_vector:
            return value
        if wants_vector:
            return np.repeat(np.asarray(value, np.float32)[..., None], 3, axis=-1)
        return luminance(value) if kind == "RGBA" else value.mean(axis=-1)

    def output(self, node, output):
        """(value, type of its socket)."""
        key, place = (node.path, output.identifier), self.place
        if key not in self._known:
            before, place.hangs_on_angle = place.hangs_on_angle, False
            self._known[key] = *self._evaluate(node, output), place.hangs_on_angle
            place.hangs_on_angle |= before
        value, kind, hangs_on_angle = self._known[key]
        place.hangs_on_angle |= hangs_on_angle
        return value, kind

    def look_at(self, cosine):
        """Goes on at this cosine of the angle of sight; what does not hang on it is not evaluated again."""
        self.place.sight = cosine
        self._known = {key: found for key, found in self._known.items() if not found[2]}

    def _evaluate(self, node, output):
        if node.type not in NODES:
            raise Unsupported(node, "nodes of its kind have no counterpart")
        with np.errstate(all="ignore"):
            value = np.asarray(NODES[node.type](node, output, Inputs(self, node)), np.float32)
        return np.nan_to_num(value), output.type


def evaluated(get, place):
    """The value of a function of an Evaluator at places, the mean over the angles of sight where it hangs on those."""
    return sight.mean_over_angles(get, Evaluator(place))


def evaluated_at(get, place, cosines, count, channels):
    """(count, k * channels) of a function that gives numbers (channels: 1) or vectors (3) at the `count` places of `place`: its values at k
    cosines of the angle of sight, one after the other."""
    nodes, found = Evaluator(place), []
    for cosine in cosines:
        nodes.look_at(cosine)
        found.append(np.broadcast_to(np.reshape(get(nodes), (-1, channels)), (count, channels)))
    return np.concatenate(found, axis=1)
