"""The toy helicopter without its rotors, as meshes. Decimetres: nose along +x, left +y, up +z.

One row of elliptic sections runs from nose to tail: a bubble of glass, the cabin, the boom. Angles
around a section are counted from the top, positive to the left.
"""

from math import cos, pi, sin, sqrt

from .loft import loft, smooth_path, tube
from .mesh import Mesh, grid, lathe, rounded_prism

NOSE, FRONT, REAR, TAIL = 1.75, 0.45, -1.75, -4.1  # x of the nose, the cabin's two ends, the tail
TAIL_HEIGHT = 0.40
_WIDTH, _HEIGHT = 0.64, 0.72  # half axes of the largest section, at FRONT
_BOOM = 0.17
_FLOOR = -0.34
_AROUND = 72
_GLASS = 25  # of 72 steps: the bubble's glass ends 125 degrees from the top
_ROOF = 5  # over the doors it ends 25 degrees from the top
_DOOR = 21  # of 36 steps from the nose: the doors' front edge
MAST = (-0.25, 0.0, 1.3)  # hub of the main rotor
TAIL_HUB = (-4.16, 0.17, 0.86)


def _ease(t):
    return t * t * (3 - 2 * t)


def section(x):
    """(height of the middle, half width, half height) of the section at x."""
    if x > FRONT:
        t = (x - FRONT) / (NOSE - FRONT)
        round_off = sqrt(max(1e-6, 1 - t * t))
        return -0.14 * t * t, _WIDTH * round_off, _HEIGHT * round_off
    if x > REAR:
        t = _ease((FRONT - x) / (FRONT - REAR))
        return 0.25 * t, _WIDTH + (_BOOM - _WIDTH) * t, _HEIGHT + (1.1 * _BOOM - _HEIGHT) * t
    t = (REAR - x) / (REAR - TAIL)
    width = _BOOM + (0.075 - _BOOM) * t
    return 0.25 + (TAIL_HEIGHT - 0.25) * t * t, width, 1.1 * width


def _point(x, angle, scale=1.0):
    middle, width, height = section(x)
    return (x, scale * width * sin(angle), middle + scale * height * cos(angle))


def _ring(x, first=0, last=_AROUND - 1, scale=1.0):
    return [_point(x, 2 * pi * j / _AROUND, scale) for j in range(first, last + 1)]


def _bubble_places():
    """x from the nose to the cabin, closer together towards the nose."""
    angles = [pi / 2 * i / 36 for i in range(37)]
    return [FRONT + (NOSE - FRONT) * cos(a) for a in angles]


def _patch(first, last, places):
    """Part of the bubble between two steps around it, at these x."""
    rows = [_ring(x, first, last) for x in places]
    return grid(rows, [[(0.5, 0.5)] * len(rows[0])] * len(rows))


def glass():
    """The bubble's pane; the doors beside the seat are open."""
    places = _bubble_places()
    mesh = _patch(-_GLASS, _GLASS, places[: _DOOR + 1])
    mesh.append(_patch(-_ROOF, _ROOF, places[_DOOR:]))
    return mesh


def chin():
    """The painted shell under the bubble."""
    return _patch(_GLASS, _AROUND - _GLASS, _bubble_places())


def cabin_and_boom():
    """Everything behind the bubble. uv: u around from the top, v from the tail (0) to FRONT (1)."""
    places = [FRONT + (REAR - FRONT) * i / 44 for i in range(44)]
    places += [REAR + (TAIL - REAR) * i / 24 for i in range(25)]
    along = [(x - TAIL) / (FRONT - TAIL) for x in places]
    sections = [_ring(x) for x in places]
    # A round end.
    for k in range(1, 6):
        a = pi / 2 * k / 5
        shrink = max(cos(a), 1e-3)
        sections.append(
            [
                (x - 0.07 * sin(a), shrink * y, TAIL_HEIGHT + shrink * (z - TAIL_HEIGHT))
                for x, y, z in _ring(TAIL)
            ]
        )
        along.append(0.0)
    return loft(sections, along=along)


def frames():
    """Bars along the bubble's edges and over its middle."""
    mesh = tube([*_ring(FRONT), *_ring(FRONT, 0, 1)], 0.032, 12)
    places = _bubble_places()
    for step, radius, start in (
        (-_GLASS, 0.022, 0),
        (0, 0.018, 0),
        (_GLASS, 0.022, 0),
        (-_ROOF, 0.016, _DOOR),
        (_ROOF, 0.016, _DOOR),
    ):
        mesh.append(tube([_point(x, 2 * pi * step / _AROUND) for x in places[start:]], radius, 12))
    for first, last in ((-_GLASS, -_ROOF), (_ROOF, _GLASS)):
        mesh.append(tube(_ring(places[_DOOR], first, last), 0.016, 12))
    return mesh


def _box(low, high, radius=0.04):
    (x0, y0, z0), (x1, y1, z1) = low, high
    outline = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    return rounded_prism(outline, z0, z1, radius, lambda x, y, z: (x, y))


def interior():
    """Floor, bulkhead, seat and console."""
    rows = []
    for x in _bubble_places():
        middle, width, height = section(x)
        t = (_FLOOR - middle) / height
        if abs(t) < 0.98:
            half = 0.985 * width * sqrt(1 - t * t)
            rows.append([(x, half * (k / 8 - 1), _FLOOR) for k in range(17)])
    mesh = grid(rows, [[(0, 0)] * 17] * len(rows))
    wall = FRONT + 0.01
    mesh.append(loft([_ring(wall, scale=s) for s in (0.01, 0.99)]))
    mesh.append(_box((0.5, -0.24, _FLOOR), (0.86, 0.24, -0.2)))
    mesh.append(_box((0.48, -0.24, _FLOOR), (0.6, 0.24, 0.22)))
    mesh.append(_box((1.12, -0.2, _FLOOR), (1.28, 0.2, -0.04)))
    mesh.append(tube([(1.0, 0, _FLOOR), (0.94, 0, -0.08)], 0.016, 10))
    return mesh


