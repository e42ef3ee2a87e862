"""Nodes that change one colour."""

import numpy as np

from .colours import hsv_of, rgb_of_hsv, stacked


def _blend(a, b, share):
    return a + (b - a) * share[..., None]


def _hue_saturation(node, output, inputs):
    colour, share = inputs.vector("Color"), inputs.number("Fac" if inputs.has("Fac") else "Factor")
    hsv = hsv_of(colour)
    changed = stacked((hsv[..., 0] + inputs.number("Hue") + 0.5) % 1,
                      np.clip(hsv[..., 1] * inputs.number("Saturation"), 0, 1),
                      hsv[..., 2] * inputs.number("Value"))
    return np.maximum(_blend(colour, rgb_of_hsv(changed), share), 0)


def _bright_contrast(node, output, inputs):
    contrast = inputs.number("Contrast")[..., None]
    offset = inputs.number("Bright" if inputs.has("Bright") else "Brightness")[..., None] - 0.5 * contrast
    return np.maximum((1 + contrast) * inputs.vector("Color") + offset, 0)


def _gamma(node, output, inputs):
    colour, gamma = inputs.vector("Color"), inputs.number("Gamma")[..., None]
    return np.where(colour > 0, np.maximum(colour, 1e-30) ** gamma, colour)


def _invert(node, output, inputs):
    colour = inputs.vector("Color")
    return _blend(colour, 1 - colour, inputs.number("Fac" if inputs.has("Fac") else "Factor"))


NODES = {"HUE_SAT": _hue_saturation, "BRIGHTCONTRAST": _bright_contrast, "GAMMA": _gamma, "INVERT": _invert}
