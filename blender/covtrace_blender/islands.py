"""Random numbers of the connected parts of meshes, which the node Geometry has as Random Per Island."""

import numpy as np

from .shader_nodes.hashing import hashed


def of_vertices(mesh):
    """(vertices,) numbers in [0, 1], the same as in Cycles, which takes that of the vertex that stands for all of a part when its edges
    have been joined in order."""
    return hashed(_representatives(mesh).astype(np.uint32)).astype(np.float32) / np.float32(0xFFFFFFFF)


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
