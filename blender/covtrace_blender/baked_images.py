"""Images that were baked for the last export, kept so that the next frame, or a moved object in a viewport, does not bake it again."""

from . import baking
from .node_signature import all_nodes, signature

MOST_BYTES = 1 << 29  # kept between exports

_known = {}  # {key: Baked}


class BakedImages:
    """Those of one export, which remembers the last one's."""

    def __init__(self):
        self._used = {}

    def of(self, socket, surface, how, bake):
        """The result of `bake()` for a socket on a Surface, or an earlier one; how: further values that it hangs on."""
        tree = socket.id_data
        if any(_may_change(node.image) for node in all_nodes(tree) if getattr(node, "image", None)):
            return bake()
        key = (signature(tree), socket.node.name, socket.identifier, how, surface.key(), baking.SMALLEST, baking.LARGEST)
        found = self._used.get(key) or _known.get(key) or bake()
        self._used[key] = found
        return found

    def keep(self):
        """Ends the export."""
        _known.clear()
        size = 0
        for key, baked in self._used.items():
            size += baked.image.values.nbytes if baked.image else 0
            if size <= MOST_BYTES:
                _known[key] = baked


def _may_change(image):
    """Whether its pixels may change and no property of it."""
    return image.is_dirty or image.source in ("MOVIE", "SEQUENCE", "VIEWER")
