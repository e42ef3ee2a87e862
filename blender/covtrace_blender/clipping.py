"""Objects that the camera does not see as they are nearer than Clip Start or beyond Clip End; other rays see them, as in Cycles."""

import numpy as np

RAYS = 9  # along each side of the frame, that look for what Clip Start cuts


class Clipping:
    """By a SceneCamera, where it stands; None, and panoramas, clip nothing."""

    def __init__(self, camera):
        self._range, self._cut = camera.clip_range() if camera else None, []
        if self._range:
            matrix = camera.matrix().normalized()
            self._to_camera = np.array(matrix.inverted())
            self._rays = [(matrix @ start, matrix.to_3x3() @ way) for start, way in camera.rays_to_near(RAYS)]
            ends = [matrix.inverted() @ place for start, way in self._rays for place in (start, start + way)]
            self._low, self._high = np.min(ends, axis=0), np.max(ends, axis=0)

    def hides(self, instance):
        """Whether all of an instance is clipped. Notes what is cut, which is shown whole."""
        if not self._range or instance.object.type == "LIGHT":
            return False
        corners = np.array([(*corner, 1) for corner in instance.object.bound_box]) @ np.array(instance.matrix_world).T
        seen = (corners @ self._to_camera.T)[:, :3]
        depths, (near, far) = -seen[:, 2], self._range
        if depths.max() <= 0:
            return False  # behind the camera, which does not see it in any case
        if depths.max() < near or depths.min() > far:
            return True
        is_near = (seen.min(axis=0) < self._high).all() and (seen.max(axis=0) > self._low).all()
        if is_near and instance.object.type == "MESH" and instance.object.name not in self._cut and self._is_cut(instance):
            self._cut.append(instance.object.name)
        return False

    def _is_cut(self, instance):
        """Whether rays from the camera meet a mesh before Clip Start."""
        obj = instance.object
        if abs(instance.matrix_world.determinant()) < 1e-30 or not len(obj.data.polygons):
            return False
        to_object = instance.matrix_world.inverted()
        for start, way in self._rays:
            begin, end = to_object @ start, to_object @ (start + way)
            if obj.ray_cast(begin, end - begin, distance=(end - begin).length)[0]:
                return True
        return False

    def tell(self, warn):
        if self._cut:
            more = f" and {len(self._cut) - 3} more" if len(self._cut) > 3 else ""
            warn("the camera's Clip Start cuts what is nearer; shown whole: " + ", ".join(f"'{name}'" for name in self._cut[:3]) + more)
