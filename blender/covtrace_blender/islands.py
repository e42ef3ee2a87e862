"""Random numbers of the connected parts of meshes, which the node Geometry has as Random Per Island."""

import numpy as np

from .node_signature import all_nodes
from .shader_nodes.hashing import hashed

KIND = "ISLAND"  # of what nodes ask a body for


def are_asked_for(tree):
    """Whether nodes of a tree ask for them."""
    return any(node.type == "NEW_GEOMETRY" and node.outputs["Random Per Island"].is_linked for node in all_nodes(tree))


def corners(mesh, triangles):
    """(n, 3, 3) of the corners of (n, 3) triangles: three times a number in [0, 1], the same as in Cycles, which takes that of the
    vertex that stands for all of a part when its edges have been joined in order."""
    numbers = hashed(_representatives(mesh).astype(np.uint32)).astype(np.float32) / np.float32(0xFFFFFFFF)
    return np.repeat(numbers[triangles[:, :1]][..., None], 3, axis=1).repeat(3, axis=2)


def _representatives(mesh):
    """(vertices,) the vertex that stands for the part that each is in."""
    ends = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", ends)
    parents, ranks = list(range(len(mesh.vertices))), [0] * len(mesh.vertices)

    def find(vertex):
        root = vertex
        while parents[root] != root:
            root = parents[root]
        while parents[vertex] != root:
            parents[vertex], vertex = root, parents[vertex]
        return root

    for first, second in ends.reshape(-1, 2).tolist():
        first, second = find(first), find(second)
        if first == second:
            continue
        if ranks[first] < ranks[second]:
            first, second = second, first
        parents[second] = first
        ranks[first] += ranks[first] == ranks[second]
    return np.array([find(vertex) for vertex in range(len(parents))], np.int64)
