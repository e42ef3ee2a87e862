"""Normal maps of a UV map as normal maps of an atlas."""

import numpy as np

from .baked import BakedImage
from .body_baking import filled


def _tangents(positions, uvs):
    """((n, 3) directions of u, (n,) signs of the side on which v is) of (n, 3, 3) triangles with (n, 3, 2) coordinates."""
    sides, steps = positions[:, 1:] - positions[:, :1], uvs[:, 1:, :2] - uvs[:, :1, :2]
    area = steps[:, 0, 0] * steps[:, 1, 1] - steps[:, 1, 0] * steps[:, 0, 1]
    sign = np.where(area < 0, -1.0, 1.0)
    return (sides[:, 0] * steps[:, 1, 1:] - sides[:, 1] * steps[:, 0, 1:]) * sign[:, None], sign


def _frame(normals, tangents, signs):
    """(k, 3, 3): x along the tangents, y, z the normals, as rows."""
    x = tangents - normals * (tangents * normals).sum(axis=1, keepdims=True)
    x /= np.maximum(np.linalg.norm(x, axis=1, keepdims=True), 1e-30)
    return np.stack((x, np.cross(normals, x) * signs[:, None], normals), axis=1)


def turned(image, body, uv_map, strength):
    """A BakedImage of the normals that `image`, a BakedImage over the atlas of `body`, tells in the frame of the UV map `uv_map`, in that of the
    atlas. strength: Blender's, which blends from the flat normal."""
    atlas = body.atlas
    all_texels = np.arange(len(atlas.triangle))
    flat = np.array([0, 0, 1])
    local = flat + (2 * image.values[atlas.rows, atlas.columns, :3] - 1 - flat) * strength
    normals = body.values("NORMAL", all_texels, (0, 0))
    positions = body.corners("OBJECT")
    of_map, of_atlas = (_frame(normals, *(part[atlas.triangle] for part in _tangents(positions, uvs)))
                        for uvs in (body.corners(uv_map), atlas.corner_uvs))
    world = np.einsum("ki,kij->kj", local, of_map)
    found = np.einsum("kij,kj->ki", of_atlas, world)
    found /= np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-30)
    values, known = np.ones_like(image.values), np.zeros(image.values.shape[:2], bool)
    known[atlas.rows, atlas.columns] = True
    values[atlas.rows, atlas.columns, :3] = 0.5 * found + 0.5
    values[..., :3] = filled(values[..., :3], known)
    return BakedImage(values)
