"""Tangents of meshes, along which the highlights of anisotropic shaders lie."""

import math

import numpy as np

from . import body, export_meshes

AXES = "XYZ"


class Tangent:
    """The rule for the tangents of a material. axis: "X", "Y" or "Z" of the box of Generated coordinates that they go around; "": they
    go along u of `uv_map`, "" being the active one. turn: radians, about the normal."""

    def __init__(self, axis, uv_map, turn):
        self.axis, self.uv_map, self.turn = axis, uv_map, turn

    def is_same(self, other):
        return (self.axis, self.uv_map) == (other.axis, other.uv_map) and abs(self.turn - other.turn) < 1e-6

    def at_corners(self, mesh):
        """(n, 3, 3) at the corners of the triangles of a mesh, of any length; None where it has no such UV map. Tangents around an
        axis are those of Cycles, linear over a triangle."""
        vertices, loops = export_meshes.triangles(mesh), export_meshes.triangle_loops(mesh)
        positions = export_meshes.positions(mesh)
        found = self._around(mesh, vertices) if self.axis else self._along(mesh, positions[vertices], loops)
        if found is None:
            return None
        normals = body.corner_normals(mesh, positions, vertices, loops)
        found = found - normals * np.sum(normals * found, axis=-1, keepdims=True)
        return found * math.cos(self.turn) + np.cross(normals, found) * math.sin(self.turn)

    def _around(self, mesh, vertices):
        low, size = body.texture_space(mesh)
        place = (body.undeformed(mesh) - low) / size - 0.5
        axis = np.zeros(3)
        axis[AXES.index(self.axis)] = 1
        return np.cross(axis, place)[vertices]

    def _along(self, mesh, corners, loops):
        layer = mesh.uv_layers.get(self.uv_map or export_meshes.active_uv_map(mesh) or "")
        if layer is None:
            return None
        try:
            mesh.calc_tangents(uvmap=layer.name)
        except RuntimeError:  # of faces with more than four corners
            return self._along_edges(corners, export_meshes.loop_uvs(mesh, layer)[loops])
        tangents = np.empty(3 * len(mesh.loops), np.float32)
        mesh.loops.foreach_get("tangent", tangents)
        return tangents.reshape(-1, 3)[loops].astype(float)

    @staticmethod
    def _along_edges(corners, uvs):
        """The derivative of the place by u, the same all over a triangle."""
        (edge1, edge2), (uv1, uv2) = ((v[:, 1] - v[:, 0], v[:, 2] - v[:, 0]) for v in (corners.astype(float), uvs.astype(float)))
        sign = np.sign(uv1[:, 0] * uv2[:, 1] - uv1[:, 1] * uv2[:, 0])[:, None]
        along = sign * (uv2[:, 1:] * edge1 - uv1[:, 1:] * edge2)
        return np.repeat(along[:, None], 3, axis=1)
