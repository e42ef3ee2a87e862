"""Triangle meshes with normals and uv, and the few ways the scenes build them."""

from dataclasses import dataclass, field
from math import acos, atan2, cos, hypot, pi, sin, sqrt

from .camera import cross, normalize, subtract


@dataclass
class Mesh:
    """Parallel lists: positions, normals (unit) and uvs per vertex; faces index them."""

    positions: list = field(default_factory=list)
    normals: list = field(default_factory=list)
    uvs: list = field(default_factory=list)
    faces: list = field(default_factory=list)

    def add_vertex(self, position, normal, uv):
        """Adds a vertex and returns its index."""
        self.positions.append(tuple(position))
        self.normals.append(tuple(normal))
        self.uvs.append(tuple(uv))
        return len(self.positions) - 1

    def add_quad(self, a, b, c, d):
        """Adds two triangles; a, b, c, d in counter-clockwise order seen from outside."""
        for face in ((a, b, c), (a, c, d)):
            if len({self.positions[i] for i in face}) == 3:
                self.faces.append(face)

    def append(self, other):
        """Adds all of another mesh."""
        base = len(self.positions)
        self.positions += other.positions
        self.normals += other.normals
        self.uvs += other.uvs
        self.faces += [tuple(base + i for i in face) for face in other.faces]


