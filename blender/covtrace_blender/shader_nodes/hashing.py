"""Random numbers of cells: Bob Jenkins' lookup3 (2006, public domain), as Blender's textures use it."""

import numpy as np


def _rotated(x, bits):
    turned = x << np.uint32(bits)
    turned |= x >> np.uint32(32 - bits)
    return turned


def _final(a, b, c):
    for bits in ((14, 11, 25), (16, 4, 14)):
        c = c ^ b
        c -= _rotated(b, bits[0])
        a = a ^ c
        a -= _rotated(c, bits[1])
        b = b ^ a
        b -= _rotated(a, bits[2])
    c ^= b
    c -= _rotated(b, 24)
    return c


def _mixed(a, b, c):
    for bits in ((4, 6, 8), (16, 19, 4)):
        a = (a - c) ^ _rotated(c, bits[0])
        c = c + b
        b = (b - a) ^ _rotated(a, bits[1])
        a = a + c
        c = (c - b) ^ _rotated(b, bits[2])
        b = b + a
    return a, b, c


def hashed(*keys):
    """uint32 of one to four uint32 arrays of one shape."""
    with np.errstate(over="ignore"):
        start = np.uint32((0xDEADBEEF + (len(keys) << 2) + 13) & 0xFFFFFFFF)
        a, b, c = (start + key for key in (*keys, *(np.uint32(0),) * 2)[:3])
        if len(keys) > 3:
            a, b, c = _mixed(a, b, c)
            a = a + keys[3]
        return _final(a, b, c)


def bits(value):
    """The bits of float32 as uint32."""
    return np.ascontiguousarray(value, np.float32).view(np.uint32)


def hashed_number(*values):
    """In [0, 1], of the bits of one to four float32 arrays."""
    values = np.broadcast_arrays(*(np.asarray(v, np.float32) for v in values))
    shape = values[0].shape
    return hashed(*(bits(v).reshape(shape) for v in values)).astype(np.float32) / np.float32(0xFFFFFFFF)


def hashed_numbers(*values):
    """Three arrays in [0, 1], of one to four numbers."""
    if len(values) == 4:
        x, y, z, w = values
        keys = ((x, y, z, w), (z, x, w, y), (w, z, y, x))
    else:
        keys = (values, (*values, 1.0), (*values, 2.0))
    return [hashed_number(*key) for key in keys]


def hashed_place(*values):
    """As many arrays in [0, 1] as there are numbers, one to four."""
    if len(values) == 4:
        return [hashed_number(*(values[(axis - turn) % 4] for axis in range(4))) for turn in range(4)]
    return hashed_numbers(*values)[:len(values)]


def hashed_vector(*values):
    """(..., 3) in [0, 1], of one to four numbers."""
    return np.stack(hashed_numbers(*values), axis=-1)


# By how many axes there are, and axis: those whose product is added to it; None: a constant.
_FACTORS = {2: ((1, None), (0, None)), 3: ((1, 2), (2, 0), (0, 1)), 4: ((1, 3), (2, 0), (0, 1), (1, 2))}


def _permuted(*keys):
    """int32 arrays of the same number, two to four, by the hash functions pcg2d, pcg3d and pcg4d of Jarzynski and Olano, "Hash Functions
    for GPU Rendering", JCGT 9(3), 2020, section 4.2, in signed integers."""
    with np.errstate(over="ignore"):
        v = [key.astype(np.int32) * np.int32(1664525) + np.int32(1013904223) for key in keys]
        for is_last in (False, True):
            for axis, (first, second) in enumerate(_FACTORS[len(v)]):
                v[axis] = v[axis] + v[first] * (np.int32(1664525) if second is None else v[second])
            if not is_last:
                v = [axis ^ (axis >> np.int32(16)) for axis in v]
    return v


def permuted_numbers(*keys):
    """Arrays in [0, 1], as many as there are arrays of whole numbers, two to four."""
    largest = np.int32(0x7FFFFFFF)
    return [(axis & largest).astype(np.float32) / np.float32(largest) for axis in _permuted(*keys)]
