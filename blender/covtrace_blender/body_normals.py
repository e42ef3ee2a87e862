"""Normal maps of a UV map as normal maps of an atlas."""

import numpy as np

from .body_baking import body_image


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


def kinds(uv_map):
    """The kinds of coordinates of a body that turned normals hang on."""
    return "NORMAL", "OBJECT", uv_map


def turned(image, body, uv_map, strengths):
    """A BakedImage of the normals that `image`, a BakedImage over the atlas of `body`, tells in the frame of the UV map `uv_map`, in that of the
    atlas. strengths: of x, y and z, which blend from the flat normal."""
    atlas, texels = body.atlas, body.atlas.texels
    flat = np.array([0, 0, 1])
    local = flat + (2 * image.values[texels.rows, texels.columns] - 1 - flat) * strengths
    normals = body.values("NORMAL", np.arange(len(texels.triangle)), (0, 0))
    positions = body.corners("OBJECT")
    of_map, of_atlas = (_frame(normals, *(part[texels.triangle] for part in _tangents(positions, uvs)))
                        for uvs in (body.corners(uv_map), atlas.corner_uvs))
    whole = np.einsum("ki,kij->kj", local, of_map)
    found = np.einsum("kij,kj->ki", of_atlas, whole)
    found /= np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-30)
    return body_image(atlas, 0.5 * found + 0.5)
