"""The places of a surface at which nodes are evaluated, and what nodes ask of them."""

import numpy as np

from .unsupported import Unsupported


class Place:
    """Texture coordinates of n places.

    uv: (n, 2). object_of_uv: {"GENERATED" or "OBJECT": function from (n, 2) to (n, 3)}, of what hangs on UV alone.
    pixels_of(image): (h, w, 4) linear, from the top. ray: the kind of ray that sees them, one of light_path.RAYS; None
    where that is not known.
    """

    def __init__(self, uv, object_of_uv, pixels_of, ray=None):
        self.uv, self.object_of_uv, self.pixels_of, self.ray = uv, object_of_uv, pixels_of, ray
        self.uv_maps, self.images, self.hangs_on_object = [], [], False

    def uv_of(self, node, name):
        """(n, 3) coordinates of the UV map `name`; "" is the mesh's."""
        if name not in self.uv_maps:
            self.uv_maps.append(name)
        if len(self.uv_maps) > 1:
            raise Unsupported(node, "several UV maps meet")
        return np.column_stack((self.uv, np.zeros(len(self.uv), np.float32)))

    def object_coordinates(self, node, kind):
        """(n, 3) coordinates "GENERATED" or "OBJECT"."""
        self.hangs_on_object = True
        if kind not in self.object_of_uv:
            raise Unsupported(node, f"{kind.lower()} coordinates do not follow from the mesh's UV map")
        self.uv_of(node, "")
        return self.object_of_uv[kind](self.uv).astype(np.float32)

    def pixels(self, image):
        if image not in self.images:
            self.images.append(image)
        return self.pixels_of(image)
