"""Attributes of meshes, colours among them, that nodes ask for by name."""

import bpy
import numpy as np

from . import export_meshes
from .node_signature import all_nodes
from .shader_nodes.coordinates import ACTIVE_COLOUR, attribute_of

# (property of an element, how many numbers it has, their type) by the kind of attribute. Cycles knows these alone.
PROPERTIES = {"FLOAT": ("value", 1, np.float32), "INT": ("value", 1, np.int32), "BOOLEAN": ("value", 1, bool),
              "FLOAT2": ("vector", 2, np.float32), "FLOAT_VECTOR": ("vector", 3, np.float32), "FLOAT_COLOR": ("color", 4, np.float32),
              "BYTE_COLOR": ("color", 4, np.float32), "QUATERNION": ("value", 4, np.float32)}
SINCE_4 = {"INT8": ("value", 1, np.int32)}  # not in Cycles 3.4, but in 4.5; of those between none was measured


def names(tree):
    """Those that the nodes of a tree ask for."""
    return {attribute_of(node) for node in all_nodes(tree) if node.type in ("ATTRIBUTE", "VERTEX_COLOR")}


def corners(mesh, wanted, chosen):
    """{(part, name): (n, 3, 3)} at the corners of the chosen triangles of what the mesh has of the `wanted` attributes: part
    "ATTRIBUTE" is the attribute itself, a number three times, "NUMBER" three times the number that it is, and "ALPHA" three times the
    opacity of a colour, 1 of all else."""
    found = {}
    for name in wanted:
        values = _corner_values(mesh, name, chosen)
        if values is None:
            continue
        width = values.shape[-1]
        found["ATTRIBUTE", name] = np.repeat(values, 3, axis=-1) if width == 1 else \
            np.concatenate((values[..., :3], np.zeros((*values.shape[:-1], max(0, 3 - width)), np.float32)), axis=-1)
        # As in Cycles: the mean of a colour, and no luminance, and the first one of two numbers.
        number = values[..., :3].mean(axis=-1, keepdims=True) if width > 2 else values[..., :1]
        found["NUMBER", name] = np.repeat(number, 3, axis=-1)
        found["ALPHA", name] = np.repeat(values[..., 3:] if width == 4 else np.ones_like(values[..., :1]), 3, axis=-1)
    return found


def _corner_values(mesh, name, chosen):
    """(n, 3, 1 to 4), of colours linear; None of what the mesh has not."""
    attribute = _attribute(mesh, name)
    known = {**PROPERTIES, **(SINCE_4 if bpy.app.version >= (4, 0, 0) else {})}
    if attribute is not None and attribute.data_type in known and len(attribute.data):
        return _at_corners(mesh, attribute.domain, _values(attribute, *known[attribute.data_type]), chosen)
    # Before Blender 3.5 UV maps are none of the attributes.
    if name is not ACTIVE_COLOUR and name in mesh.uv_layers:
        return export_meshes.loop_uvs(mesh, mesh.uv_layers[name])[export_meshes.triangle_loops(mesh)[chosen]]
    return None


def _attribute(mesh, name):
    if name is not ACTIVE_COLOUR:
        return mesh.attributes.get(name)
    index, colours = mesh.color_attributes.render_color_index, mesh.color_attributes
    return colours[index] if 0 <= index < len(colours) else None


def _values(attribute, name, width, kind):
    """(n, width)."""
    values = np.empty(width * len(attribute.data), kind)
    attribute.data.foreach_get(name, values)
    return values.reshape(-1, width).astype(np.float32)


def _at_corners(mesh, domain, values, chosen):
    """(n, 3, w) of (m, w) values of a domain."""
    if domain == "CORNER":
        return values[export_meshes.triangle_loops(mesh)[chosen]]
    if domain == "FACE":
        return np.repeat(values[export_meshes.triangle_polygons(mesh)[chosen]][:, None], 3, axis=1)
    if domain == "EDGE":
        values = _of_edges_at_vertices(mesh, values)
    return values[export_meshes.triangles(mesh)[chosen]]


def _of_edges_at_vertices(mesh, values):
    """(vertices, w) means of (edges, w) over the edges of each vertex."""
    ends = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", ends)
    total, count = np.zeros((len(mesh.vertices), values.shape[1]), np.float32), np.zeros((len(mesh.vertices), 1), np.float32)
    np.add.at(total, ends, np.repeat(values, 2, axis=0))
    np.add.at(count, ends, 1)
    return total / np.maximum(count, 1)
