"""A cue: tip, ferrule, shaft and butt as meshes along +z, the tip's end at the origin."""

from math import cos, pi, sin

from .camera import cross, normalize
from .mesh import lathe

LENGTH = 1.45
_TIP_RADIUS, _BUTT_RADIUS = 0.0048, 0.0145


def _radius(z):
    return _TIP_RADIUS + (_BUTT_RADIUS - _TIP_RADIUS) * z / LENGTH


def _tube(start, end, rings):
    heights = [start + (end - start) * i / rings for i in range(rings + 1)]
    mesh = lathe([(_radius(z), z) for z in heights], 32)
    # Wood runs along the cue, 4 cm of pattern around it.
    mesh.uvs = [(position[2], 0.04 * u) for position, (u, _) in zip(mesh.positions, mesh.uvs)]
    return mesh


def parts():
    """Name to mesh: tip (leather), ferrule (brass), shaft and butt (wood, uv in metres)."""
    angles = (0.01, 0.4, 0.8, 1.2, pi / 2)
    dome = [(0.9 * _TIP_RADIUS * sin(a), 0.003 * (1 - cos(a))) for a in angles]
    butt = _tube(LENGTH - 0.42, LENGTH, 8)
    butt.append(lathe([(_BUTT_RADIUS, LENGTH), (1e-5, LENGTH)], 32))
    return {
        "tip": lathe([*dome, (_TIP_RADIUS, 0.009)], 32),
        "ferrule": _tube(0.009, 0.021, 1),
        "shaft": _tube(0.021, LENGTH - 0.42, 20),
        "butt": butt,
    }


def placement(tip, direction):
    """pbrt Transform (16 numbers, column-major) that lays the cue from `tip` along `direction`."""
    z = normalize(direction)
    x = normalize(cross((0, 0, 1), z))
    y = cross(z, x)
    return [*x, 0, *y, 0, *z, 0, *tip, 1]
