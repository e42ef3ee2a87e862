"""Strands (hair of particle systems, hair curves) as thin tubes.

Normals that are smooth over n flat sides lose about 1.6 / n^2 of the light at each bounce, as some of what they scatter goes into
the tube: of six sides 6 % where strands are white and dense. Prisms that are turned about their strands at random send, in their
mean, exactly as much light to each direction as round strands do; so tubes are prisms as long as nobody sees their sides.
"""

import math

import numpy as np

from .shader_nodes.hashing import hashed
from .shader_nodes.place import RANDOMS

FLAT_SIDES, SMOOTH_SIDES = 6, 24
MOST_FLAT = 3  # pixels across strands up to which they have flat sides
TURN = 2 / (1 + math.sqrt(5))  # of sides, from strand to strand: the golden ratio fills them evenly

# Cycles' for hair curves that have none.
DEFAULT_RADIUS = 0.005


def _unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)


def _places(points, randoms, count):
    """(strands, n, count + 1, 2) of STRANDS: u by the length along them."""
    steps = np.linalg.norm(np.diff(points, axis=1), axis=2)
    reached = np.concatenate((np.zeros((len(points), 1)), steps.cumsum(axis=1)), axis=1)
    uvs = np.empty((*reached.shape, count + 1, 2))
    uvs[..., 0] = (reached / np.maximum(reached[:, -1:], 1e-30))[..., None]
    uvs[..., 1] = (np.floor((RANDOMS - 1e-9) * randoms)[:, None] + np.linspace(0, 1, count + 1))[:, None]
    return uvs


def _randoms(numbers):
    """Cycles' random numbers of the strands of these numbers."""
    return hashed(np.asarray(numbers, np.uint32), np.uint32(0)) / float(0xFFFFFFFF)


def tubes(points, radii, numbers, is_flat):
    """(positions, normals, uvs, triangles) of strands with equally many points: points (strands, n, 3), radii (strands, n), numbers
    (strands,) within their object. uvs are those of STRANDS. Flat ones have None for normals."""
    strands, n, _ = points.shape
    count = FLAT_SIDES if is_flat else SMOOTH_SIDES
    along = _unit(np.gradient(points, axis=1))
    # A normal that is carried along, so that tubes don't twist.
    least = np.eye(3)[np.abs(along[:, 0]).argmin(-1)]
    side = _unit(np.cross(along[:, 0], least))
    sides = np.empty_like(points)
    for k in range(n):
        side = _unit(side - along[:, k] * (side * along[:, k]).sum(-1, keepdims=True))
        sides[:, k] = side
    others = np.cross(along, sides)
    angles = 2 * math.pi / count * (np.arange(count + 1) + TURN * np.arange(strands)[:, None])[:, None, :, None]
    normals = np.cos(angles) * sides[:, :, None] + np.sin(angles) * others[:, :, None]
    # Seen from all sides they are as wide on average as the round ones.
    widened = math.pi / (count * math.sin(math.pi / count))
    positions = points[:, :, None] + widened * radii[:, :, None, None] * normals
    corner = np.arange(strands * n * (count + 1)).reshape(strands, n, count + 1)
    a, b = corner[:, :-1, :-1], corner[:, :-1, 1:]
    c, d = corner[:, 1:, :-1], corner[:, 1:, 1:]
    uvs = _places(points, _randoms(numbers), count).reshape(-1, 2)
    triangles = np.concatenate([np.stack((a, b, d), -1).reshape(-1, 3), np.stack((a, d, c), -1).reshape(-1, 3)])
    if is_flat:
        return positions.reshape(-1, 3), None, uvs, triangles
    # Where the strand becomes thinner, its sides lean towards its end.
    steps = np.maximum(np.linalg.norm(np.diff(points, axis=1), axis=2), 1e-30)
    slopes = np.diff(radii, axis=1) / steps
    slopes = np.concatenate((slopes[:, :1], slopes), axis=1)
    normals = _unit(normals - slopes[:, :, None, None] * along[:, :, None])
    return positions.reshape(-1, 3), normals.reshape(-1, 3), uvs, triangles


