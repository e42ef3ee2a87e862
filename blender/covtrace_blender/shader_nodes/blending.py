"""The node Mix of numbers, vectors and colours."""

import numpy as np

from .colours import hsv_of, rgb_of_hsv
from .unsupported import Unsupported


def _soft_light(a, b, t):
    screen = 1 - (1 - b) * (1 - a)
    return (1 - t) * a + t * ((1 - a) * b * a + a * screen)


def _dodge(a, b, t):
    below = 1 - t * b
    return np.where(a == 0, 0, np.where(below <= 0, 1, np.minimum(a / np.where(below == 0, 1, below), 1)))


def _burn(a, b, t):
    below = 1 - t + t * b
    return np.where(below <= 0, 0, np.clip(1 - (1 - a) / np.where(below == 0, 1, below), 0, 1))


def _with(*channels):
    """Mixture with the colour a that takes these channels of hue, saturation and value from b."""
    def mix(a, b, t):
        of_a, of_b = (hsv_of(np.broadcast_to(c, np.broadcast_shapes(a.shape, b.shape))) for c in (a, b))
        changed = of_a.copy()
        changed[..., channels] = of_b[..., channels]
        if 0 in channels:  # grey has no hue to give
            changed = np.where(of_b[..., 1:2] == 0, of_a, changed)
            return np.where(of_b[..., 1:2] == 0, a, a + (rgb_of_hsv(changed) - a) * t)
        changed = of_a.copy()
        changed[..., channels] = (1 - t) * of_a[..., channels] + t * of_b[..., channels]
        return np.where((of_a[..., 1:2] == 0) & (channels == (1,)), a, rgb_of_hsv(changed))
    return mix


# Colours a and b with the share t of the second one.
BLENDS = {
    "MIX": lambda a, b, t: a + (b - a) * t,
    "ADD": lambda a, b, t: a + b * t,
    "SUBTRACT": lambda a, b, t: a - b * t,
    "MULTIPLY": lambda a, b, t: a * (1 - t + b * t),
    "DIVIDE": lambda a, b, t: np.where(b != 0, (1 - t) * a + t * a / np.where(b != 0, b, 1), a),
    "SCREEN": lambda a, b, t: 1 - (1 - t + t * (1 - b)) * (1 - a),
    "OVERLAY": lambda a, b, t: np.where(a < 0.5, a * (1 - t + 2 * t * b), 1 - (1 - t + 2 * t * (1 - b)) * (1 - a)),
    "DARKEN": lambda a, b, t: a + (np.minimum(a, b) - a) * t,
    "LIGHTEN": lambda a, b, t: a + (np.maximum(a, b) - a) * t,
    "DIFFERENCE": lambda a, b, t: a + (np.abs(a - b) - a) * t,
    "EXCLUSION": lambda a, b, t: np.maximum(a + (b - 2 * a * b) * t, 0),
    "LINEAR_LIGHT": lambda a, b, t: a + t * (2 * b - 1),
    "SOFT_LIGHT": _soft_light,
    "DODGE": _dodge,
    "BURN": _burn,
    "HUE": _with(0),
    "SATURATION": _with(1),
    "VALUE": _with(2),
    "COLOR": _with(0, 1),
}


def _blend(node, a, b, share):
    if node.blend_type not in BLENDS:
        raise Unsupported(node, f"the blend {node.blend_type} has no counterpart")
    return BLENDS[node.blend_type](a, b, share[..., None])


def _mix(node, output, inputs):
    """The node of Blender 3.4 and later, whose sockets hang on what it mixes."""
    def bounded(share):
        return np.clip(share, 0, 1) if node.clamp_factor else share
    if node.data_type == "FLOAT":
        a, b, share = (inputs.number(name) for name in ("A_Float", "B_Float", "Factor_Float"))
        return a + (b - a) * bounded(share)
    if node.data_type == "VECTOR":
        a, b = inputs.vector("A_Vector"), inputs.vector("B_Vector")
        if node.factor_mode == "NON_UNIFORM":
            return a + (b - a) * bounded(inputs.vector("Factor_Vector"))
        return a + (b - a) * bounded(inputs.number("Factor_Float"))[..., None]
    if node.data_type != "RGBA":
        raise Unsupported(node, f"it mixes what has no counterpart: {node.data_type.lower()}")
    colour = _blend(node, inputs.vector("A_Color"), inputs.vector("B_Color"), bounded(inputs.number("Factor_Float")))
    return np.clip(colour, 0, 1) if node.clamp_result else colour


def _mix_rgb(node, output, inputs):
    """The node of colours alone that older files have."""
    colour = _blend(node, inputs.vector(1), inputs.vector(2), np.clip(inputs.number(0), 0, 1))
    return np.clip(colour, 0, 1) if node.use_clamp else colour


NODES = {"MIX": _mix, "MIX_RGB": _mix_rgb}
