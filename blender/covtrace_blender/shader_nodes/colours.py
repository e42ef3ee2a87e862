"""Colours as channels of several models."""

import numpy as np

from ..working_space import luminance
from .blackbody import blackbodies, blackbody, temperature_of


def _hue(rgb, largest, spread):
    r, g, b = (rgb[..., i] for i in range(3))
    safe = np.where(spread > 0, spread, 1)
    sixths = np.where(largest == r, (g - b) / safe, np.where(largest == g, 2 + (b - r) / safe, 4 + (r - g) / safe))
    return np.where(spread > 0, sixths / 6 % 1, 0)


def _fully(hue):
    """The most saturated colour of a hue."""
    return np.clip(np.stack([np.abs(hue * 6 - 3) - 1, 2 - np.abs(hue * 6 - 2), 2 - np.abs(hue * 6 - 4)], axis=-1), 0, 1)


def hsv_of(rgb):
    """(..., 3) hue, saturation, value."""
    largest, smallest = rgb.max(axis=-1), rgb.min(axis=-1)
    spread = largest - smallest
    saturation = np.where(largest != 0, spread / np.where(largest != 0, largest, 1), 0)
    return np.stack([_hue(rgb, largest, spread), saturation, largest], axis=-1)


def rgb_of_hsv(hsv):
    h, s, v = (hsv[..., i, None] for i in range(3))
    return ((_fully(h[..., 0]) - 1) * s + 1) * v


def hsl_of(rgb):
    """(..., 3) hue, saturation, lightness."""
    largest, smallest = rgb.max(axis=-1), rgb.min(axis=-1)
    spread, total = largest - smallest, largest + smallest
    below = np.where(total > 1, 2 - total, total)
    saturation = np.where(spread > 0, spread / np.where(below != 0, below, 1), 0)
    return np.stack([_hue(rgb, largest, spread), saturation, 0.5 * total], axis=-1)


def rgb_of_hsl(hsl):
    h, s, lightness = (hsl[..., i, None] for i in range(3))
    chroma = (1 - np.abs(2 * lightness - 1)) * s
    return (_fully(h[..., 0]) - 0.5) * chroma + lightness


TO_MODEL = {"RGB": lambda c: c, "HSV": hsv_of, "HSL": hsl_of}
FROM_MODEL = {"RGB": lambda c: c, "HSV": rgb_of_hsv, "HSL": rgb_of_hsl}


def stacked(*numbers):
    """Vectors of three numbers, some of which may be the same everywhere."""
    return np.stack(np.broadcast_arrays(*numbers), axis=-1)


def _separate(model_of, source):
    def separate(node, output, inputs):
        names = [s.identifier for s in node.outputs]
        return TO_MODEL[model_of(node)](inputs.vector(source))[..., names.index(output.identifier)]
    return separate


def _combine(model_of):
    def combine(node, output, inputs):
        return FROM_MODEL[model_of(node)](stacked(*(inputs.number(i) for i in range(3))))
    return combine


def _constant(node, output, inputs):
    value = np.asarray(output.default_value, np.float32)
    return value[:3] if value.ndim else value


def _blackbody(node, output, inputs):
    kelvin = temperature_of(node)
    return blackbodies(inputs.number("Temperature")) if kelvin is None else blackbody(kelvin)


NODES = {
    "RGB": _constant,
    "VALUE": _constant,
    "BLACKBODY": _blackbody,
    "RGBTOBW": lambda node, output, inputs: luminance(inputs.vector("Color")),
    "SEPARATE_COLOR": _separate(lambda node: node.mode, 0),
    "SEPRGB": _separate(lambda node: "RGB", 0),
    "SEPHSV": _separate(lambda node: "HSV", 0),
    "SEPXYZ": _separate(lambda node: "RGB", 0),
    "COMBINE_COLOR": _combine(lambda node: node.mode),
    "COMBRGB": _combine(lambda node: "RGB"),
    "COMBHSV": _combine(lambda node: "HSV"),
    "COMBXYZ": _combine(lambda node: "RGB"),
}
