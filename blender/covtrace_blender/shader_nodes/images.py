"""Images at places of a surface."""

import math

import numpy as np

from .. import tiled_images
from ..node_images import MISSING, image_of
from .unsupported import Unsupported

WRAPS = ("REPEAT", "EXTEND", "CLIP", "MIRROR")


def _wrapped(i, size, extension):
    """(indices of texels, whether they are of the image)."""
    if extension == "REPEAT":
        return i % size, True
    if extension == "MIRROR":
        i = i % (2 * size)
        return np.minimum(i, 2 * size - 1 - i), True
    inside = (i >= 0) & (i < size)
    return np.clip(i, 0, size - 1), inside if extension == "CLIP" else True


def sample(pixels, uv, extension, is_nearest):
    """(n, 4) at (n, 2) of an image (h, w, 4) from the top; v = 0 is its bottom."""
    height, width, _ = pixels.shape

    def texel(x, y):
        column, is_in_row = _wrapped(x, width, extension)
        row, is_in_column = _wrapped(y, height, extension)
        found = pixels[height - 1 - row, column]
        inside = is_in_row & is_in_column
        return found if inside is True else np.where(np.asarray(inside)[..., None], found, 0)

    if is_nearest:
        return texel(np.floor(uv[:, 0] * width).astype(int), np.floor(uv[:, 1] * height).astype(int))
    x, y = uv[:, 0] * width - 0.5, uv[:, 1] * height - 0.5
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = (x - x0)[:, None], (y - y0)[:, None]
    return (texel(x0, y0) * (1 - s) + texel(x0 + 1, y0) * s) * (1 - t) + \
        (texel(x0, y0 + 1) * (1 - s) + texel(x0 + 1, y0 + 1) * s) * t


def _boxed(node, inputs, look_up):
    """The image from the three axes' sides, each where the normal is near its axis; in between they are blended."""
    p = np.atleast_2d(inputs.coordinates("UV"))
    normal = inputs.place.coordinates(node, "NORMAL")
    x, y, z = (p[:, i] for i in range(3))
    share = np.abs(normal) / np.maximum(np.abs(normal).sum(axis=1, keepdims=True), 1e-30)
    weights = _box_weights(share, float(node.projection_blend))
    sides = ((np.where(normal[:, 0] < 0, 1 - y, y), z), (np.where(normal[:, 1] > 0, 1 - x, x), z),
             (np.where(normal[:, 2] > 0, 1 - y, y), x))
    return sum(weights[:, i, None] * look_up(np.column_stack(side)) for i, side in enumerate(sides))


def _box_weights(share, blend):
    """(n, 3) of the three axes. Of two axes, the one whose part of both is above (1 + blend) / 2 is alone."""
    limit = 0.5 * (1 + blend)
    first, second = share, np.roll(share, -1, axis=1)
    both = np.maximum(first + second, 1e-30)
    leads, follows = first > limit * both, second > limit * both  # of the pairs xy, yz, zx
    weights = np.zeros_like(share)
    alone = leads & np.roll(follows, 1, axis=1)
    is_open = ~alone.any(axis=1)
    weights[alone] = 1
    if blend <= 0:
        weights[is_open, 0] = 1
        return weights
    for i in range(3):  # the pair of i and the next axis, without the third
        third = np.roll(share, -2, axis=1)[:, i]
        pair = is_open & (third < (1 - limit) * both[:, i])
        of_first = np.clip((first[:, i] / both[:, i] - 0.5 * (1 - blend)) / blend, 0, 1)
        weights[pair, i], weights[pair, (i + 1) % 3] = of_first[pair], 1 - of_first[pair]
        is_open = is_open & ~pair
    weights[is_open] = ((2 - limit) * share[is_open] + limit - 1) / (2 * limit - 1)
    return weights


def _around(p, is_sphere):
    """(n, 2): places of an image that is wrapped around the axis z of [0, 1]^3."""
    x, y, z = (2 * p[:, i] - 1 for i in range(3))
    length = np.sqrt(x * x + y * y + (z * z if is_sphere else 0))
    u = np.where((x == 0) & (y == 0), 0, 0.5 * (1 - np.arctan2(x, y) / math.pi))
    v = 1 - np.arccos(np.clip(z / np.maximum(length, 1e-30), -1, 1)) / math.pi if is_sphere else 0.5 * (z + 1)
    return np.column_stack((np.where(length > 0, u, 0), np.where(length > 0, v, 0)))


def _image(node, output, inputs):
    if not node.image:  # as in Cycles, like an image whose file is missing
        return np.float32(MISSING[3]) if output.identifier == "Alpha" else np.array(MISSING[:3], np.float32)
    if node.extension not in WRAPS:
        raise Unsupported(node, f"its extension {node.extension.lower()} has no counterpart")

    def look_up(uv):
        uv = uv / np.array(tiled_images.grid(node.image), np.float32)
        return sample(inputs.place.pixels(image_of(node)), uv, node.extension, node.interpolation == "Closest")

    if node.projection == "BOX":
        found = _boxed(node, inputs, look_up)
    elif node.projection == "FLAT":
        found = look_up(np.atleast_2d(inputs.coordinates("UV"))[:, :2])
    else:
        found = look_up(_around(np.atleast_2d(inputs.coordinates("UV")), node.projection == "SPHERE"))
    return found[:, 3] if output.identifier == "Alpha" else found[:, :3]


NODES = {"TEX_IMAGE": _image}
