"""Surfaces through closed sections, and tubes along a path: bodies, blades, skids."""

from math import cos, pi, sin

from .camera import cross, dot, normalize, subtract
from .mesh import grid


def loft(sections, across=(0.0, 1.0), along=None):
    """A smooth surface through closed sections of equally many points, which are not repeated.

    Its outside is along (next point of a section) x (same point of the next section). uv: u around
    over the range `across`, v from `along` (one value a section), by default their index in [0, 1].
    """
    last = len(sections) - 1
    along = along or [i / last for i in range(last + 1)]
    rows = [[*section, section[0]] for section in sections]
    start, end = across
    steps = len(sections[0])
    uv_rows = [[(start + (end - start) * j / steps, v) for j in range(steps + 1)] for v in along]
    return grid(rows, uv_rows, closed=True)


def tube(path, radius, segments=20):
    """A round tube of constant radius (or one radius a point) along the path, with round ends."""
    radii = list(radius) if hasattr(radius, "__iter__") else [radius] * len(path)
    last = len(path) - 1
    tangents = [
        normalize(subtract(path[min(i + 1, last)], path[max(i - 1, 0)])) for i in range(last + 1)
    ]
    helper = min(((1, 0, 0), (0, 1, 0), (0, 0, 1)), key=lambda axis: abs(dot(axis, tangents[0])))
    normal = normalize(cross(tangents[0], helper))
    sections = []

    def add(point, tangent, size, offset):
        binormal = cross(tangent, normal)
        center = [p + offset * t for p, t in zip(point, tangent)]
        sections.append(
            [
                tuple(
                    c + size * (cos(a) * n + sin(a) * b)
                    for c, n, b in zip(center, normal, binormal)
                )
                for a in (2 * pi * k / segments for k in range(segments))
            ]
        )

    caps = [pi / 2 * k / 5 for k in range(5)]
    for i, (point, tangent, size) in enumerate(zip(path, tangents, radii)):
        # The frame turns with the path as little as it can.
        slip = dot(normal, tangent)
        normal = normalize(tuple(n - slip * t for n, t in zip(normal, tangent)))
        if i == 0:
            for a in caps:
                add(point, tangent, max(size * sin(a), 1e-3 * size), -size * cos(a))
        add(point, tangent, size, 0.0)
        if i == last:
            for a in reversed(caps):
                add(point, tangent, max(size * sin(a), 1e-3 * size), size * cos(a))
    return loft(sections)


def _catmull_rom(t, p, q, r, s):
    return q + t / 2 * (r - p + t * (2 * p - 5 * q + 4 * r - s + t * (3 * (q - r) + s - p)))


def smooth_path(points, steps):
    """Catmull-Rom curve through the points, `steps` pieces between two of them."""
    ends = [points[0], *points, points[-1]]
    path = []
    for a, b, c, d in zip(ends, ends[1:], ends[2:], ends[3:]):
        for k in range(steps):
            t = k / steps
            path.append(tuple(_catmull_rom(t, *values) for values in zip(a, b, c, d)))
    return [*path, tuple(points[-1])]
