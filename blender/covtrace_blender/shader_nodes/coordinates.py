"""Texture coordinates and their mapping."""

import numpy as np

from .place import RANDOMS, STRANDS
from .unsupported import Unsupported

IS_STRAND = "Is Strand"  # what an Owner says of strands


def _texture_coordinates(node, output, inputs):
    other = getattr(node, "object", None)
    if output.identifier == "UV":
        return inputs.place.uv_of(node, "")
    if output.identifier == "Object" and other is not None:
        matrix = np.array(other.matrix_world, float)
        if abs(np.linalg.det(matrix)) < 1e-30:
            raise Unsupported(node, f"the object '{other.name}' has no extent")
        to_other = np.linalg.inv(matrix).astype(np.float32)
        return inputs.place.coordinates(node, "WORLD") @ to_other[:3, :3].T + to_other[:3, 3]
    if output.identifier in ("Generated", "Object", "Normal"):
        return inputs.place.coordinates(node, output.identifier.upper())
    raise Unsupported(node, f"its {output.identifier.lower()} coordinates have no counterpart")


# Outputs of the node Geometry; bumps aside, the true normal differs from the other one where surfaces are smooth.
_GEOMETRY = {"Position": "WORLD", "Normal": "WORLD NORMAL", "True Normal": "WORLD FACE NORMAL"}


def _geometry(node, output, inputs):
    if output.identifier == "Backfacing":
        return inputs.place.is_behind().astype(np.float32)
    if output.identifier in ("Random Per Island", "Pointiness"):
        return inputs.place.coordinates(node, output.identifier)[:, 0]
    if output.identifier not in _GEOMETRY:
        raise Unsupported(node, f"its {output.identifier.lower()} has no counterpart")
    return inputs.place.coordinates(node, _GEOMETRY[output.identifier])


def _camera_data(node, output, inputs):
    """The place as the camera sees it, also for rays that do not come from there, as in Cycles."""
    away = inputs.place.coordinates(node, "CAMERA")
    if output.identifier == "View Z Depth":
        return away[:, 2]
    distance = np.linalg.norm(away, axis=1)
    return distance if output.identifier == "View Distance" else away / np.maximum(distance, 1e-30)[:, None]


def _wireframe(node, output, inputs):
    """Whether one of the triangle's sides, each half as wide as the lines, is near: those between the triangles of a face, too."""
    if node.use_pixel_size:
        raise Unsupported(node, "lines as wide as pixels have no counterpart")
    return (inputs.place.coordinates(node, "WORLD EDGES").min(axis=1) < inputs.number("Size") / 2).astype(np.float32)


