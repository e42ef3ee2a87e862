"""How many pixels the picture has for things where they are nearest to the camera: bodies need as many texels."""

import math

import numpy as np

from . import export_meshes
from .placement import with_extent

# In one atlas of a picture, and of a viewport.
MOST_TEXELS, MOST_TEXELS_OF_PREVIEWS = 1 << 22, 1 << 19
ACROSS = 512  # texels along a body's diagonal where no camera tells
NEAREST = 8  # instances that are looked at triangle by triangle
MOST_RATIO = 64  # between the densities of one mesh
ALIKE = 2  # ratio between densities up to which a mesh has one for all
LEAST_DISTANCE = 0.1  # of a camera to a triangle, in the triangle's radius


class Placements:
    """Where the instances of each mesh stand, as `camera`, a SceneCamera or None, sees them. share: of the density that bodies get."""

    def __init__(self, camera):
        self.camera, self._matrices, self._instanced, self._known = camera, {}, set(), {}
        self.most_texels = MOST_TEXELS if camera else MOST_TEXELS_OF_PREVIEWS
        self.share = 1.0

    @staticmethod
    def key(obj):
        """Tells an object's mesh from others: geometry nodes place several under one name."""
        return obj.name_full, obj.data.as_pointer()

    def add(self, instance):
        key = self.key(instance.object)
        matrix = instance.matrix_world
        self._matrices.setdefault(key, []).append(np.array(with_extent(matrix) or matrix))
        if instance.is_instance:
            self._instanced.add(key)

    def only_matrix(self, obj):
        """4x4 from a mesh to the world; None of what has instances."""
        return None if self.key(obj) in self._instanced else self.sole_matrix(obj)

    def sole_matrix(self, obj):
        """The same, and that of what has one instance."""
        matrices = self._matrices.get(self.key(obj), ())
        return matrices[0] if len(matrices) == 1 else None

    def first_matrix(self, obj):
        """That of the first of all instances."""
        return self._matrices[self.key(obj)][0]

    def scale(self, obj):
        """The mean scale of a mesh in the world; of instances that of the first. To five digits: turns do not change it."""
        matrices = self._matrices.get(self.key(obj))
        return float(f"{abs(np.linalg.det(matrices[0][:3, :3])) ** (1 / 3):.5g}") if matrices else 1.0

    def density(self, obj, mesh):
        """(n,) texels per unit at each triangle of a mesh: between one and two per pixel, or their share of that, in steps of two, and the
        same on all of a mesh whose parts need hardly different ones, so that small moves change nothing."""
        key = self.key(obj)
        if key not in self._known:
            self._known[key] = self._wanted(obj, mesh)
        return self.share * self._known[key]

    def _wanted(self, obj, mesh):
        corners = export_meshes.positions(mesh)[export_meshes.triangles(mesh)].astype(float)
        middles = corners.mean(axis=1)
        radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
        low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        size = max(float(np.linalg.norm(high - low)), 1e-30)
        wanted = self._pixels(obj, middles, radii, (low + high) / 2, size)
        if wanted is None:
            return np.full(len(corners), 2.0 ** math.ceil(math.log2(ACROSS / size)))
        wanted = np.clip(wanted, max(wanted.max() / MOST_RATIO, 1e-30), None)
        if wanted.max() < ALIKE * wanted.min():
            wanted[:] = wanted.max()
        return 2.0 ** np.ceil(np.log2(wanted))

    def across(self, obj, points, radii):
        """(n,) pixels across which strands of an object are seen at most: points (n, m, 3), radii (n, m); 0 where no camera tells."""
        low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
        middles = points.mean(axis=1)
        reach = np.linalg.norm(points - middles[:, None], axis=2).max(axis=1)
        pixels = self._pixels(obj, middles, reach, (low + high) / 2, max(float(np.linalg.norm(high - low)), 1e-30))
        return np.zeros(len(points)) if pixels is None else 2 * radii.max(axis=1) * pixels

    def _pixels(self, obj, middles, radii, middle, size):
        """(n,) pixels per unit around places in an object, as `_seen` has them, in the instance that shows most; None where no camera
        tells. middle, size: of the whole object."""
        matrices = self._matrices.get(self.key(obj), []) if self.camera else []
        if not matrices:
            return None
        # The whole at its nearest place of each instance; for those that come nearest, each place on its own.
        of_whole = np.array([self._seen(m, middle[None], np.array([size / 2]), size)[0] for m in matrices])
        order = np.argsort(-of_whole)
        found = np.full(len(middles), of_whole[order[NEAREST]] if len(order) > NEAREST else 0.0)
        for number in order[:NEAREST]:
            found = np.maximum(found, self._seen(matrices[number], middles, radii, 1e-3 * size))
        return found

    def _seen(self, matrix, middles, radii, least):
        """(n,) pixels per unit of the mesh around (n, 3) places in it, as far as `radii`, which count as no smaller than `least`."""
        width, has_perspective = self.camera.pixel()
        scale = np.linalg.norm(matrix[:3, :3], axis=0).max()
        if not has_perspective:
            return np.full(len(middles), scale / width)
        eye = np.array(self.camera.matrix().translation)
        distance = np.linalg.norm(middles @ matrix[:3, :3].T + matrix[:3, 3] - eye, axis=1) - radii * scale
        return scale / (width * np.maximum(distance, LEAST_DISTANCE * scale * np.maximum(radii, least)))
