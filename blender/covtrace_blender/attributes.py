"""Attributes of meshes, colours among them, that nodes ask for by name."""

import numpy as np

from . import export_meshes
from .node_signature import all_nodes
from .shader_nodes.coordinates import attribute_of

PROPERTIES = {"FLOAT_COLOR": ("color", 4), "BYTE_COLOR": ("color", 4), "FLOAT_VECTOR": ("vector", 3), "FLOAT2": ("vector", 2)}


def names(tree):
    """Those that the nodes of a tree ask for; "" is the colour that is active for rendering."""
    return {attribute_of(node) for node in all_nodes(tree) if node.type in ("ATTRIBUTE", "VERTEX_COLOR")}


def corners(mesh, wanted, chosen):
    """{(part, name): (n, 3, 3)} at the corners of the chosen triangles of what the mesh has of the `wanted` attributes: part
    "ATTRIBUTE" is the attribute itself, a number three times, and "ALPHA" three times the opacity of a colour, 1 of all else."""
    found = {}
    for name in wanted:
        attribute = _attribute(mesh, name)
        if attribute is None or attribute.data_type == "STRING" or not len(attribute.data):
            continue
        values = _at_corners(mesh, attribute.domain, _values(attribute), chosen)
        found["ATTRIBUTE", name] = np.repeat(values, 3, axis=-1) if values.shape[-1] == 1 else \
            np.concatenate((values[..., :3], np.zeros((*values.shape[:-1], max(0, 3 - values.shape[-1])), np.float32)), axis=-1)
        alpha = values[..., 3:] if values.shape[-1] == 4 else np.ones_like(values[..., :1])
        found["ALPHA", name] = np.repeat(alpha, 3, axis=-1)
    return found


def _attribute(mesh, name):
    if name:
        return mesh.attributes.get(name)
    index, colours = mesh.color_attributes.render_color_index, mesh.color_attributes
    return colours[index] if 0 <= index < len(colours) else None


def _values(attribute):
    """(n, 1 to 4); colours are linear."""
    name, width = PROPERTIES.get(attribute.data_type, ("value", 1))
    is_whole = attribute.data_type in ("INT", "INT8", "BOOLEAN")
    values = np.empty(width * len(attribute.data), np.int32 if is_whole else np.float32)
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
