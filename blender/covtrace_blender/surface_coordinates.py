"""The range of meshes' UV maps, and their object coordinates as functions of UV."""

import numpy as np

from . import export_meshes


def _uvs(mesh, layer):
    values = np.zeros(2 * len(mesh.loops), np.float32)
    if len(layer.data) != len(mesh.loops):  # of a mesh that is being edited
        return values.reshape(-1, 2)
    layer.data.foreach_get("uv", values)
    return values.reshape(-1, 2)


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
            uvs = _uvs(mesh, layer)
            uvs = uvs[np.isfinite(uvs).all(axis=1)]
            if len(uvs):
                ranges[layer.name] = uvs.min(axis=0), uvs.max(axis=0)
                if layer.active_render:
                    ranges[""] = ranges[layer.name]
        return ranges


def _loop_vertices(mesh):
    values = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", values)
    return values


def object_of_uv(obj, mesh):
    """{"GENERATED", "OBJECT": function from (n, 2) to (n, 3)} where they follow evenly from the UV map; {} elsewhere."""
    layer = next((layer for layer in mesh.uv_layers if layer.active_render), None)
    if layer is None or not len(mesh.loops):
        return {}
    uvs, points = _uvs(mesh, layer), export_meshes.positions(mesh)
    corners = points[_loop_vertices(mesh)]
    columns = np.column_stack((uvs, np.ones(len(uvs))))
    matrix, *_ = np.linalg.lstsq(columns, corners, rcond=None)
    extent = (points.max(axis=0) - points.min(axis=0)).max()
    if not np.abs(columns @ matrix - corners).max() <= 1e-4 * extent:
        return {}

    def position(uv):
        return uv @ matrix[:2] + matrix[2]

    found = {"OBJECT": position}
    if not obj.modifiers:
        low, size = _texture_space(mesh, points)
        found["GENERATED"] = lambda uv: (position(uv) - low) / size
    return found


def _texture_space(mesh, points):
    """(least corner, size) of the box in which Generated coordinates are 0 to 1."""
    if not mesh.use_auto_texspace:
        half = np.array(mesh.texspace_size)
        return np.array(mesh.texspace_location) - half, 2 * half
    low, high = points.min(axis=0).astype(float), points.max(axis=0).astype(float)
    half = 0.5 * (high - low)
    half = np.where(half < 1e-5, 1, half)  # as Blender does for flat meshes
    return 0.5 * (low + high) - half, 2 * half
