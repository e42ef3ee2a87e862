"""Trees with sums of shaders: both parts of a sum are there in full, and what lets light pass is a part that is no surface."""

from .export_principled import PrincipledExporter
from .values import Value

ROUNDING = 1e-6  # of opacities


class SumExporter(PrincipledExporter):
    """Writes trees whose opacity is no part of their shape but of their material: `in_full` is whether the tree is one.
    `interfaces`: the names of the materials that are no surface."""

    def _has_sum(self, node):
        """Whether a tree holds a sum that an opacity cannot tell: of two surfaces, or of light with what lets light pass."""
        if node is None or node.type not in ("MIX_SHADER", "ADD_SHADER"):
            return False
        both = [self._linked(socket)[0] for socket in node.inputs[-2:]]
        if any(self._has_sum(part) for part in both):
            return True
        if node.type == "MIX_SHADER":
            return False
        surfaces = self._parts(node)
        shines = any(self._shines(part) for part in both if part not in surfaces)
        return len(surfaces) == 2 or len(surfaces) == 1 and shines and self._is_clear(self._opacity(surfaces[0]))

    @staticmethod
    def _is_clear(opacity):
        """Whether light may pass, by the Value of an opacity."""
        return bool(opacity.varies) or opacity.constant < 1 - ROUNDING

    def _whole(self, node):
        """The pbrt name of a tree, with what it lets pass."""
        if not self._has_sum(node):
            return self._mix(self._interface(), self._shader(node) if node else self._black(), self._opacity(node))
        if node.type == "MIX_SHADER":
            return self._mix(*(self._whole(part) for part in self._parts(node)), self._mix_share(node))
        parts = [self._whole(part) for part in self._parts(node)]
        if len(parts) == 1:
            return parts[0]
        # Either part in half of the places, with twice its light
        return self._make("mix", [f'"string materials" ["{parts[0]}" "{parts[1]}"]', '"float weight" 2'])

    def _interface(self):
        name = self._make("interface", [])
        self.interfaces.add(name)
        return name
