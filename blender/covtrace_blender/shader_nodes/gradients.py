"""Textures that are plain functions of the place: gradients and waves."""

import math

import numpy as np

from .noise import fractal


def _gradient(node, output, inputs):
    p = inputs.coordinates()
    x, y, z = (p[..., i] for i in range(3))
    kind = node.gradient_type
    if kind == "LINEAR":
        value = x
    elif kind == "QUADRATIC":
        value = np.maximum(x, 0) ** 2
    elif kind == "EASING":
        r = np.clip(x, 0, 1)
        value = r * r * (3 - 2 * r)
    elif kind == "DIAGONAL":
        value = 0.5 * (x + y)
    elif kind == "RADIAL":
        value = np.arctan2(y, x) / (2 * math.pi) + 0.5
    else:
        r = np.maximum(0.999999 - np.sqrt(x * x + y * y + z * z), 0)
        value = r * r if kind == "QUADRATIC_SPHERE" else r
    value = np.clip(value, 0, 1)
    return value if output.type == "VALUE" else np.repeat(value[..., None], 3, axis=-1)


def _wave(node, output, inputs):
    p = inputs.coordinates() * inputs.number("Scale")[..., None]
    p = (p + 0.000001) * 0.999999  # as in Cycles: borders do not lie on whole numbers
    if node.wave_type == "BANDS":
        n = p.sum(axis=-1) * 10 if node.bands_direction == "DIAGONAL" else p[..., "XYZ".index(node.bands_direction)] * 20
    else:
        kept = [i for i in range(3) if node.rings_direction == "SPHERICAL" or i != "XYZ".index(node.rings_direction)]
        n = np.sqrt((p[..., kept] ** 2).sum(axis=-1)) * 20
    n = n + inputs.number("Phase Offset")
    distortion = inputs.number("Distortion")
    if distortion.any():
        noise = fractal(p * inputs.number("Detail Scale")[..., None], inputs.number("Detail"),
                        inputs.number("Detail Roughness"))
        n = n + distortion * noise
    if node.wave_profile == "SIN":
        value = 0.5 + 0.5 * np.sin(n - math.pi / 2)
    elif node.wave_profile == "SAW":
        value = n / (2 * math.pi) % 1
    else:
        n = n / (2 * math.pi)
        value = np.abs(n - np.floor(n + 0.5)) * 2
    return value if output.type == "VALUE" else np.repeat(value[..., None], 3, axis=-1)


NODES = {"TEX_GRADIENT": _gradient, "TEX_WAVE": _wave}
