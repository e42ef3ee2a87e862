"""Checkers and bricks."""

import numpy as np


def _checker(node, output, inputs):
    p = inputs.coordinates() * inputs.number("Scale")[..., None]
    cell = np.floor((p + 0.000001) * 0.999999).astype(int)  # as in Cycles: planes at whole numbers are of one cell
    is_first = (cell.sum(axis=-1) % 2 == 1)
    if output.type == "VALUE":
        return is_first
    return np.where(is_first[..., None], inputs.vector("Color1"), inputs.vector("Color2"))


def _tint(number):
    """In [0, 1], for each brick its own: a hash of whole numbers with Cycles' constants."""
    n = (number + 1013) & 0x7FFFFFFF
    n = ((n >> 13) ^ n).astype(np.uint32)
    n = (n * (n * n * np.uint32(60493) + np.uint32(19990303)) + np.uint32(1376312589)) & np.uint32(0x7FFFFFFF)
    return 0.5 * (n / 1073741824.0)


def _brick(node, output, inputs):
    p = inputs.coordinates() * inputs.number("Scale")[..., None]
    mortar_size, smooth, bias = (inputs.number(name) for name in ("Mortar Size", "Mortar Smooth", "Bias"))
    width, height = inputs.number("Brick Width"), inputs.number("Row Height")
    row = np.floor(p[..., 1] / height).astype(np.int64)
    shift = 0.0
    if node.offset_frequency and node.squash_frequency:
        width = np.where(row % node.squash_frequency == 0, width * node.squash, width)
        shift = np.where(row % node.offset_frequency == 0, width * node.offset, 0)
    along = p[..., 0] + shift
    column = np.floor(along / width).astype(np.int64)
    x, y = along - width * column, p[..., 1] - height * row
    tint = np.clip(_tint((row << 16) + (column & 0xFFFF)) + bias, 0, 1)[..., None]
    depth = np.minimum(np.minimum(x, y), np.minimum(width - x, height - y))
    share = 1 - depth / np.where(mortar_size > 0, mortar_size, 1)
    step = np.clip(share / np.where(smooth > 0, smooth, 1), 0, 1)
    mortar = np.where(depth >= mortar_size, 0, np.where((smooth == 0) | (share >= smooth), 1, step * step * (3 - 2 * step)))
    if output.type == "VALUE":
        return mortar
    brick = (1 - tint) * inputs.vector("Color1") + tint * inputs.vector("Color2")
    return brick * (1 - mortar[..., None]) + inputs.vector("Mortar") * mortar[..., None]


NODES = {"TEX_CHECKER": _checker, "TEX_BRICK": _brick}
