"""How far vertices of meshes stand out from their neighbours, which the node Geometry has as Pointiness."""

import numpy as np

from . import export_meshes


def of_vertices(mesh):
    """(vertices,) in [0, 1]: 0.5 where a surface is flat, more where it stands out. As in Cycles it is the angle between a vertex's normal
    and the mean direction of its edges away from it, over pi, and then the mean of a vertex and of its neighbours. Vertices at one place
    count as one, so that edges that are split change nothing."""
    places, normals = export_meshes.positions(mesh), np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("normal", normals)
    places, one_of = np.unique(places, axis=0, return_inverse=True)
    one_of, count = one_of.reshape(-1), len(places)
    ends = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", ends)
    ends = np.unique(np.sort(one_of[ends].reshape(-1, 2), axis=1), axis=0)
    of, other = np.concatenate((ends, ends[:, ::-1])).T
    edges = np.maximum(np.bincount(of, minlength=count), 1)
    mean_way = _sums(of, _unit(places[other] - places[of]), count) / edges[:, None]
    cosines = (_unit(_sums(one_of, normals.reshape(-1, 3), count)) * mean_way).sum(axis=1)
    angles = np.arccos(np.clip(cosines, -1, 1)) / np.pi
    return ((angles + np.bincount(of, angles[other], count)) / (edges + 1))[one_of].astype(np.float32)


def _sums(of, values, count):
    """(count, 3) sums of (m, 3) values by what they are of."""
    return np.stack([np.bincount(of, column, count) for column in values.T], axis=1)


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
