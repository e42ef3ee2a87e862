"""Transforms of Blender as text of pbrt."""

import math

import numpy as np

from .export_shaders import numbers

LEAST_DETERMINANT = 1e-30
FLATTEST = 1e-7  # the extent that is given to what has none along one axis, of its largest


def is_finite(matrix):
    return math.isfinite(sum(sum(row) for row in matrix))


def with_extent(matrix):
    """An object's matrix, with hardly any extent along an axis where it has none, as for a floor scaled by 0 along its normal, so that
    it can be inverted as in Cycles; None where it leaves no area."""
    if abs(matrix.determinant()) >= LEAST_DETERMINANT:
        return matrix
    u, extents, v = np.linalg.svd(np.array(matrix, float)[:3, :3])
    if extents[1] <= FLATTEST * extents[0]:
        return None
    flat = u @ np.diag([*extents[:2], extents[0] * FLATTEST * np.sign(np.linalg.det(u) * np.linalg.det(v))]) @ v
    found = matrix.copy()
    for row in range(3):
        found[row][:3] = flat[row]
    return found


def matrix_text(matrix):
    """pbrt lists columns first."""
    return numbers(matrix[row][column] for column in range(4) for row in range(4))


def is_same(a, b):
    return all(abs(x - y) < 1e-7 for r, s in zip(a, b) for x, y in zip(r, s))


def placement(directive, start, end):
    """A transform over the shutter; end None: at rest."""
    if end is None or is_same(start, end):
        return f"{directive} [{matrix_text(start)}]\n"
    return (f"ActiveTransform StartTime\n{directive} [{matrix_text(start)}]\n"
            f"ActiveTransform EndTime\n{directive} [{matrix_text(end)}]\nActiveTransform All\n")
