"""Linear colours and their sRGB bytes. Colours are linear Rec. 709 triples everywhere else."""

_TABLE_SIZE = 8192


def _encode(value):
    if value <= 0.0031308:
        return 12.92 * value
    return 1.055 * value ** (1 / 2.4) - 0.055


_TABLE = bytes(round(255 * _encode(i / _TABLE_SIZE)) for i in range(_TABLE_SIZE + 1))


def srgb_byte(value):
    """The sRGB byte of a linear value, clamped to [0, 1]."""
    return _TABLE[int(min(max(value, 0.0), 1.0) * _TABLE_SIZE + 0.5)]


def linear_byte(value):
    """The byte of a value that is stored without a transfer curve, clamped to [0, 1]."""
    return int(min(max(value, 0.0), 1.0) * 255 + 0.5)


def mix(a, b, t):
    """Linear interpolation of two colours: a at t = 0, b at t = 1."""
    return (a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t)


def smoothstep(low, high, x):
    """Hermite step from 0 at `low` to 1 at `high` (which may be smaller than `low`)."""
    t = (x - low) / (high - low)
    t = 0.0 if t < 0.0 else 1.0 if t > 1.0 else t
    return t * t * (3 - 2 * t)
