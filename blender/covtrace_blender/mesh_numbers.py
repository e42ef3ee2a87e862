"""Numbers of the node Geometry that follow from a mesh as a whole."""

import numpy as np

from . import islands, pointiness
from .node_signature import all_nodes

# (vertices,) numbers of a mesh by the node's output, which is also the kind of what nodes ask a body for.
OUTPUTS = {"Random Per Island": islands.of_vertices, "Pointiness": pointiness.of_vertices}


def asked_for(tree):
    """The outputs that nodes of a tree ask for."""
    return {name for node in all_nodes(tree) if node.type == "NEW_GEOMETRY" for name in OUTPUTS if node.outputs[name].is_linked}


def corners(mesh, output, triangles):
    """(n, 3, 3): three times the number of each corner of (n, 3) triangles."""
    return np.repeat(OUTPUTS[output](mesh)[triangles][..., None], 3, axis=2)