def pilot():
    """A peg doll on the seat: name to mesh."""
    profile = [(0.15, 0.0), (0.17, 0.1), (0.16, 0.22), (0.11, 0.34), (0.06, 0.38)]
    smooth = [(x, z) for x, z, _ in smooth_path([(x, z, 0) for x, z in profile], 6)]
    ball = [(0.15 * sin(a) + 1e-4, -0.15 * cos(a)) for a in (pi * i / 24 for i in range(25))]
    angles = [pi / 2 * (1 + i / 12) for i in range(13)]
    cap = [(0.165 * sin(a) + 1e-4, -0.165 * cos(a)) for a in angles]
    cap = [(0.15, -0.02), (0.168, -0.02), *cap]
    head = (0.74, 0.0, 0.28)
    return {
        "pilot-body": _moved(lathe(smooth, 40), (0.74, 0.0, -0.2)),
        "pilot-head": _moved(lathe(ball, 40), head),
        "pilot-cap": _moved(lathe(cap, 40), (head[0], head[1], head[2] + 0.02)),
    }


def _moved(mesh, offset):
    mesh.positions = [tuple(a + b for a, b in zip(p, offset)) for p in mesh.positions]
    return mesh


def _ellipsoid(middle, radii, power=1.0):
    """A closed body; powers below one make it boxier lengthwise."""
    sections = []
    for i in range(41):
        a = pi * min(max(i / 40, 1e-3), 1 - 1e-3)
        size = sin(a) ** power
        sections.append(
            [
                (
                    middle[0] + radii[0] * cos(a),
                    middle[1] + radii[1] * size * sin(b),
                    middle[2] + radii[2] * size * cos(b),
                )
                for b in (2 * pi * j / 48 for j in range(48))
            ]
        )
    return loft(sections)


def engine():
    """The cowling on top of the cabin."""
    return _ellipsoid((-0.42, 0.0, 0.58), (0.92, 0.33, 0.36), 0.75)


def exhausts():
    """A bent pipe on either side, and the mast."""
    mesh = Mesh()
    for side in (-1, 1):
        bend = [(-0.75, 0.2, 0.66), (-1.0, 0.3, 0.7), (-1.25, 0.36, 0.76), (-1.42, 0.38, 0.83)]
        bend = smooth_path([(x, side * y, z) for x, y, z in bend], 6)
        mesh.append(tube(bend, [0.085 + 0.02 * i / (len(bend) - 1) for i in range(len(bend))], 24))
    shaft = [(0.13, 0.84), (0.12, 0.92), (0.06, 0.98), (0.055, MAST[2])]
    mesh.append(_moved(lathe(shaft, 32), (MAST[0], MAST[1], 0.0)))
    return mesh


def skids():
    """Two runners, bent up at the front, on two bows."""
    mesh = Mesh()
    for side in (-1, 1):
        runner = [(-1.15, -1.18), (-0.4, -1.18), (0.5, -1.18), (1.05, -1.17)]
        runner += [(1.38, -1.08), (1.58, -0.88)]
        mesh.append(tube(smooth_path([(x, side * 0.68, z) for x, z in runner], 8), 0.055, 20))
    for x in (-0.65, 0.55):
        bow = [(0.68, -1.18), (0.6, -0.92), (0.4, -0.7), (0.0, -0.6)]
        bow += [(-y, z) for y, z in bow[-2::-1]]
        mesh.append(tube(smooth_path([(x, y, z) for y, z in bow], 8), 0.045, 20))
    return mesh


def _wing(stations):
    """A lens-shaped aerofoil through stations (origin, chord vector, thickness vector)."""
    sections = []
    for origin, chord, thick in stations:
        sections.append(
            [
                tuple(o + 0.5 * (cos(a) * c + sin(a) * t) for o, c, t in zip(origin, chord, thick))
                for a in (2 * pi * k / 32 for k in range(32))
            ]
        )
    return loft(sections)


def _capped(low, high, chord, thick, turn_in=0.06):
    """Stations of a wing from low to high with rounded tips; chord and thick are (start, end)."""
    stations = []
    for i in range(25):
        t = i / 24
        edge = min(t, 1 - t)
        size = sqrt(max(1e-5, 1 - (1 - edge / turn_in) ** 2)) if edge < turn_in else 1.0
        origin = [a + (b - a) * t for a, b in zip(low, high)]
        stations.append(
            (
                origin,
                [size * (a + (b - a) * t) for a, b in zip(*chord)],
                [size * (a + (b - a) * t) for a, b in zip(*thick)],
            )
        )
    return stations


def fins():
    """Tail fin above and below the boom, and the stabiliser."""
    thick = ((0, 0.07, 0), (0, 0.045, 0))
    mesh = _wing(_capped((-4.0, 0, 0.3), (-4.42, 0, 1.28), ((0.62, 0, 0), (0.4, 0, 0)), thick))
    lower = ((0.3, 0, 0), (0.44, 0, 0))
    mesh.append(_wing(_capped((-4.22, 0, 0.02), (-4.02, 0, 0.42), lower, thick)))
    # Its span runs to the right, so that the outside faces outwards.
    chord, thick = ((0.3, 0, 0), (0.3, 0, 0)), ((0, 0, 0.05), (0, 0, 0.05))
    mesh.append(_wing(_capped((-3.2, 0.72, 0.33), (-3.2, -0.72, 0.33), chord, thick)))
    return mesh