def meshes(groups, across):
    """Yields (sides, positions, normals or None, uvs, triangles) of the tubes of several [(points, radii, numbers)]: all with flat sides, and
    all others.

    across(points, radii): pixels across which each strand is seen.
    """
    groups = [(points, radii, numbers, across(points, radii) <= MOST_FLAT) for points, radii, numbers in groups]
    for is_flat in (True, False):
        found, first = [], 0
        for points, radii, numbers, are_flat in groups:
            chosen = are_flat == is_flat
            if chosen.any():
                positions, normals, uvs, triangles = tubes(points[chosen], radii[chosen], numbers[chosen], is_flat)
                found.append((positions, normals, uvs, triangles + first))
                first += len(positions)
        if found:
            yield (FLAT_SIDES if is_flat else SMOOTH_SIDES,
                   *(None if part[0] is None else np.concatenate(part) for part in zip(*found)))


def _radii(settings, n):
    """Radii of a strand's points, by the particle settings, as Cycles has them."""
    rest = 1 - np.linspace(0, 1, n)
    shape = settings.shape
    rest = rest ** (1 + shape if shape < 0 else 1 / max(1 - shape, 1e-3))
    scale = 0.5 * settings.radius_scale
    radii = scale * (settings.tip_radius + (settings.root_radius - settings.tip_radius) * rest)
    if settings.use_close_tip:
        radii[-1] = 0
    return radii


def particle_systems(obj, is_render):
    """Yields (material slot, points, radii, numbers) in object space of each system of strands of an evaluated object."""
    before = 0
    to_object = np.array(obj.matrix_world.inverted_safe())
    shown = [m.particle_system for m in obj.modifiers
             if m.type == "PARTICLE_SYSTEM" and (m.show_render if is_render else m.show_viewport)]
    for system in obj.particle_systems:
        settings = system.settings
        if settings.type != "HAIR" or settings.render_type != "PATH" or not any(system.name == s.name for s in shown):
            continue
        n = 2 ** (settings.render_step if is_render else settings.display_step) + 1
        if settings.kink == "SPIRAL":
            n += settings.kink_extra_steps
        parents, children = len(system.particles), len(system.child_particles)
        first = parents if settings.child_type != "NONE" and children else 0
        points = np.array([system.co_hair(object=obj, particle_no=i, step=k)
                           for i in range(first, parents + children) for k in range(n)]).reshape(-1, n, 3)
        # Strands that grow nowhere have all of their points in one; they are left out.
        points = points[np.abs(points - points[:, :1]).max((1, 2)) > 0]
        if len(points):
            points = points @ to_object[:3, :3].T + to_object[:3, 3]
            yield settings.material - 1, points, np.broadcast_to(_radii(settings, n), points.shape[:2]), before + np.arange(len(points))
            before += len(points)


def hair_curves(data):
    """[(points, radii, numbers)] in object space of a hair curves object's data, those with equally many points together."""
    points = np.empty(3 * len(data.points), dtype=np.float32)
    data.position_data.foreach_get("vector", points)
    radii = np.full(len(data.points), DEFAULT_RADIUS, dtype=np.float32)
    if "radius" in data.attributes:
        data.points.foreach_get("radius", radii)
    first, count = (np.empty(len(data.curves), dtype=np.int32) for _ in range(2))
    data.curves.foreach_get("first_point_index", first)
    data.curves.foreach_get("points_length", count)
    points = points.reshape(-1, 3)
    groups = []
    for n in np.unique(count[count > 1]):
        numbers = np.flatnonzero(count == n)
        rows = first[numbers][:, None] + np.arange(n)
        groups.append((points[rows].astype(float), radii[rows].astype(float), numbers))
    return groups
