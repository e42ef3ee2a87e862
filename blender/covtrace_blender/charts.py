"""Meshes cut into charts: connected triangles that face nearly one way, laid flat along it.

Charts are what an atlas is made of (B. Lévy et al., "Least Squares Conformal Maps for Automatic Texture Atlas Generation",
SIGGRAPH 2002, section 3), here by plain projection: a direction of 26 is at most 27 degrees from a normal, so that a chart is squeezed
by an eighth at most.
"""

import itertools

import numpy as np

_ways = np.array([way for way in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(way)])
WAYS = _ways / np.linalg.norm(_ways, axis=1, keepdims=True)


def face_normals(corners):
    """(n, 3) unit normals of (n, 3, 3) triangles; zero where they have no area."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(across, axis=1, keepdims=True)
    return np.where(size > 0, across / np.where(size > 0, size, 1), 0)


def shared_edges(triangles):
    """(k, 2): pairs of (n, 3) `triangles` that share an edge, those of one edge in a row."""
    edges = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=-1).reshape(-1, 2), axis=1).astype(np.int64)
    key = edges[:, 0] * (int(triangles.max()) + 1) + edges[:, 1]
    order = np.argsort(key, kind="stable")
    same = key[order][1:] == key[order][:-1]
    return np.column_stack((order[:-1][same], order[1:][same])) // 3


def connected(count, pairs):
    """(count,): numbers from 0 of the groups that (k, 2) `pairs` connect."""
    label = np.arange(count)
    a, b = pairs.T
    while len(a):
        least = np.minimum(label[a], label[b])
        before = label.copy()
        np.minimum.at(label, label[a], least)
        np.minimum.at(label, label[b], least)
        while True:  # to the least of all that they have met
            further = label[label]
            if (further == label).all():
                break
            label = further
        apart = label[a] != label[b]
        a, b = a[apart], b[apart]
        if (label == before).all():
            break
    return np.unique(label, return_inverse=True)[1]


class Charts:
    """chart: (n,) the chart of each triangle. corners: (n, 3, 2) places in its plane, in the mesh's unit. is_border: (n,)
    whether a triangle has neighbours of other charts, or none."""

    def __init__(self, corners, triangles, cells=None):
        """corners: (n, 3, 3) of triangles; triangles: (n, 3) vertices, by which they are neighbours. cells: (n,) whole
        numbers; triangles of different ones are in different charts."""
        normals = face_normals(corners)
        way = np.argmax(normals.astype(np.float32) @ WAYS.T.astype(np.float32), axis=1)
        key = way if cells is None else way + len(WAYS) * np.asarray(cells, np.int64)
        pairs = shared_edges(triangles)
        inside = pairs[key[pairs[:, 0]] == key[pairs[:, 1]]]
        self.chart = connected(len(triangles), inside)
        self.is_border = np.bincount(inside.ravel(), minlength=len(triangles)) < 3
        along_u, along_v = _axes(WAYS)
        self.corners = np.stack([np.einsum("nki,ni->nk", corners, axis[way]) for axis in (along_u, along_v)], axis=-1)


def _axes(ways):
    """Two axes across each way, with which it is right-handed."""
    helper = np.where(np.abs(ways[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[0.0, 1.0, 0.0]])
    u = np.cross(helper, ways)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    return u, np.cross(ways, u)
