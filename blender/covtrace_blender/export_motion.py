"""Meshes that change their shape while the shutter is open, as pieces that each move rigidly.

pbrt's shapes move by transforms alone. A mesh under an armature or with shape keys is cut into its connected pieces, and
each gets the rigid motion nearest to that of its vertices; what bends stays as it is when the shutter opens.
"""

import numpy as np

# Machines and figures have fewer loose parts; hair and leaves move as one.
MOST_PIECES = 256


def pieces(count, edges):
    """The connected piece of each of `count` vertices, numbered from 0; all 0 where there are more than MOST_PIECES."""
    label = np.arange(count)
    while len(edges):
        a, b = label[edges[:, 0]], label[edges[:, 1]]
        least = np.minimum(a, b)
        before = label.copy()
        np.minimum.at(label, a, least)
        np.minimum.at(label, b, least)
        label = label[label]
        if (label == before).all():
            break
    _, numbers = np.unique(label, return_inverse=True)
    return numbers if numbers.size and numbers.max() < MOST_PIECES else np.zeros(count, dtype=int)


def rigid_motion(start, end):
    """The 4x4 matrix of a rotation and translation that takes (n, 3) `start` nearest to `end`, and the largest distance
    that it leaves: Kabsch, "A solution for the best rotation to relate two sets of vectors", 1976."""
    start, end = start.astype(float), end.astype(float)
    middle, middle_end = start.mean(0), end.mean(0)
    u, _, v = np.linalg.svd((start - middle).T @ (end - middle_end))
    turn = v.T @ np.diag([1, 1, np.sign(np.linalg.det(v.T @ u.T))]) @ u.T
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, middle_end - turn @ middle
    left = start @ turn.T + matrix[:3, 3] - end
    return matrix, float(np.sqrt((left**2).sum(1).max()))


def motions(start, end, edges):
    """(piece of each vertex, [4x4 motion of each piece], share of the way that they leave): positions (n, 3) at both
    ends of the shutter; the share is of the largest way of a vertex."""
    piece = pieces(len(start), edges)
    found = [rigid_motion(start[piece == k], end[piece == k]) for k in range(piece.max() + 1)]
    way = float(np.sqrt(((end - start) ** 2).sum(1).max()))
    return piece, [matrix for matrix, _ in found], max(left for _, left in found) / max(way, 1e-30)