def rotation(euler):
    """(..., 3, 3) of Euler angles x, y, z in radian, x first: (..., 3)."""
    x, y, z = np.moveaxis(np.asarray(euler, float), -1, 0)
    (sx, cx), (sy, cy), (sz, cz) = ((np.sin(a), np.cos(a)) for a in (x, y, z))
    rows = [[cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
            [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
            [-sy, cy * sx, cy * cx]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2).astype(np.float32)


def _turned(vector, turn, back=False):
    """A vector, or one for each place, turned by a matrix, or one for each place; or turned back."""
    if turn.ndim == 2:
        return vector @ (turn if back else turn.T)
    return np.einsum("...ji,...j->...i" if back else "...ij,...j->...i", turn, vector)


def _mapping(node, output, inputs):
    vector, scale, angles = (inputs.vector(name) for name in ("Vector", "Scale", "Rotation"))
    turn = rotation(angles)
    if node.vector_type == "POINT":
        return _turned(vector * scale, turn) + inputs.vector("Location")
    if node.vector_type == "TEXTURE":
        turned = _turned(vector - inputs.vector("Location"), turn, back=True)
        return np.where(scale != 0, turned / np.where(scale != 0, scale, 1), 0)
    if node.vector_type == "VECTOR":
        return _turned(vector * scale, turn)
    normal = _turned(np.where(scale != 0, vector / np.where(scale != 0, scale, 1), 0), turn)
    return normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-30)


def _vector_rotate(node, output, inputs):
    vector, centre = inputs.vector("Vector"), inputs.vector("Center")
    if node.rotation_type == "EULER_XYZ":
        return _turned(vector - centre, rotation(inputs.vector("Rotation")), back=node.invert) + centre
    axes = {"X_AXIS": (1, 0, 0), "Y_AXIS": (0, 1, 0), "Z_AXIS": (0, 0, 1)}
    axis = np.array(axes[node.rotation_type], np.float32) if node.rotation_type in axes else inputs.vector("Axis")
    length = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis, away = axis / np.maximum(length, 1e-30), vector - centre
    angle = inputs.number("Angle")[..., None] * (-1 if node.invert else 1)
    along = axis * (axis * away).sum(axis=-1, keepdims=True)
    turned = along + (away - along) * np.cos(angle) + np.cross(axis, away) * np.sin(angle)
    return np.where(length > 0, turned + centre, vector)


ACTIVE_COLOUR = None  # the name of the colour that is active for rendering


def attribute_of(node):
    """The name of the attribute of a node Attribute or Color Attribute, or ACTIVE_COLOUR."""
    return node.layer_name or ACTIVE_COLOUR if node.type == "VERTEX_COLOR" else node.attribute_name


def _attribute(node, output, inputs):
    # Blender 5.3 calls Fac Factor, and has kept its identifier.
    part = {"Fac": "NUMBER", "Alpha": "ALPHA"}.get(output.identifier, "ATTRIBUTE")
    kind = getattr(node, "attribute_type", "GEOMETRY")
    if kind == "OBJECT" and inputs.place.owner:
        return _part_of(inputs.place.owner.value((kind, node.attribute_name)), part)
    if kind != "GEOMETRY":
        raise Unsupported(node, f"attributes of its type {kind.lower()} have no counterpart")
    # As in Cycles: Attribute takes what a mesh has not for a number, which is opaque.
    missing = 1.0 if part == "ALPHA" and node.type == "ATTRIBUTE" else 0.0
    found = inputs.place.attribute(node, attribute_of(node), part, missing)
    return found if part == "ATTRIBUTE" else found.mean(axis=-1)


def _volume_info(node, output, inputs):
    """The grids of smoke and fire by their usual names."""
    found = inputs.place.attribute(node, output.identifier.lower(), "ATTRIBUTE", 0.0)
    return found if output.identifier == "Color" else found.mean(axis=-1)


def _part_of(value, part):
    """A part of an object's attribute: (1,), (3,) or (4,), or None for what it has not."""
    if value is None:
        value = np.zeros(4, np.float32)
    if part == "ALPHA":
        return value[3] if len(value) > 3 else np.float32(1)
    return value[:3].mean() if part == "NUMBER" else np.resize(value[:3], 3)


def _object_info(node, output, inputs):
    owner = inputs.place.owner
    found = owner.value(output.name) if owner else None
    if found is None:
        raise Unsupported(node, f"the {output.name.lower()} of what has instances is not known" if owner else "it is on no object")
    return found


def _curves_info(node, output, inputs):
    """The place along strands and a random number of each; zero on all else, as in Cycles."""
    owner, wanted = inputs.place.owner, output.identifier
    if not (owner and owner.value(IS_STRAND)):
        return np.zeros(3 if wanted == "Tangent Normal" else (), np.float32)
    if wanted == "Is Strand":
        return np.float32(1)
    if wanted not in ("Intercept", "Random"):
        raise Unsupported(node, f"its {wanted.lower()} has no counterpart")
    uv = inputs.place.uv_of(node, STRANDS)
    return uv[:, 0] if wanted == "Intercept" else uv[:, 1] / RANDOMS


NODES = {"TEX_COORD": _texture_coordinates, "NEW_GEOMETRY": _geometry, "MAPPING": _mapping, "VECTOR_ROTATE": _vector_rotate,
         "OBJECT_INFO": _object_info, "ATTRIBUTE": _attribute, "VERTEX_COLOR": _attribute, "VOLUME_INFO": _volume_info,
         "HAIR_INFO": _curves_info, "CAMERA": _camera_data, "WIREFRAME": _wireframe,
         "UVMAP": lambda node, output, inputs: inputs.place.uv_of(node, node.uv_map)}
