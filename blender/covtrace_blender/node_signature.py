"""Trees of nodes as texts that tell whether they have changed."""

import os

import bpy


def all_nodes(tree):
    """The nodes of a tree and of the groups in it."""
    for node in tree.nodes:
        yield node
        if getattr(node, "node_tree", None):
            yield from all_nodes(node.node_tree)


def tree_of(thing):
    """The tree of nodes of a material, a world or a lamp; None of what has none, or does not use it, and of None."""
    # Blender 6 is to have no use_nodes where nodes are always used
    return thing.node_tree if thing and getattr(thing, "use_nodes", True) else None


def hangs_on_world(tree):
    """Whether nodes ask for places in the world, not on the object alone."""
    return any(node.type in ("NEW_GEOMETRY", "CAMERA", "WIREFRAME", "BEVEL") or node.type == "TEX_COORD" and node.object for node in all_nodes(tree))


def _is_set(node, name):
    """Whether an input, if the node has it, is linked or above 0."""
    socket = node.inputs.get(name)
    return socket is not None and (socket.is_linked or socket.default_value > 0)


def scatters_through(tree):
    """Whether light that passes surfaces of this shader is scattered, as by leaves, strands and frosted glass."""
    for node in all_nodes(tree):
        if node.type in ("BSDF_TRANSLUCENT", "BSDF_HAIR", "BSDF_HAIR_PRINCIPLED"):
            return True
        is_glass = node.type in ("BSDF_GLASS", "BSDF_REFRACTION") or node.type == "BSDF_PRINCIPLED" and (
            _is_set(node, "Transmission") or _is_set(node, "Transmission Weight"))
        if is_glass and getattr(node, "distribution", "") != "SHARP" and (_is_set(node, "Roughness") or _is_set(node, "Transmission Roughness")):
            return True
    return False


# Properties of nodes that change no picture.
_LAYOUT = {"location", "location_absolute", "width", "height", "width_hidden", "label", "select", "hide", "color", "color_tag",
           "show_options", "show_preview", "show_texture", "use_custom_color", "warning_propagation"}


def _values(thing, without=()):
    """Names and values of a thing's own simple properties."""
    found = []
    for p in thing.bl_rna.properties:
        if p.is_readonly or p.identifier in without or p.type not in ("BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"):
            continue
        value = getattr(thing, p.identifier, None)
        found.append((p.identifier, tuple(value) if getattr(p, "is_array", False) else value))
    return found


def signature(tree):
    """A text that is equal for evaluated trees which make the same picture."""
    return repr(_content(tree))


def _content(tree):
    found = []
    for node in tree.nodes:
        entry = [node.bl_idname, _values(node, _LAYOUT)]
        entry += [(s.identifier, tuple(s.default_value) if hasattr(s.default_value, "__len__") else s.default_value)
                  for s in node.inputs if hasattr(s, "default_value")]
        entry += [s.default_value[:] if hasattr(s.default_value, "__len__") else s.default_value
                  for s in node.outputs if node.type in ("RGB", "VALUE")]
        if hasattr(node, "color_ramp"):
            entry.append([_values(node.color_ramp)] + [(e.position, tuple(e.color)) for e in node.color_ramp.elements])
        if getattr(node, "type", "") in ("CURVE_RGB", "CURVE_VEC", "CURVE_FLOAT"):
            entry.append([_values(node.mapping)] + [[(tuple(p.location), p.handle_type) for p in c.points] for c in node.mapping.curves])
        if getattr(node, "texture_mapping", None):
            entry.append(_values(node.texture_mapping))
        if getattr(node, "image", None):
            entry.append((node.image.name_full, _values(node.image, {"pixels"}), node.image.colorspace_settings.name,
                          _values(node.image_user) if hasattr(node, "image_user") else None, _stamp(node.image)))
        if getattr(node, "object", None):
            entry.append([tuple(row) for row in node.object.matrix_world])
        if getattr(node, "node_tree", None):
            entry.append(_content(node.node_tree))
        found.append(entry)
    links = [(k.from_node.name, k.from_socket.identifier, k.to_node.name, k.to_socket.identifier, k.is_muted)
             for k in tree.links]
    return found, links


def _stamp(image):
    try:
        return os.stat(bpy.path.abspath(image.filepath)).st_mtime_ns
    except OSError:
        return None
