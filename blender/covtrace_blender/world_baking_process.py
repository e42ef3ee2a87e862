"""Run by a second Blender: renders a world of a library into an equirectangular image by Cycles, an array of numpy in the
file IMAGE, rows from the top.

    LIBRARY NAME TIME IMAGE ROWS SAMPLES RAY, behind --

RAY: the kind of ray that sees the world.
"""

import math
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from shader_nodes.light_path import value_for

# Texels this many times brighter than the mean, where they are few, are rendered again with more samples: suns. Those of a sky are few texels;
# those of a picture may be thousands, which all of these samples together are for.
BRIGHT, MOST_OF_IMAGE, SAMPLES_OF_BRIGHT, SAMPLES_TOGETHER = 20, 0.01, 4096, 1 << 21


def main(library, name, time, image, rows, samples, ray):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if "cycles" not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module="cycles")
    with bpy.data.libraries.load(library) as (there, here):
        here.worlds = [n for n in there.worlds if n == name]
    scene = bpy.context.scene
    scene.world = here.worlds[0]
    scene.world.cycles.sampling_method = "NONE"  # nothing is lit
    tree = scene.world.node_tree
    for link in [k for k in tree.links if k.to_node.type == "OUTPUT_WORLD" and k.to_socket.name == "Volume"]:
        tree.links.remove(link)
    for inside in [tree] + [group for group in bpy.data.node_groups if group.bl_idname == "ShaderNodeTree"]:
        replace_light_paths(inside, ray)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.rotation_euler = (math.pi / 2, 0, -math.pi / 2)  # the middle of the image lies along x
    camera.data.type = "PANO"
    (camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles).panorama_type = "EQUIRECTANGULAR"
    frame = math.floor(float(time))
    scene.frame_set(frame, subframe=float(time) - frame)

    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "ZIP"
    settings.color_mode = "RGB"
    scene.render.engine = "CYCLES"
    scene.render.filepath = image + ".exr"
    rows = int(rows)
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 2 * rows, rows, 100
    cycles = scene.cycles
    cycles.use_adaptive_sampling, cycles.use_denoising, cycles.pixel_filter_type = False, False, "BOX"
    cycles.max_bounces, cycles.sample_clamp_direct = 0, 0
    np.save(image, render(scene, 2 * rows, rows, int(samples))[::-1])


def replace_light_paths(tree, ray):
    """Puts what Light Path nodes are to rays of a kind in their places."""
    for link in [k for k in tree.links if k.from_node.type == "LIGHT_PATH"]:
        value = value_for(link.from_socket, ray)
        if value is not None:
            constant = tree.nodes.new("ShaderNodeValue")
            constant.outputs[0].default_value = value
            tree.links.new(constant.outputs[0], link.to_socket)


def render(scene, width, height, samples):
    """(h, w, 3), rows from the bottom."""
    values = pixels(scene, samples)
    bright = values.max(-1) > BRIGHT * values.mean()
    if not bright.any():
        return values
    rows, columns = np.nonzero(bright)
    y0, y1, x0, x1 = max(rows.min() - 2, 0), min(rows.max() + 3, height), max(columns.min() - 2, 0), min(columns.max() + 3, width)
    if (y1 - y0) * (x1 - x0) > MOST_OF_IMAGE * width * height:
        return values
    border = scene.render
    border.use_border, border.use_crop_to_border = True, True
    # Half a pixel further, since the limits are rounded down.
    border.border_min_x, border.border_max_x = (x0 + 0.5) / width, (x1 + 0.5) / width
    border.border_min_y, border.border_max_y = (y0 + 0.5) / height, (y1 + 0.5) / height
    values[y0:y1, x0:x1] = pixels(scene, min(SAMPLES_OF_BRIGHT, SAMPLES_TOGETHER // ((y1 - y0) * (x1 - x0))))
    return values


def pixels(scene, samples):
    """(h, w, 3) as the scene is rendered, rows from the bottom."""
    scene.cycles.samples = samples
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    width, height = image.size
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(height, width, -1)[..., :3].copy()
    bpy.data.images.remove(image)
    return values


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1:])
