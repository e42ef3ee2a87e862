"""Images that were baked for the last export, kept so that the next frame, or a moved object in a viewport, does not bake it again."""

from . import baking, body_normals
from .baked import Baked
from .node_signature import all_nodes, signature

MOST_BYTES = 1 << 29  # kept between exports

_known = {}  # {key: Baked}
_kinds = {}  # {key without the surface: kinds of coordinates on a body that its nodes ask for}


class BakedImages:
    """Those of one export, which remembers the last one's."""

    def __init__(self):
        self._used, self._kinds, self._of_changing = {}, {}, set()

    def of(self, socket, surface, how, bake):
        """The result of `bake()` for a socket on a Surface, or an earlier one, of this export where images may change; how: further
        values that it hangs on."""
        tree = socket.id_data
        is_changing = any(_may_change(node.image) for node in all_nodes(tree) if getattr(node, "image", None))
        nodes = (signature(tree), socket.node.path, socket.identifier, how, baking.SMALLEST, baking.LARGEST)
        kinds = self._kinds.get(nodes, _kinds.get(nodes))
        found = None
        if not surface.body or kinds is not None:
            key = (nodes, surface.key(kinds))
            found = self._used.get(key) or (None if is_changing else _known.get(key))
        if not found:
            found = bake()
            kinds, key = found.kinds, (nodes, surface.key(found.kinds))
        self._used[key] = found
        if is_changing:
            self._of_changing.add(key)
        if surface.body:
            self._kinds[nodes] = kinds
        return found

    def turned(self, image, body, uv_map, strengths):
        """The BakedImage that body_normals.turned makes, or an earlier one."""
        key = (image.name_full, body.key(body_normals.kinds(uv_map)), uv_map, strengths)
        found = self._used.get(key) or _known.get(key) or Baked(images=[body_normals.turned(image, body, uv_map, strengths)])
        self._used[key] = found
        return found.image

    def keep(self):
        """Ends the export."""
        _known.clear()
        _kinds.clear()
        _kinds.update(self._kinds)
        size = 0
        for key, baked in self._used.items():
            if key in self._of_changing:
                continue
            size += sum(image.bytes for image in baked.images)
            if size <= MOST_BYTES:
                _known[key] = baked


def _may_change(image):
    """Whether its pixels may change and no property of it."""
    return image.is_dirty or image.source in ("MOVIE", "SEQUENCE", "VIEWER")
