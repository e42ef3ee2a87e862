"""Closed meshes, and whether they hold a place."""

import functools

import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from . import export_meshes

MOST_CROSSINGS = 1000  # of a mesh by a ray: one that is caught between faces must end


class Solid:
    """The inside of a closed mesh, in its own space. It keeps nothing of Blender's: evaluated instances, whose ray_cast would
    tell the same, are gone with the loop over them. low, high: the corners of the box around it; not finite where it is not."""

    def __init__(self, mesh):
        mesh.calc_loop_triangles()
        self._positions, self._triangles = export_meshes.positions(mesh), export_meshes.triangles(mesh)
        self.low, self.high = self._positions.min(0), self._positions.max(0)

    @functools.cached_property
    def _tree(self):
        return BVHTree.FromPolygons(self._positions.tolist(), self._triangles.tolist(), all_triangles=True)

    def holds(self, place):
        """Whether a ray from there crosses the mesh an odd number of times."""
        origin, direction = Vector(place), Vector((0.5773, 0.5411, 0.6115))
        step = 1e-5 * max(self.high - self.low)
        for crossings in range(MOST_CROSSINGS):
            where, _, _, _ = self._tree.ray_cast(origin, direction)
            if where is None:
                return crossings % 2 == 1
            origin = where + direction * step
        return False


class Box:
    """A box that lies along the axes, and whether places are in it."""

    # Corners of its sides, anticlockwise from without; corner k is at the high end of x, y, z by the bits of k.
    TRIANGLES = np.array([(0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 2, 3), (0, 3, 1),
                          (4, 5, 7), (4, 7, 6)], np.int32)

    def __init__(self, low, high):
        self.low, self.high = low, high

    def corners(self):
        """(8, 3) float32."""
        return np.array([[(self.low, self.high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)], np.float32)

    def holds(self, place):
        return bool((self.low <= place).all() and (place <= self.high).all())
