"""Meshes that change their shape while the shutter is open, as pieces that each move by one transform.

pbrt's shapes move by transforms alone. A mesh under an armature or with shape keys is cut into its connected pieces, and
each gets the affine motion nearest to that of its vertices; the piece that is furthest from it is halved until none is
further than a share of the way, or there are too many. glTF's skins are cut in the same way (src/gltf/moving_pieces.h).
"""

import heapq
import math

import numpy as np

# Radian; its arc is 1/800 of the way off the chord.
LEAST_TURN = 0.01

# Square of a share of a piece's extent: directions below a tenth of it hardly stretch. What noise would make of them turns
# normals until patches go dark (decision 0057).
RIDGE = 1e-2

# Most that a piece's volume may be stretched or squeezed; a piece that is squeezed to nothing can't be undone.
MOST_STRETCH = 20.0

# Joints bend in a few steps each; every piece is an instance that moves.
MOST_PIECES = 256

# Largest distance that vertices may be off, as a share of their way: where pieces meet, gaps of this size open until the
# shutter closes.
LEFT = 0.01
# Largest distance off, as a share of the way, that needs no warning.
MOST_LEFT_SILENTLY = 0.05


def connected(count, triangles):
    """The connected piece of each of (n, 3) `triangles` of `count` vertices, numbered from 0; all 0 where there are more
    than MOST_PIECES."""
    label = np.arange(count)
    while True:
        least = label[triangles].min(1)
        before = label.copy()
        for corner in range(3):
            np.minimum.at(label, triangles[:, corner], least)
        label = label[label]
        if (label == before).all():
            break
    _, numbers = np.unique(label[triangles[:, 0]], return_inverse=True)
    return numbers if numbers.size and numbers.max() < MOST_PIECES else np.zeros(len(triangles), dtype=int)


def motion(start, end):
    """The 4x4 affine matrix that takes (n, 3) `start` nearest to `end`, and the largest distance that it leaves.

    A rotation (Kabsch, "A solution for the best rotation to relate two sets of vectors", 1976), and the stretch that the rest
    asks for, by least squares with a ridge: along directions in which a piece has no extent it is the rotation alone.
    """
    start, end = start.astype(float), end.astype(float)
    middle, middle_end = start.mean(0), end.mean(0)
    x, y = start - middle, end - middle_end
    u, _, v = np.linalg.svd(x.T @ y)
    turn = v.T @ np.diag([1, 1, np.sign(np.linalg.det(v.T @ u.T))]) @ u.T
    spread = x.T @ x
    if np.trace(spread) > 0:
        ridge = RIDGE * np.trace(spread) * np.eye(3)
        stretched = turn + np.linalg.solve(spread + ridge, x.T @ (y - x @ turn.T)).T
        if 1 / MOST_STRETCH < np.linalg.det(stretched) < MOST_STRETCH:
            turn = stretched
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, middle_end - turn @ middle
    left = start @ turn.T + matrix[:3, 3] - end
    return matrix, float(np.sqrt((left**2).sum(1).max()))


def pivot(matrix, middle):
    """The point nearest to `middle` on the axis about which a 4x4 motion turns, or `middle` where it hardly turns: what hangs
    on a joint goes on arcs around it."""
    u, _, v = np.linalg.svd(matrix[:3, :3])
    turn = u @ v
    sines = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    twice_sine = np.linalg.norm(sines)
    if twice_sine < 2 * LEAST_TURN:
        return middle
    axis, half = sines / twice_sine, 0.5 * math.atan2(twice_sine, np.trace(turn) - 1)
    way = matrix[:3, :3] @ middle + matrix[:3, 3] - middle
    across = way - axis * (axis @ way)
    return middle + 0.5 * across + np.cross(axis, across) / (2 * math.tan(half))


def halves(middles, members):
    """Two of a piece, at the median along the longest side of the box of its triangles' (n, 3) middles."""
    at = middles[members]
    order = np.argsort(at[:, np.ptp(at, axis=0).argmax()], kind="stable")
    return members[order[: len(order) // 2]], members[order[len(order) // 2 :]]


def motions(start, end, triangles):
    """(piece of each triangle, [4x4 motion of each piece], share of the way that they leave): positions (n, 3) at both
    ends of the shutter, (m, 3) vertices of triangles; the share is of the largest way of a vertex."""
    way = float(np.sqrt(((end - start) ** 2).sum(1).max()))
    middles = start[triangles].mean(1)
    queue = []

    def add(members):
        used = np.unique(triangles[members])
        matrix, left = motion(start[used], end[used])
        # Pieces that can't be halved come last; ties are broken by place.
        heapq.heappush(queue, (-left if len(members) > 1 else 0.0, int(members.min()), left, members, matrix))

    piece = connected(len(start), triangles)
    for number in range(piece.max() + 1 if len(piece) else 0):
        add(np.flatnonzero(piece == number))
    while queue and len(queue) < MOST_PIECES and -queue[0][0] > LEFT * way:
        for members in halves(middles, heapq.heappop(queue)[3]):
            add(members)
    for number, (*_, members, _) in enumerate(queue):
        piece[members] = number
    return piece, [matrix for *_, matrix in queue], max((left for _, _, left, *_ in queue), default=0.0) / max(way, 1e-30)
