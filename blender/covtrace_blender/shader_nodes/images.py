"""Images at places of a surface."""

import numpy as np

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


def _image(node, output, inputs):
    if not node.image:
        raise Unsupported(node, "it has no image")
    if node.projection != "FLAT":
        raise Unsupported(node, f"its projection {node.projection.lower()} has no counterpart")
    if node.extension not in WRAPS:
        raise Unsupported(node, f"its extension {node.extension.lower()} has no counterpart")
    uv = np.atleast_2d(inputs.coordinates("UV"))[:, :2]
    found = sample(inputs.place.pixels(node.image), uv, node.extension, node.interpolation == "Closest")
    return found[:, 3] if output.identifier == "Alpha" else found[:, :3]


NODES = {"TEX_IMAGE": _image}
