"""Point clouds as spheres."""

import numpy as np

from .body import LEAST_EXTENT
from .part import Part
from .placement import matrix_text

RADIUS = 0.01  # of points that have none, as in Blender


class Spheres(Part):
    """Spheres of a Variant of their material: (n, 3) centres, (n,) radii. matrix: 4x4 to the world; None where there are several: an
    uneven scale makes ellipsoids of these alone. Others stay round, which is nearer to Cycles, though not the same."""

    def __init__(self, centres, radii, variant, matrix):
        super().__init__(None, variant, None, 0)
        self._centres, self._radii, self._turn = centres, radii, ""
        if matrix is not None and abs(np.linalg.det(matrix[:3, :3])) > LEAST_EXTENT:
            to_round = np.eye(4)
            to_round[:3, :3] = np.linalg.inv(matrix[:3, :3]) * np.cbrt(abs(np.linalg.det(matrix[:3, :3])))
            if not np.allclose(to_round @ to_round.T, np.eye(4), atol=1e-4):
                self._turn = f"ConcatTransform [{matrix_text(to_round)}]\n"

    def shapes(self, parameters):
        return "".join(f'AttributeBegin\nTranslate {x:.9g} {y:.9g} {z:.9g}\n{self._turn}Shape "sphere" "float radius" {radius:.9g} {parameters}\n'
                       "AttributeEnd\n" for (x, y, z), radius in zip(self._centres.tolist(), self._radii.tolist()))


def spheres(cloud):
    """Yields (material slot, centres, radii) of an evaluated point cloud, in its object's space; points that are not finite, or have no
    extent, are none."""
    count = len(cloud.points)
    centres, radii = np.zeros(3 * count, np.float32), np.full(count, RADIUS, np.float32)
    cloud.points.foreach_get("co", centres)
    centres = centres.reshape(-1, 3)
    if "radius" in cloud.attributes:
        cloud.attributes["radius"].data.foreach_get("value", radii)
    slots = np.zeros(count, np.int32)
    if "material_index" in cloud.attributes:
        cloud.attributes["material_index"].data.foreach_get("value", slots)
    is_there = np.isfinite(centres).all(1) & np.isfinite(radii) & (radii > 0)
    for slot in np.unique(slots[is_there]):
        chosen = is_there & (slots == slot)
        yield int(slot), centres[chosen], radii[chosen]
