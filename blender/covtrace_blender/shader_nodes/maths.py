"""Arithmetic of numbers and vectors."""

import numpy as np

from .sight import is_cosine
from .unsupported import Unsupported


def _quotient(a, b):
    """Zero where there is none."""
    return np.where(b != 0, a / np.where(b != 0, b, 1), 0)


def _power(a, b):
    """Zero for a negative number to a power that is not whole."""
    whole = b == np.floor(b)
    size = np.abs(a) ** b
    return np.where(a >= 0, size, np.where(whole, np.where(b % 2 != 0, -size, size), 0))


def _wrap(a, b, c):
    spread = b - c
    return np.where(spread != 0, a - spread * np.floor((a - c) / np.where(spread != 0, spread, 1)), c)


def _ping_pong(a, b):
    safe = np.where(b != 0, b, 1)
    share = (a - b) / (safe * 2)
    return np.where(b != 0, np.abs((share - np.floor(share)) * b * 2 - b), 0)


def _smooth_min(a, b, c):
    reach = np.where(c > 0, c, 1)
    h = np.maximum(reach - np.abs(a - b), 0) / reach
    return np.where(c > 0, np.minimum(a, b) - h * h * h * c / 6, np.minimum(a, b))


OPERATIONS = {
    "ADD": np.add, "SUBTRACT": np.subtract, "MULTIPLY": np.multiply, "DIVIDE": _quotient,
    "MULTIPLY_ADD": lambda a, b, c: a * b + c, "POWER": _power,
    "LOGARITHM": lambda a, b: np.where((a > 0) & (b > 0), _quotient(np.log(np.maximum(a, 1e-38)), np.log(np.maximum(b, 1e-38))), 0),
    "SQRT": lambda a: np.sqrt(np.maximum(a, 0)), "INVERSE_SQRT": lambda a: np.where(a > 0, 1 / np.sqrt(np.maximum(a, 1e-38)), 0),
    "ABSOLUTE": np.abs, "EXPONENT": np.exp, "MINIMUM": np.minimum, "MAXIMUM": np.maximum,
    "LESS_THAN": lambda a, b: a < b, "GREATER_THAN": lambda a, b: a > b, "SIGN": np.sign,
    "COMPARE": lambda a, b, c: np.abs(a - b) <= np.maximum(c, 1e-5),
    "SMOOTH_MIN": _smooth_min, "SMOOTH_MAX": lambda a, b, c: -_smooth_min(-a, -b, c),
    "ROUND": lambda a: np.floor(a + 0.5), "FLOOR": np.floor, "CEIL": np.ceil, "TRUNC": np.trunc,
    "FRACT": lambda a: a - np.floor(a), "MODULO": lambda a, b: np.where(b != 0, np.fmod(a, np.where(b != 0, b, 1)), 0),
    "FLOORED_MODULO": lambda a, b: np.where(b != 0, np.mod(a, np.where(b != 0, b, 1)), 0),
    "WRAP": _wrap, "SNAP": lambda a, b: np.floor(_quotient(a, b)) * b, "PINGPONG": _ping_pong,
    "SINE": np.sin, "COSINE": np.cos, "TANGENT": np.tan,
    "ARCSINE": lambda a: np.where(np.abs(a) <= 1, np.arcsin(np.clip(a, -1, 1)), 0),
    "ARCCOSINE": lambda a: np.where(np.abs(a) <= 1, np.arccos(np.clip(a, -1, 1)), 0),
    "ARCTANGENT": np.arctan, "ARCTAN2": np.arctan2, "SINH": np.sinh, "COSH": np.cosh, "TANH": np.tanh,
    "RADIANS": np.radians, "DEGREES": np.degrees,
}


def _count(operation):
    return operation.nin if isinstance(operation, np.ufunc) else operation.__code__.co_argcount


def _math(node, output, inputs):
    if node.operation not in OPERATIONS:
        raise Unsupported(node, f"the operation {node.operation} has no counterpart")
    operation = OPERATIONS[node.operation]
    value = operation(*(inputs.number(i) for i in range(_count(operation))))
    return np.clip(value, 0, 1) if node.use_clamp else value


def _dot(a, b):
    return (a * b).sum(axis=-1)


def _length(a):
    return np.sqrt(_dot(a, a))


def _normalized(a):
    return _quotient(a, _length(a)[..., None])


def _project(a, b):
    return b * _quotient(_dot(a, b), _dot(b, b))[..., None]


def _reflect(a, b):
    normal = _normalized(b)
    return a - 2 * normal * _dot(a, normal)[..., None]


# Those of numbers act on each component; these are further ones.
VECTOR_OPERATIONS = {
    **{name: OPERATIONS[name] for name in ("ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "ABSOLUTE", "MINIMUM", "MAXIMUM",
                                           "ROUND", "FLOOR", "CEIL", "MODULO", "WRAP", "SNAP", "SINE", "COSINE", "TANGENT")},
    "FRACTION": OPERATIONS["FRACT"], "CROSS_PRODUCT": lambda a, b: np.cross(a, b), "PROJECT": _project, "REFLECT": _reflect,
    "DOT_PRODUCT": _dot, "DISTANCE": lambda a, b: _length(a - b), "LENGTH": _length, "NORMALIZE": _normalized,
}


def _vector_math(node, output, inputs):
    if is_cosine(node):
        return inputs.place.cosine()
    if node.operation == "SCALE":
        return inputs.vector(0) * inputs.number("Scale")[..., None]
    if node.operation not in VECTOR_OPERATIONS:
        raise Unsupported(node, f"the operation {node.operation} has no counterpart")
    operation = VECTOR_OPERATIONS[node.operation]
    return operation(*(inputs.vector(i) for i in range(_count(operation))))


def _clamp(node, output, inputs):
    low, high = inputs.number("Min"), inputs.number("Max")
    if node.clamp_type == "RANGE":
        low, high = np.minimum(low, high), np.maximum(low, high)
    return np.minimum(np.maximum(inputs.number("Value"), low), high)


def _map_range(node, output, inputs):
    if getattr(node, "data_type", "FLOAT") == "FLOAT":
        get, names = inputs.number, ("Value", "From Min", "From Max", "To Min", "To Max", "Steps")
    else:
        get = inputs.vector
        names = ("Vector", *(f"{name}_FLOAT3" for name in ("From_Min", "From_Max", "To_Min", "To_Max")), "Steps_FLOAT3")
    value, from_low, from_high, to_low, to_high = (get(name) for name in names[:5])
    kind = node.interpolation_type
    share = _quotient(value - from_low, from_high - from_low)
    if kind == "STEPPED":
        steps = get(names[5])
        share = _quotient(np.floor(share * (steps + 1)), steps)
    elif kind == "SMOOTHSTEP":
        share = np.clip(share, 0, 1)
        share = share * share * (3 - 2 * share)
    elif kind == "SMOOTHERSTEP":
        share = np.clip(share, 0, 1)
        share = share**3 * (share * (share * 6 - 15) + 10)
    mapped = np.where(from_low != from_high, to_low + share * (to_high - to_low), 0)
    if node.clamp and kind in ("LINEAR", "STEPPED"):
        return np.clip(mapped, np.minimum(to_low, to_high), np.maximum(to_low, to_high))
    return mapped


NODES = {"MATH": _math, "VECT_MATH": _vector_math, "CLAMP": _clamp, "MAP_RANGE": _map_range}