def _signed_area(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def triangulate(polygon):
    """Index triples of a simple counter-clockwise polygon in the plane (ear clipping)."""
    remaining = list(range(len(polygon)))
    triangles = []
    while len(remaining) > 3:
        for k, current in enumerate(remaining):
            before, after = remaining[k - 1], remaining[(k + 1) % len(remaining)]
            a, b, c = polygon[before], polygon[current], polygon[after]
            if _signed_area(a, b, c) <= 1e-12:
                continue
            others = (polygon[i] for i in remaining if i not in (before, current, after))
            if any(
                _signed_area(a, b, p) >= 0
                and _signed_area(b, c, p) >= 0
                and _signed_area(c, a, p) >= 0
                for p in others
            ):
                continue
            triangles.append((before, current, after))
            del remaining[k]
            break
        else:
            raise ValueError("polygon is not simple or not counter-clockwise")
    triangles.append(tuple(remaining))
    return triangles


def flat_polygon(polygon, z, uv):
    """An upward-facing polygon at height z; uv maps (x, y, z) to texture coordinates."""
    mesh = Mesh()
    for x, y in polygon:
        mesh.add_vertex((x, y, z), (0, 0, 1), uv(x, y, z))
    mesh.faces = triangulate(polygon)
    return mesh


def grid(rows, uv_rows, closed=False):
    """A surface through a grid of points with smooth normals from neighbouring points.

    Its outside is along (next point in the row) x (same point in the next row). In a `closed`
    grid the rows end with their first point, and are smooth there.
    """
    mesh = Mesh()
    count = len(rows[0])
    for i, row in enumerate(rows):
        above, below = rows[max(i - 1, 0)], rows[min(i + 1, len(rows) - 1)]
        for j, point in enumerate(row):
            if closed:
                along = subtract(row[j + 1 if j + 1 < count else 1], row[j - 1 if j > 0 else -2])
            else:
                along = subtract(row[min(j + 1, count - 1)], row[max(j - 1, 0)])
            normal = cross(along, subtract(below[j], above[j]))
            mesh.add_vertex(point, normalize(normal), uv_rows[i][j])
    for i in range(len(rows) - 1):
        for j in range(count - 1):
            base = i * count + j
            mesh.add_quad(base, base + 1, base + count + 1, base + count)
    return mesh


def lathe(profile, segments, start=0.0, end=2 * pi):
    """Revolves (radius, z) points about z, from angle `start` to `end`.

    The outside is to the right of the profile's direction. uv: u around, v along the profile
    by length, both in [0, 1]. A kink above 40 degrees in the profile stays sharp.
    """
    lengths = [0.0]
    for (r0, z0), (r1, z1) in zip(profile, profile[1:]):
        lengths.append(lengths[-1] + hypot(r1 - r0, z1 - z0))
    mesh = Mesh()
    normals = _path_normals(profile, closed=False)
    for k in range(len(profile) - 1):
        columns = []
        for i in range(segments + 1):
            angle = start + (end - start) * i / segments
            c, s = cos(angle), sin(angle)
            column = []
            for j, (nr, nz) in ((k, normals[k][1]), (k + 1, normals[k + 1][0])):
                r, z = profile[j]
                uv = (i / segments, lengths[j] / lengths[-1])
                column.append(mesh.add_vertex((r * c, r * s, z), (nr * c, nr * s, nz), uv))
            columns.append(column)
        for (a, b), (c, d) in zip(columns, columns[1:]):
            mesh.add_quad(a, c, d, b)
    return mesh


def _path_normals(points, closed):
    """Pairs (arriving, leaving) of unit normals, to the right of the path, at each point."""
    count = len(points)
    edges = []
    for i in range(count if closed else count - 1):
        (x0, y0), (x1, y1) = points[i], points[(i + 1) % count]
        length = hypot(x1 - x0, y1 - y0)
        edges.append(((y1 - y0) / length, -(x1 - x0) / length))
    pairs = []
    for i in range(count):
        before = edges[i - 1] if closed or i > 0 else edges[0]
        after = edges[i] if i < len(edges) else edges[-1]
        cosine = before[0] * after[0] + before[1] * after[1]
        if acos(max(-1.0, min(1.0, cosine))) < 40 * pi / 180:
            scale = 1 / sqrt(2 + 2 * cosine)
            smooth = ((before[0] + after[0]) * scale, (before[1] + after[1]) * scale)
            pairs.append((smooth, smooth))
        else:
            pairs.append((before, after))
    return pairs


def inset(polygon, distance):
    """Moves every edge of a counter-clockwise polygon inwards by `distance`."""
    moved = []
    count = len(polygon)
    for i, (x, y) in enumerate(polygon):
        (x0, y0), (x1, y1) = polygon[i - 1], polygon[(i + 1) % count]
        incoming, outgoing = atan2(y - y0, x - x0), atan2(y1 - y, x1 - x)
        turn = (outgoing - incoming + pi) % (2 * pi) - pi
        # The point where both moved edges meet.
        middle = incoming + turn / 2 + pi / 2
        reach = distance / cos(turn / 2)
        moved.append((x + reach * cos(middle), y + reach * sin(middle)))
    return moved


def rounded_prism(polygon, bottom, top, radius, uv, steps=6):
    """A counter-clockwise polygon extruded from z = bottom to top, its upper edge rounded.

    uv maps (x, y, z) to texture coordinates; the underside is left open.
    """
    normals = _path_normals(polygon, closed=True)
    rings = [(polygon, bottom, 0.0)]
    for step in range(steps + 1):
        angle = pi / 2 * step / steps
        ring = inset(polygon, radius * (1 - cos(angle)))
        rings.append((ring, top - radius * (1 - sin(angle)), angle))
    mesh = flat_polygon(rings[-1][0], top, uv)
    for i in range(len(polygon)):
        j = (i + 1) % len(polygon)
        columns = []
        for k, (nx, ny) in ((i, normals[i][1]), (j, normals[j][0])):
            column = []
            for ring, z, angle in rings:
                x, y = ring[k]
                normal = (nx * cos(angle), ny * cos(angle), sin(angle))
                column.append(mesh.add_vertex((x, y, z), normal, uv(x, y, z)))
            columns.append(column)
        for level in range(len(rings) - 1):
            left, right = columns
            mesh.add_quad(left[level], right[level], right[level + 1], left[level + 1])
    return mesh


def arc(center, radius, start, end, steps):
    """Points of a circle from angle `start` to `end`, both included."""
    angles = [start + (end - start) * i / steps for i in range(steps + 1)]
    return [(center[0] + radius * cos(a), center[1] + radius * sin(a)) for a in angles]
