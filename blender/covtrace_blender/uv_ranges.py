"""The range of meshes' UV maps."""

import numpy as np

from . import export_meshes


class UvRanges:
    """{material: {UV map: (smallest, largest)}} of all meshes that are added."""

    def __init__(self):
        self._known, self._of_material = {}, {}

    def add(self, mesh, materials):
        """materials: names."""
        key = mesh.as_pointer()
        if key not in self._known:
            self._known[key] = self._ranges(mesh)
        for material in materials:
            ranges = self._of_material.setdefault(material, {})
            for name, (low, high) in self._known[key].items():
                before = ranges.get(name, (low, high))
                ranges[name] = np.minimum(before[0], low), np.maximum(before[1], high)

    def of(self, material):
        return self._of_material.get(material, {})

    @staticmethod
    def _ranges(mesh):
        ranges = {}
        for layer in mesh.uv_layers:
            uvs = export_meshes.loop_uvs(mesh, layer)
            uvs = uvs[np.isfinite(uvs).all(axis=1)]
            if len(uvs):
                ranges[layer.name] = uvs.min(axis=0), uvs.max(axis=0)
                if layer.active_render:
                    ranges[""] = ranges[layer.name]
        return ranges
