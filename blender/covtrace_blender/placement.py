"""Transforms of Blender as text of pbrt."""

from .export_shaders import numbers


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
