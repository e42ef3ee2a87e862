"""Blender's evaluated meshes as triangles, one part per material."""

import bpy
import numpy as np


def positions(mesh):
    """(n, 3) float32, object space."""
    values = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", values)
    return values.reshape(-1, 3)


def box(mesh):
    """(low, high) corners of the box around the vertices of a mesh, which has some."""
    places = positions(mesh)
    return places.min(0), places.max(0)


def reshape(mesh, places):
    """Moves the vertices of a mesh to (n, 3) places, where it has as many."""
    if len(places) == len(mesh.vertices):
        mesh.vertices.foreach_set("co", places.ravel())
        mesh.update()


def _triangles(mesh, name, width=3):
    values = np.empty(width * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def _join(corners):
    """Distinct rows of per-corner data, and each corner's row among them."""
    rows = np.ascontiguousarray(corners).view(np.dtype((np.void, corners.dtype.itemsize * corners.shape[1])))
    _, first, inverse = np.unique(rows.ravel(), return_index=True, return_inverse=True)
    return corners[first], inverse


def active_uv_map(mesh):
    """The name of the UV map that is active for rendering; None where there is none."""
    return next((layer.name for layer in mesh.uv_layers if layer.active_render), None)


def uv_map(mesh, names):
    """(the UV map that a material reads of a mesh, whether it is all that it wants).

    names: as the material's nodes have them; "" is the one that is active for rendering. A mesh has one here: the first.
    """
    active = active_uv_map(mesh)
    wanted = [name or active for name in names] or [active]
    chosen = wanted[0] if wanted[0] and wanted[0] in mesh.uv_layers else active
    return chosen, all(name == chosen for name in wanted)


def triangles(mesh):
    """(n, 3) vertices."""
    return _triangles(mesh, "vertices")


def triangle_loops(mesh):
    """(n, 3) corners of faces."""
    return _triangles(mesh, "loops")


def triangle_slots(mesh):
    """(n,) material slots."""
    return _triangles(mesh, "material_index", 1)


def triangles_of(mesh, materials, material):
    """(n,) which triangles have one of the `materials` of an object's slots."""
    mesh.calc_loop_triangles()
    slots = [k for k in range(max(1, len(materials))) if not materials or materials[k] == material]
    return np.isin(np.minimum(triangle_slots(mesh), max(len(materials) - 1, 0)), slots)


def triangle_polygons(mesh):
    """(n,) faces."""
    return _triangles(mesh, "polygon_index", 1)


def smooth_triangles(mesh):
    """(n,) whether the face of each has smooth shading."""
    smooth_polygons = np.empty(len(mesh.polygons), dtype=bool)
    mesh.polygons.foreach_get("use_smooth", smooth_polygons)
    return smooth_polygons[triangle_polygons(mesh)]


def _has_sharp_edges(mesh):
    sharp = mesh.attributes.get("sharp_edge")
    if sharp is None:
        return False
    values = np.empty(len(sharp.data), bool)
    sharp.data.foreach_get("value", values)
    return bool(values.any())


def loop_normals(mesh):
    """(n, 3) of the corners of faces, for smooth ones as Cycles has them."""
    if hasattr(mesh, "calc_normals_split"):  # from Blender 4.1 on they are there
        mesh.calc_normals_split()
    elif bpy.app.version < (5, 1, 0) and not mesh.has_custom_normals and not _has_sharp_edges(mesh):
        # Blender's own are cut where a smooth face meets a flat one, in Cycles before 5.1 all faces of a vertex have a part in its
        # normal.
        normals, vertices = np.empty(3 * len(mesh.vertices), np.float32), np.empty(len(mesh.loops), np.int32)
        mesh.vertex_normals.foreach_get("vector", normals)
        mesh.loops.foreach_get("vertex_index", vertices)
        return normals.reshape(-1, 3)[vertices]
    normals = np.empty(3 * len(mesh.loops), dtype=np.float32)
    mesh.loops.foreach_get("normal", normals)
    return normals.reshape(-1, 3)


def loop_uvs(mesh, layer):
    """(n, 2) of the corners of faces; zero in a mesh that is being edited, which has none."""
    uvs = np.zeros(2 * len(mesh.loops), dtype=np.float32)
    if len(layer.data) == len(mesh.loops):
        layer.data.foreach_get("uv", uvs)
    return uvs.reshape(-1, 2)


def parts(mesh, uvs_of_slot, piece_of_triangle=None, tangents_of_slot=lambda slot: None, kept_normals=None):
    """Yields (material slot, piece, positions, normals or None, uvs or None, triangles, tangents or None).

    uvs_of_slot(slot), tangents_of_slot(slot): (n, 3, 2) and (n, 3, 3) of all triangles' corners, or None. piece_of_triangle: pieces that stay apart; None: all is piece 0.
    Corners that agree in everything are one vertex, so that smooth surfaces are closed. kept_normals: (which triangles,
    (n, 3, 3) normals of all corners) of those that have these in the place of their own, or None. Faces without smooth shading have no
    normals: the triangles' own are theirs.
    """
    mesh.calc_loop_triangles()
    if not mesh.loop_triangles:
        return
    points = positions(mesh)
    vertices, loops, slots = triangles(mesh), triangle_loops(mesh), triangle_slots(mesh)
    smooth = smooth_triangles(mesh)
    normals = loop_normals(mesh)[loops] if smooth.any() else None
    if kept_normals:
        has_kept, kept = kept_normals
        normals = np.where(has_kept[:, None, None], kept, 0 if normals is None else normals)
        smooth = smooth | has_kept
    piece = np.zeros(len(slots), dtype=int) if piece_of_triangle is None else piece_of_triangle
    for slot, number in np.unique(np.column_stack((slots, piece)), axis=0):
        uvs, tangents = uvs_of_slot(int(slot)), tangents_of_slot(int(slot))
        for is_smooth in (False, True):
            chosen = (slots == slot) & (piece == number) & (smooth == is_smooth)
            if not chosen.any():
                continue
            columns = [points[vertices[chosen].ravel()]]
            if is_smooth:
                columns.append(normals[chosen].reshape(-1, 3))
            if uvs is not None:
                columns.append(uvs[chosen].reshape(-1, 2))
            if tangents is not None:
                columns.append(tangents[chosen].reshape(-1, 3))
            distinct, corners = _join(np.hstack(columns).astype(np.float32))
            found = iter(np.split(distinct, np.cumsum([c.shape[1] for c in columns])[:-1], axis=1))
            yield (int(slot), int(number), next(found), next(found) if is_smooth else None, next(found) if uvs is not None else None,
                   corners.reshape(-1, 3), next(found) if tangents is not None else None)
