"""Worlds of any nodes as images: a second Blender renders them by Cycles with a panoramic camera and nothing else."""

import os
import subprocess
import sys
import tempfile

import bpy
import numpy as np

from .node_signature import all_nodes, signature
from .shader_nodes.light_path import value_for

# Suns of the sky node are half a degree wide: 3 texels of the finest image.
ROWS, ROWS_WITH_SUN, ROWS_OF_PREVIEW = 512, 1024, 256
SAMPLES = 16  # per texel; what is small and bright gets more
MOST_SECONDS = 300

_PROCESS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "world_baking_process.py")
_known = {}  # the last images of each world: {(name, whether it is for a preview, kind of ray): (signature, values)}


class Failed(RuntimeError):
    """There is no image, with the reason."""


def bake(world, time, is_preview, tell, warn, ray):
    """(h, 2 h, 3) radiances from the top, as equirectangular images of Blender lie; not to be changed. `world`: evaluated at
    `time` in frames; `ray`: the kind of ray that sees it. Raises Failed."""
    nodes = list(all_nodes(world.node_tree))
    has_light_path = any(node.type == "LIGHT_PATH" for node in nodes)
    if any(value_for(output, ray) is None for node in nodes if node.type == "LIGHT_PATH"
           for output in node.outputs if output.is_linked):
        warn("the world's Light Path nodes tell of lengths and depths, which have no counterpart: all rays see the world "
             "that the camera sees there")
    for node in nodes:
        if getattr(node, "image", None) and node.image.is_dirty:
            warn(f"the world's image '{node.image.name}' has changes that are in no file, and is baked without them")
    has_sun = any(node.type == "TEX_SKY" and getattr(node, "sun_disc", False) for node in nodes)
    rows = ROWS_OF_PREVIEW if is_preview else ROWS_WITH_SUN if has_sun else ROWS
    key, wanted = (world.name_full, is_preview, ray if has_light_path else ""), signature(world.node_tree)
    if key not in _known or _known[key][0] != wanted:
        tell("baking the world by Cycles")
        _known[key] = wanted, _render(world.original, time, rows, ray)
    return _known[key][1]


def _command():
    """A Blender like this one that runs a script; the module bpy needs a Python."""
    if bpy.app.binary_path:
        return [bpy.app.binary_path, "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python",
                _PROCESS, "--"]
    return [sys.executable, _PROCESS, "--"]


def _render(world, time, rows, ray):
    with tempfile.TemporaryDirectory(prefix="covtrace-world-") as folder:
        library, image = os.path.join(folder, "world.blend"), os.path.join(folder, "world.npy")
        bpy.data.libraries.write(library, {world}, path_remap="ABSOLUTE", fake_user=True)
        try:
            done = subprocess.run([*_command(), library, world.name, repr(time), image, str(rows), str(SAMPLES), ray],
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=MOST_SECONDS)
        except subprocess.TimeoutExpired as problem:
            raise Failed(f"it took more than {MOST_SECONDS} seconds") from problem
        if done.returncode != 0 or not os.path.exists(image):
            lines = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()]
            raise Failed(lines[-1].strip() if lines else f"exit code {done.returncode}")
        return np.load(image)
