"""The places of a surface at which nodes are evaluated, and what nodes ask of them.

Each has `ray`: the kind of ray that sees them, one of light_path.RAYS, None where that is not known; `images`: those that nodes
have asked for; `owner`: the Owner of the surface, or None; `is_uniform`: whether they have asked for nothing that changes from
place to place; `sight`: the cosine of the angle of sight, one or (n,), below 0 behind the surface, and `hangs_on_angle`: whether nodes have
asked for it.
"""

import numpy as np

from .sight import COSINES
from .unsupported import NeedsBody, Unsupported

# The name of the UV map that strands have: u in [0, 1] along them, v around them from the whole number below RANDOMS times their random
# number. What is added to a random number is below 1 / RANDOMS, and turns of images about strands stay whole.
STRANDS = "\0strands"
RANDOMS = 256


class _Place:
    def __init__(self, pixels_of, ray, owner):
        self._pixels_of, self.ray, self.owner, self.images = pixels_of, ray, owner, []
        self.sight, self.hangs_on_angle = COSINES[0], False

    def cosine(self):
        """That of the angle of sight, on either side."""
        self.hangs_on_angle = True
        return np.abs(self.sight)

    def is_behind(self):
        """Whether the surface is seen from behind."""
        self.hangs_on_angle = True
        return np.less(self.sight, 0)

    def pixels(self, image):
        """(h, w, 4) linear, from the top."""
        if image not in self.images:
            self.images.append(image)
        return self._pixels_of(image)


class UvPlace(_Place):
    """n places of a UV map. uv: (n, 2). uv_maps: the names by which nodes have asked for it."""

    def __init__(self, uv, pixels_of, ray=None, owner=None):
        super().__init__(pixels_of, ray, owner)
        self.uv, self.uv_maps = uv, []

    def __len__(self):
        return len(self.uv)

    @property
    def is_uniform(self):
        return not self.uv_maps

    def uv_of(self, node, name):
        """(n, 3) coordinates of the UV map `name`; "" is the mesh's."""
        if name not in self.uv_maps:
            self.uv_maps.append(name)
        if len(self.uv_maps) > 1:
            raise NeedsBody(node, "several UV maps meet")
        return np.column_stack((self.uv, np.zeros(len(self.uv), np.float32)))

    def coordinates(self, node, kind):
        """(n, 3): "OBJECT" or "GENERATED" coordinates, the "NORMAL" in the object's space; "WORLD", "CAMERA" and "WORLD NORMAL"."""
        raise NeedsBody(node, f"{kind.lower()} coordinates do not follow from a UV map")

    def attribute(self, node, name, part, missing):
        """(n, 3) of the mesh's attribute of this name: what it is ("ATTRIBUTE"), or three times its "NUMBER" or "ALPHA"; `missing` where
        the mesh has none."""
        raise NeedsBody(node, "attributes do not follow from a UV map")


class VolumePlace(_Place):
    """(n, 3) places within `space`, which has `texture_space`, `matrix` and `grids` as VolumeSpace has them; None: anywhere. asked: the
    kinds of coordinates that nodes have asked for, those that are not known among them."""

    def __init__(self, space, places, pixels_of, ray=None, owner=None):
        super().__init__(pixels_of, ray, owner)
        self._space, self._places, self.is_uniform, self.asked = space, places, True, set()

    def cosine(self):
        return np.float32(1)  # as in Cycles, which takes the direction of sight for the normal

    def is_behind(self):
        return np.False_

    def uv_of(self, node, name):
        return np.zeros((len(self._places), 3), np.float32)

    def grid(self, name):
        """(n, 3) of the attribute of this name; None where there is none."""
        if not self._space or name not in self._space.grids:
            return None
        self.is_uniform = False
        self.asked.add("GRID")
        return self._space.grids[name](self._places)

    def attribute(self, node, name, part, missing):
        found = self.grid(name)
        if found is None or part == "ALPHA":
            return np.full((len(self._places), 3), missing if found is None else 1, np.float32)
        return found

    def coordinates(self, node, kind):
        if kind not in ("OBJECT", "GENERATED", "WORLD"):
            raise Unsupported(node, f"volumes have no {kind.lower()}")
        self.asked.add(kind)
        if not self._space or kind == "WORLD" and self._space.matrix is None:
            raise Unsupported(node, "the world's coordinates are not known of what has instances" if self._space else "its place is not known")
        self.is_uniform = False
        if kind == "GENERATED":
            low, size = self._space.texture_space
            return ((self._places - low) / size).astype(np.float32)
        matrix = self._space.matrix
        return self._places if kind == "OBJECT" else (self._places @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)


class LampPlace(_Place):
    """`count` places on a lamp, as its light is sampled: uv (n, 2), which Cycles has on areas, in the cone of spots and around points, or
    None where that is not known; normals (n, 3), away from it in its space, or None of area lamps. What else lamps have not is zero there."""

    def __init__(self, count, uv, normals, pixels_of):
        super().__init__(pixels_of, "lamp", None)
        self._count, self._uv, self._normals, self.is_uniform = count, uv, normals, True

    def is_behind(self):
        return np.False_

    def uv_of(self, node, name):
        if self._uv is None:
            raise Unsupported(node, "lamps have another UV map in this version of Blender")
        self.is_uniform = False
        return np.column_stack((self._uv, np.zeros(len(self._uv)))).astype(np.float32)

    def attribute(self, node, name, part, missing):
        return np.full((self._count, 3), missing, np.float32)

    def coordinates(self, node, kind):
        if kind == "GENERATED":
            return np.zeros((self._count, 3), np.float32)
        if kind != "NORMAL" or self._normals is None:
            raise Unsupported(node, f"lamps have no {kind.lower()} here")
        self.is_uniform = False
        return self._normals.astype(np.float32)


class BodyPlace(_Place):
    """Texels of the atlas of `body`, which has `knows(kind)` and `values(kind, texels, shift)`; shift: by the share of a texel."""

    def __init__(self, body, texels, shift, pixels_of, ray=None, owner=None):
        super().__init__(pixels_of, ray, owner)
        self._body, self._texels, self._shift, self._known = body, texels, shift, {}

    def __len__(self):
        return len(self._texels)

    @property
    def is_uniform(self):
        return not self._known

    def kinds(self):
        """Those of coordinates that nodes have asked for."""
        return list(self._known)

    def uv_of(self, node, name):
        # As in Cycles: a map that a mesh has not is zero everywhere.
        return self._values_or(("UV", name), 0.0)

    def attribute(self, node, name, part, missing):
        return self._values_or((part, name), missing)

    def _values_or(self, kind, missing):
        if not self._body.knows(kind):
            self._known.setdefault(kind, None)
            return np.full((len(self._texels), 3), missing, np.float32)
        return self._values(kind)

    def coordinates(self, node, kind):
        if not self._body.knows(kind):
            raise Unsupported(node, "the world's coordinates are not known of what has instances")
        return self._values(kind)

    def _values(self, kind):
        if kind not in self._known:
            self._known[kind] = self._body.values(kind, self._texels, self._shift)
        return self._known[kind]
