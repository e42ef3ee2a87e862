"""Coordinates and normals at the corners of a mesh's triangles, which nodes ask for."""

import numpy as np

from . import attributes, export_meshes, mesh_numbers
from .atlases import digest
from .charts import face_normals


UNDISPLACED = "covtrace_undisplaced"  # attribute of displaced meshes
LEAST_EXTENT = 1e-30  # determinant of an object's matrix below which it has no extent in some direction


def texture_space(mesh):
    """(least corner, size) of the box in which Generated coordinates are 0 to 1."""
    half = np.array(mesh.texspace_size, float)
    half = np.where(half == 0, 0.5, half)
    return np.array(mesh.texspace_location, float) - half, 2 * half


def undeformed(mesh):
    """(n, 3) places of the vertices before modifiers and displacement moved them, as far as the mesh knows."""
    values = np.empty(3 * len(mesh.vertices), np.float32)
    if UNDISPLACED in mesh.attributes:
        mesh.attributes[UNDISPLACED].data.foreach_get("vector", values)
    else:
        mesh.vertices.foreach_get("undeformed_co", values)
    return values.reshape(-1, 3)


def keep_undeformed(mesh):
    """Before the vertices of a mesh, which is no one else's, are moved: Blender has their places now for those from before modifiers
    where there are none."""
    values = undeformed(mesh)
    mesh.attributes.new(UNDISPLACED, "FLOAT_VECTOR", "POINT")
    mesh.attributes[UNDISPLACED].data.foreach_set("vector", values.ravel())


def corner_normals(mesh, positions, triangles, loops):
    """(n, 3, 3) unit normals, of smooth faces those of their corners."""
    normals = np.repeat(face_normals(positions[triangles])[:, None], 3, axis=1)
    smooth = export_meshes.smooth_triangles(mesh)
    if smooth.any():
        normals[smooth] = export_meshes.loop_normals(mesh)[loops[smooth]]
    return normals


def edge_distances(corners):
    """(n, 3, 3) at (n, 3, 3) corners of triangles: how far each is from the sides opposite to the three corners."""
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1), axis=2)
    double_areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.eye(3) * (double_areas[:, None] / np.maximum(sides, 1e-30))[:, None]


class Body:
    """The triangles of a mesh that one material is on, with an Atlas of them.

    chosen: (n,) bool, which of the mesh's triangles these are. matrix: 4x4 from the mesh to the world; None where there
    is none that is the only one. attribute_names, numbers: attributes and outputs of mesh_numbers that nodes ask for.
    to_camera: 4x4 from the world, z ahead; None where that is not known. rest: (n, 3, 3) corners of the triangles before
    all deformation.
    """

    @staticmethod
    def is_of(mesh):
        """Whether a mesh has faces, all of whose vertices are somewhere."""
        return len(mesh.polygons) > 0 and bool(np.isfinite(export_meshes.positions(mesh)).all() and np.isfinite(undeformed(mesh)).all())

    def __init__(self, mesh, chosen, matrix=None, attribute_names=(), numbers=(), to_camera=None):
        mesh.calc_loop_triangles()
        vertices, loops = export_meshes.triangles(mesh), export_meshes.triangle_loops(mesh)
        positions, rest = export_meshes.positions(mesh), undeformed(mesh)
        low, size = texture_space(mesh)
        self.chosen, self.triangles, self._digests = chosen, vertices[chosen], {}
        loops = loops[chosen]
        self.rest = rest[self.triangles].astype(float)
        of_vertex = {"OBJECT": positions, "GENERATED": (rest - low) / size}
        self._corners = {kind: values[self.triangles] for kind, values in of_vertex.items()}
        self._corners["NORMAL"] = corner_normals(mesh, positions, vertices, export_meshes.triangle_loops(mesh))[chosen]
        for layer in mesh.uv_layers:
            uvs = export_meshes.loop_uvs(mesh, layer)[loops]
            uvs = np.concatenate((uvs, np.zeros((*uvs.shape[:2], 1), np.float32)), axis=-1)
            self._corners["UV", layer.name] = uvs
            if layer.active_render:
                self._corners["UV", ""] = uvs
        self._corners.update(attributes.corners(mesh, attribute_names, chosen))
        self._corners.update({output: mesh_numbers.corners(mesh, output, self.triangles) for output in numbers})
        if matrix is not None and abs(np.linalg.det(matrix[:3, :3])) > LEAST_EXTENT:
            turn = np.linalg.inv(matrix[:3, :3]).T
            self._corners["WORLD"] = self._corners["OBJECT"] @ matrix[:3, :3].T + matrix[:3, 3]
            if to_camera is not None:
                self._corners["CAMERA"] = self._corners["WORLD"] @ to_camera[:3, :3].T + to_camera[:3, 3]
            self._corners["WORLD EDGES"] = edge_distances(self._corners["WORLD"])
            self._corners["WORLD NORMAL"] = self._corners["NORMAL"] @ turn.T
            faces = face_normals(self._corners["OBJECT"]) @ turn.T
            self._corners["WORLD FACE NORMAL"] = np.repeat(faces[:, None], 3, axis=1)

    def lay_out(self, atlases, density, most_texels):
        """Takes the atlas from Atlases; density: (n,) texels per unit at each triangle."""
        self._layout, self.atlas = atlases.of(self.rest, self.triangles, density, most_texels)

    def key(self, kinds):
        """A key that is equal for bodies of the same atlas on which what hangs on coordinates of these kinds looks alike."""
        return self._layout, self.looks(kinds)

    def looks(self, kinds):
        """A key that is equal for bodies whose triangles have the same coordinates of these kinds."""
        for kind in kinds:
            if kind not in self._digests:
                self._digests[kind] = digest(self._corners[kind].astype(np.float32)) if kind in self._corners else ""
        return tuple(sorted((repr(kind), self._digests[kind]) for kind in kinds))

    def knows(self, kind):
        return kind in self._corners

    def corners(self, kind):
        """(n, 3, 3) of the triangles' corners."""
        return self._corners[kind]

    def values(self, kind, texels, shift):
        """(n, 3) of what `kind` names, at the atlas' texels."""
        found = self.atlas.interpolated(self._corners[kind], texels, shift)
        if isinstance(kind, str) and "NORMAL" in kind:
            found /= np.maximum(np.linalg.norm(found, axis=-1, keepdims=True), 1e-30)
        return found

    def corner_uvs(self):
        """(m, 3, 2) of all triangles of the mesh, zero where another material is."""
        uvs = np.zeros((len(self.chosen), 3, 2), np.float32)
        uvs[self.chosen] = self.atlas.corner_uvs
        return uvs
