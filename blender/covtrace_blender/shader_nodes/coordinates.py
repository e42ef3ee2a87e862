"""Texture coordinates and their mapping."""

import math

import numpy as np

from .unsupported import Unsupported


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
    if output.identifier not in _GEOMETRY:
        raise Unsupported(node, f"its {output.identifier.lower()} has no counterpart")
    return inputs.place.coordinates(node, _GEOMETRY[output.identifier])


def rotation(euler):
    """(3, 3) of Euler angles x, y, z in radian, x first."""
    (sx, sy, sz), (cx, cy, cz) = (tuple(f(float(a)) for a in euler) for f in (math.sin, math.cos))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return (about_z @ about_y @ about_x).astype(np.float32)


def _mapping(node, output, inputs):
    vector, scale, angles = (inputs.vector(name) for name in ("Vector", "Scale", "Rotation"))
    if angles.ndim > 1:
        raise Unsupported(node, "its rotation is not the same everywhere")
    turn = rotation(angles)
    if node.vector_type == "POINT":
        return (vector * scale) @ turn.T + inputs.vector("Location")
    if node.vector_type == "TEXTURE":
        turned = (vector - inputs.vector("Location")) @ turn
        return np.where(scale != 0, turned / np.where(scale != 0, scale, 1), 0)
    if node.vector_type == "VECTOR":
        return (vector * scale) @ turn.T
    normal = np.where(scale != 0, vector / np.where(scale != 0, scale, 1), 0) @ turn.T
    return normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-30)


ACTIVE_COLOUR = None  # the name of the colour that is active for rendering


def attribute_of(node):
    """The name of the attribute of a node Attribute or Color Attribute, or ACTIVE_COLOUR."""
    return node.layer_name or ACTIVE_COLOUR if node.type == "VERTEX_COLOR" else node.attribute_name


def _attribute(node, output, inputs):
    if getattr(node, "attribute_type", "GEOMETRY") != "GEOMETRY":
        raise Unsupported(node, f"attributes of its type {node.attribute_type.lower()} have no counterpart")
    # Blender 5.3 calls Fac Factor, and has kept its identifier.
    part = {"Fac": "NUMBER", "Alpha": "ALPHA"}.get(output.identifier, "ATTRIBUTE")
    # As in Cycles: Attribute takes what a mesh has not for a number, which is opaque.
    missing = 1.0 if part == "ALPHA" and node.type == "ATTRIBUTE" else 0.0
    found = inputs.place.attribute(node, attribute_of(node), part, missing)
    return found if part == "ATTRIBUTE" else found.mean(axis=-1)


def _object_info(node, output, inputs):
    owner = inputs.place.owner
    found = owner.value(output.name) if owner else None
    if found is None:
        raise Unsupported(node, f"the {output.name.lower()} of what has instances is not known" if owner else "it is on no object")
    return found


NODES = {"TEX_COORD": _texture_coordinates, "NEW_GEOMETRY": _geometry, "MAPPING": _mapping,
         "OBJECT_INFO": _object_info, "ATTRIBUTE": _attribute, "VERTEX_COLOR": _attribute,
         "UVMAP": lambda node, output, inputs: inputs.place.uv_of(node, node.uv_map)}
