"""Worlds of any nodes as images: a second Blender renders them by Cycles with a panoramic camera and nothing else."""

import os
import subprocess
import sys
import tempfile

import bpy
import numpy as np

# Suns of the sky node are half a degree wide: 3 texels of the finest image.
ROWS, ROWS_WITH_SUN, ROWS_OF_PREVIEW = 512, 1024, 256
SAMPLES = 16  # per texel; what is small and bright gets more
MOST_SECONDS = 300

_PROCESS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "world_baking_process.py")
_known = {}  # the last images of each world: {(name, whether it is for a preview): (signature, values)}


class Failed(RuntimeError):
    """There is no image, with the reason."""


def bake(world, time, is_preview, tell, warn):
    """(h, 2 h, 3) radiances from the top, as equirectangular images of Blender lie; not to be changed. `world`: evaluated at
    `time` in frames. Raises Failed."""
    nodes = list(_nodes(world.node_tree))
    if any(node.type == "LIGHT_PATH" for node in nodes):
        warn("the world's Light Path nodes have no counterpart: all rays see the world that the camera sees")
    for node in nodes:
        if getattr(node, "image", None) and node.image.is_dirty:
            warn(f"the world's image '{node.image.name}' has changes that are in no file, and is baked without them")
    has_sun = any(node.type == "TEX_SKY" and getattr(node, "sun_disc", False) for node in nodes)
    rows = ROWS_OF_PREVIEW if is_preview else ROWS_WITH_SUN if has_sun else ROWS
    key, signature = (world.name_full, is_preview), repr(_signature(world.node_tree))
    if key not in _known or _known[key][0] != signature:
        tell("baking the world by Cycles")
        _known[key] = signature, _render(world.original, time, rows)
    return _known[key][1]


def _nodes(tree):
    for node in tree.nodes:
        yield node
        if getattr(node, "node_tree", None):
            yield from _nodes(node.node_tree)


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


def _signature(tree):
    """Equal for trees that make the same picture while no file of an image changes."""
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
            entry.append([[(tuple(p.location), p.handle_type) for p in c.points] for c in node.mapping.curves])
        if getattr(node, "texture_mapping", None):
            entry.append(_values(node.texture_mapping))
        if getattr(node, "image", None):
            entry.append((node.image.name_full, _values(node.image), _values(node.image_user), _stamp(node.image)))
        if getattr(node, "object", None):
            entry.append([tuple(row) for row in node.object.matrix_world])
        if getattr(node, "node_tree", None):
            entry.append(_signature(node.node_tree))
        found.append(entry)
    links = [(k.from_node.name, k.from_socket.identifier, k.to_node.name, k.to_socket.identifier) for k in tree.links]
    return found, links


def _stamp(image):
    try:
        return os.stat(bpy.path.abspath(image.filepath)).st_mtime_ns
    except OSError:
        return None


def _command():
    """A Blender like this one that runs a script; the module bpy needs a Python."""
    if bpy.app.binary_path:
        return [bpy.app.binary_path, "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python",
                _PROCESS, "--"]
    return [sys.executable, _PROCESS, "--"]


def _render(world, time, rows):
    with tempfile.TemporaryDirectory(prefix="covtrace-world-") as folder:
        library, image = os.path.join(folder, "world.blend"), os.path.join(folder, "world.npy")
        bpy.data.libraries.write(library, {world}, path_remap="ABSOLUTE", fake_user=True)
        try:
            done = subprocess.run([*_command(), library, world.name, repr(time), image, str(rows), str(SAMPLES)],
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=MOST_SECONDS)
        except subprocess.TimeoutExpired as problem:
            raise Failed(f"it took more than {MOST_SECONDS} seconds") from problem
        if done.returncode != 0 or not os.path.exists(image):
            lines = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()]
            raise Failed(lines[-1].strip() if lines else f"exit code {done.returncode}")
        return np.load(image)
