"""Colour ramps and curves, as tables that Blender's own evaluation fills."""

import numpy as np

# As many as Cycles has.
ENTRIES = 256


def _looked_up(table, x, is_stepped=False):
    """Rows of a table over [0, 1]."""
    at = np.clip(x, 0, 1) * (ENTRIES - 1)
    below = np.floor(at).astype(int)
    if is_stepped:
        return table[below]
    share = (at - below)[..., None]
    return table[below] * (1 - share) + table[np.minimum(below + 1, ENTRIES - 1)] * share


def _colour_ramp(node, output, inputs):
    ramp = node.color_ramp
    table = np.array([tuple(ramp.evaluate(i / (ENTRIES - 1))) for i in range(ENTRIES)], np.float32)
    found = _looked_up(table, inputs.number("Fac" if inputs.has("Fac") else "Factor"),
                       ramp.interpolation == "CONSTANT" and ramp.color_mode == "RGB")
    return found[..., 3] if output.identifier == "Alpha" else found[..., :3]


def _curve(mapping, curve, x, low, high):
    """Values of a curve; beyond `low` and `high` it goes on straight."""
    at = low + (high - low) * np.arange(ENTRIES) / (ENTRIES - 1)
    table = np.array([mapping.evaluate(curve, v) for v in at], np.float32)
    inside = np.interp(x, at, table)
    if mapping.extend == "HORIZONTAL":
        return inside
    step = at[1] - at[0]
    first, last = (table[1] - table[0]) / step, (table[-1] - table[-2]) / step
    return inside + np.minimum(x - low, 0) * first + np.maximum(x - high, 0) * last


def _range(mapping):
    """The first and last place of the points of all curves."""
    places = [point.location[0] for curve in mapping.curves for point in curve.points]
    return min(0.0, *places), max(1.0, *places)


def _rgb_curves(node, output, inputs):
    mapping = node.mapping
    mapping.initialize()
    low, high = _range(mapping)
    colour = inputs.vector("Color")
    together = mapping.curves[3]
    curved = np.stack([_curve(mapping, mapping.curves[i], _curve(mapping, together, colour[..., i], low, high), low, high)
                       for i in range(3)], axis=-1)
    return colour + (curved - colour) * inputs.number("Fac" if inputs.has("Fac") else "Factor")[..., None]


def _float_curve(node, output, inputs):
    mapping = node.mapping
    mapping.initialize()
    value = inputs.number("Value")
    return value + (_curve(mapping, mapping.curves[0], value, *_range(mapping)) - value) * inputs.number("Factor")


NODES = {"VALTORGB": _colour_ramp, "CURVE_RGB": _rgb_curves, "CURVE_FLOAT": _float_curve}
