"""Objects that the camera does not see as they are nearer than Clip Start or beyond Clip End; other rays see them, as in Cycles."""

import numpy as np
from mathutils import Vector

from . import export_meshes

RAYS = 9  # along each side of the frame, that look for what is cut

HAVE_EXTENT = ("MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES")  # types of objects that can be clipped


class Clipping:
    """By a SceneCamera, where it stands; None clips nothing. Panoramas clip by the distance, others by that along the axis of sight."""

    def __init__(self, camera):
        self._range, self._cut, self._boxes = camera.clip_range() if camera else None, {}, {}
        if not self._range:
            return
        matrix = camera.matrix().normalized()
        self._is_panorama, self._inverse = camera.is_panorama(), matrix.inverted()
        self._to_camera, self._rays = np.array(self._inverse), []
        if self._is_panorama:
            return
        near, far = self._range
        rays = [(start, way / near) for start, way in camera.rays_to_near(RAYS)]
        self._rays = [(matrix @ start, matrix.to_3x3() @ way) for start, way in rays]
        # Boxes in the camera's space: around what Clip Start cuts off, and around all that is seen.
        (self._low, self._high), (self._seen_low, self._seen_high) = (
            self._box([start + depth * way for start, way in rays for depth in depths]) for depths in ((0, near), (near, far)))

    @staticmethod
    def _box(places):
        return np.min(places, axis=0), np.max(places, axis=0)

    def hides(self, instance):
        """Whether all of an instance is clipped. Notes what is cut, which is shown whole."""
        if not self._range or instance.object.type not in HAVE_EXTENT or self._is_far_from_both(instance):
            return False
        seen = self._in_camera(instance, self._box_of(instance.object)[0])
        low, high, (near, far) = seen.min(axis=0), seen.max(axis=0), self._range
        if self._is_panorama:
            nearest, farthest = np.linalg.norm(np.clip(0, low, high)), np.linalg.norm(seen, axis=1).max()
        else:
            nearest, farthest = -float(high[2]), -float(low[2])
        if farthest <= 0:
            return False  # behind the camera, which does not see it in any case
        if farthest < near or nearest > far:
            return True
        if instance.object.type != "MESH":
            return False
        if farthest > far and not self._may_be_seen(instance):
            return True
        if self._is_panorama:
            return False
        if (low < self._high).all() and (high > self._low).all():
            self._note_if_cut("Clip Start cuts what is nearer", instance, 0, near)
        if farthest > far:
            self._note_if_cut("Clip End cuts what is farther", instance, far, farthest)
        return False

    def _box_of(self, obj):
        """((8, 3) corners of an object's box, its middle, its radius); the same for all instances of it."""
        key = obj.name_full, obj.data.as_pointer()
        if key not in self._boxes:
            corners = np.array([tuple(corner) for corner in obj.bound_box])
            middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
            self._boxes[key] = corners, Vector(middle), float(np.linalg.norm(corners - middle, axis=1).max())
        return self._boxes[key]

    def _is_far_from_both(self, instance):
        """Whether the sphere around an instance is clear of both ends: most of many instances are."""
        _, middle, radius = self._box_of(instance.object)
        matrix, (near, far) = instance.matrix_world, self._range
        place = self._inverse @ (matrix @ middle)
        reach = radius * sum(matrix.col[k].xyz.length_squared for k in range(3)) ** 0.5
        depth = place.length if self._is_panorama else -place.z
        return near + reach <= depth <= far - reach

    def _in_camera(self, instance, places):
        """(n, 3) places of an object in the camera's space."""
        matrix = self._to_camera @ np.array(instance.matrix_world)
        return places @ matrix[:3, :3].T + matrix[:3, 3]

    def _may_be_seen(self, instance):
        """Whether the box around one of a mesh's triangles meets that around all that is seen: a dome of sky need not."""
        if instance.show_particles and instance.object.particle_systems:
            return True  # strands reach out of the mesh
        mesh = instance.object.data
        mesh.calc_loop_triangles()
        corners = self._in_camera(instance, export_meshes.positions(mesh))[export_meshes.triangles(mesh)]
        low, high = corners.min(axis=1), corners.max(axis=1)
        if self._is_panorama:
            return bool((np.linalg.norm(np.clip(0, low, high), axis=1) <= self._range[1]).any())
        return bool(((low < self._seen_high) & (high > self._seen_low)).all(axis=1).any())

    def _note_if_cut(self, kind, instance, first, last):
        """Notes a mesh that rays of the camera meet between two depths."""
        obj, names = instance.object, self._cut.setdefault(kind, [])
        if obj.name in names or abs(instance.matrix_world.determinant()) < 1e-30 or not len(obj.data.polygons):
            return
        to_object = instance.matrix_world.inverted()
        for start, way in self._rays:
            begin, end = to_object @ (start + first * way), to_object @ (start + last * way)
            if obj.ray_cast(begin, end - begin, distance=(end - begin).length)[0]:
                names.append(obj.name)
                return

    def tell(self, warn):
        for kind, names in self._cut.items():
            if names:
                more = f" and {len(names) - 3} more" if len(names) > 3 else ""
                warn(f"the camera's {kind}; shown whole: " + ", ".join(f"'{name}'" for name in names[:3]) + more)
