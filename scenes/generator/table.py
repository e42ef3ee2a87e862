"""The snooker table as meshes: bed, cushions, wooden rails and pockets.

World: metres, z up, the cloth at z = 0, the table's middle at the origin and its long side
along x. Nose line: the front edge of the cushions, which bounds the playing area.
"""

from math import acos, asin, atan2, copysign, cos, pi, sin

from .mesh import Mesh, arc, flat_polygon, grid, lathe, rounded_prism

HALF_LENGTH, HALF_WIDTH = 3.57 / 2, 1.78 / 2
CUSHION_DEPTH, CUSHION_HEIGHT = 0.05, 0.042
RAIL_TOP = 0.046
_RAIL_WIDTH, _RAIL_BOTTOM = 0.115, -0.16
_POCKET_RADIUS, _RIM_RADIUS, _WOOD_CUT = 0.045, 0.0475, 0.052

_BACK_X, _BACK_Y = HALF_LENGTH + CUSHION_DEPTH, HALF_WIDTH + CUSHION_DEPTH
_OUTER_X, _OUTER_Y = _BACK_X + _RAIL_WIDTH, _BACK_Y + _RAIL_WIDTH
CORNER_POCKET = (HALF_LENGTH + 0.02, HALF_WIDTH + 0.02)
MIDDLE_POCKET = (0.0, HALF_WIDTH + 0.045)


def pocket_centers():
    """The six pockets' centres in the plane."""
    (x, y), (_, middle) = CORNER_POCKET, MIDDLE_POCKET
    return [(x, y), (0.0, middle), (-x, y), (-x, -y), (0.0, -middle), (x, -y)]


def _corner_cut(radius):
    """Angle below the +x axis at which a circle about a corner pocket meets x = _BACK_X."""
    return acos((_BACK_X - CORNER_POCKET[0]) / radius)


def _middle_cut(radius):
    """Angle above the +x axis at which a circle about a middle pocket meets y = _BACK_Y."""
    return asin((_BACK_Y - MIDDLE_POCKET[1]) / radius)


def _quarter_turn(points, quarters):
    for _ in range(quarters):
        points = [(-y, x) for x, y in points]
    return points


def bed():
    """The cloth over the slate, with six holes; uv are metres in the plane."""
    hole = _POCKET_RADIUS + 0.006
    corner, middle = _corner_cut(hole), _middle_cut(hole)
    cx, cy = CORNER_POCKET
    # Along the border, counter-clockwise; each hole bites in clockwise.
    notch = arc((0, 0), hole, 2 * pi - corner, pi / 2 + corner, 28)
    outline = [(cx + x, cy + y) for x, y in notch]
    outline += arc(MIDDLE_POCKET, hole, middle, -pi - middle, 28)
    outline += [(-cx - y, cy + x) for x, y in notch]
    outline += [(-cx - x, -cy - y) for x, y in notch]
    outline += [(-x, -y) for x, y in arc(MIDDLE_POCKET, hole, middle, -pi - middle, 28)]
    outline += [(cx + y, -cy - x) for x, y in notch]
    return flat_polygon(outline, 0.0, lambda x, y, z: (x, y))


# Cross-section of a cushion: (share of the depth behind the nose, height).
_PROFILE = (
    [(0.34, 0.0), (0.22, 0.010), (0.10, 0.020), (0.035, 0.0265)]
    + [(0.08 - 0.08 * cos(a), 0.0315 + 0.0052 * sin(a)) for a in (-0.6, -0.3, 0.0, 0.4, 0.8, 1.2)]
    + [(0.16, 0.0381), (0.30, 0.0398), (0.55, 0.0410)]
    + [(0.80, CUSHION_HEIGHT), (1.0, CUSHION_HEIGHT)]
)


def _jaw(radius, steps):
    """(advance along the rail, retreat from the nose line) of the rounded end of a cushion."""
    last = acos(1 - CUSHION_DEPTH / radius)
    angles = [last * i / steps for i in range(steps + 1)]
    return [(radius * sin(a), radius * (1 - cos(a))) for a in angles]


def _nose(start, end, start_jaw, end_jaw):
    """Nose curve from `start` to `end` along the rail as (position, retreat) pairs."""
    steps = max(2, round((end - start) / 0.05))
    straight = [(start + (end - start) * i / steps, 0.0) for i in range(1, steps)]
    left = [(start - advance, retreat) for advance, retreat in reversed(_jaw(start_jaw, 14))]
    right = [(end + advance, retreat) for advance, retreat in _jaw(end_jaw, 14)]
    return left + straight + right


def _cushion(nose, distance, quarters):
    """One cushion along +x at y = `distance`, then turned by quarter turns about z."""
    rows, uv_rows = [], []
    for share, height in _PROFILE:
        row, uv_row = [], []
        for along, retreat in nose:
            # At its tips the nose reaches the back of the rail; a sliver stays, so that the
            # end has a direction.
            depth = max(CUSHION_DEPTH - retreat, 5e-4)
            y = distance + retreat + share * depth
            (px, py), = _quarter_turn([(along, y)], quarters)
            (u, v), = _quarter_turn([(along, y + height)], quarters)
            row.append((px, py, height))
            uv_row.append((u, v))
        rows.append(row)
        uv_rows.append(uv_row)
    return grid(rows, uv_rows)


def cushions():
    """The six cushions as one mesh; uv are metres of cloth."""
    corner_start, middle_start = 0.098, 0.112
    long_nose = _nose(middle_start, HALF_LENGTH - corner_start, 0.06, 0.08)
    mirrored = [(-along, retreat) for along, retreat in reversed(long_nose)]
    reach = HALF_WIDTH - corner_start
    short_nose = _nose(-reach, reach, 0.08, 0.08)
    mesh = Mesh()
    for quarters, noses, distance in (
        (0, (long_nose, mirrored), HALF_WIDTH),
        (1, (short_nose,), HALF_LENGTH),
        (2, (long_nose, mirrored), HALF_WIDTH),
        (3, (short_nose,), HALF_LENGTH),
    ):
        for nose in noses:
            mesh.append(_cushion(nose, distance, quarters))
    return mesh


def _board(polygon, quarters, offset):
    """A wooden board; uv are metres, u along the grain (x before the quarter turns)."""

    def grain(x, y, z):
        (along, across), = _quarter_turn([(x, y)], (4 - quarters) % 4)
        return (along + offset, across - z + 0.37 * offset)

    turned = _quarter_turn(polygon, quarters)
    return rounded_prism(turned, _RAIL_BOTTOM, RAIL_TOP, 0.005, grain)


def rails():
    """The four sides of the wooden frame as six boards with mitred corners."""
    corner, middle = _corner_cut(_WOOD_CUT), _middle_cut(_WOOD_CUT)
    cx, cy = CORNER_POCKET
    gap = 0.0006
    # Above the corner pocket's centre the angle runs from the long rail's side to the mitre.
    upper = arc((cx, cy), _WOOD_CUT, pi / 2 + corner, pi / 4, 16)
    long_board = (
        arc(MIDDLE_POCKET, _WOOD_CUT, pi / 2 - gap / _WOOD_CUT, middle, 9)
        + [(x - gap, y) for x, y in upper]
        + [(_OUTER_X - gap, _OUTER_Y), (gap, _OUTER_Y)]
    )
    mirrored = [(-x, y) for x, y in reversed(long_board)]
    # The short sides, written for y = +; their corner pockets lie at (+-cy, cx).
    right = arc((cy, cx), _WOOD_CUT, pi / 2 + corner, pi / 4, 16)
    left = [(-x, y) for x, y in reversed(right)]
    short_board = left + right + [(_OUTER_Y, _OUTER_X), (-_OUTER_Y, _OUTER_X)]
    mesh = Mesh()
    for index, (polygon, quarters) in enumerate(
        [(long_board, 0), (mirrored, 0), (short_board, 1)]
        + [(long_board, 2), (mirrored, 2), (short_board, 3)]
    ):
        mesh.append(_board(polygon, quarters, 0.71 * index))
    return mesh


def _translated(mesh, x, y):
    mesh.positions = [(px + x, py + y, pz) for px, py, pz in mesh.positions]
    return mesh


def _angles(start, end, steps):
    return [start + (end - start) * i / steps for i in range(steps + 1)]


def pocket_liners():
    """Leather cups below the six holes, as one mesh."""
    lip = [
        (_POCKET_RADIUS + 0.006 * (1 - sin(a)), -0.006 * (1 - cos(a)))
        for a in _angles(0, pi / 2, 8)
    ]
    profile = [*lip, (_POCKET_RADIUS - 0.006, -0.11), (1e-5, -0.11)]
    mesh = Mesh()
    for x, y in pocket_centers():
        mesh.append(_translated(lathe(profile, 48), x, y))
    return mesh


def pocket_rims():
    """Brass edges around the pockets on the side of the wood, as one mesh."""
    half = (_WOOD_CUT - _RIM_RADIUS) / 2
    middle = _RIM_RADIUS + half
    top = RAIL_TOP + 0.001
    crown = [(middle + half * cos(a), top - half + half * sin(a)) for a in _angles(0, pi, 10)]
    profile = [(_WOOD_CUT, -0.002), *crown, (_RIM_RADIUS, -0.002)]
    mesh = Mesh()
    for x, y in pocket_centers():
        outwards = atan2(copysign(1, y), copysign(1, x) if x else 0)
        half_span = pi / 4 + _corner_cut(middle) if x else pi / 2 - _middle_cut(middle)
        rim = lathe(profile, 48, outwards - half_span, outwards + half_span)
        mesh.append(_translated(rim, x, y))
    return mesh
