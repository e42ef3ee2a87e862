"""Materials that hang on the angle of sight, on a ball and a monkey, by covtrace and by Cycles: light, errors, pictures.

    COVTRACE=PROGRAM PYTHON_WITH_BPY bench/blender/sight.py OUT [NAME ...]

Of the names in MATERIALS, or of all. Errors are means over blocks of 8x8 pixels of the difference between both, as a share of Cycles' mean
and the largest of a channel. OUT gets NAME.npz and NAME.png, covtrace above, Cycles below, and sheet.png of those in SHOWN.
"""

import os
import pathlib
import sys
import tempfile

import bpy
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE.parents[1] / "blender"), str(HERE.parents[1] / "tests" / "blender")]
import covtrace_blender
from covtrace_blender.export_textures import to_srgb
from node_trees import Tree

WIDTH, HEIGHT, BLOCK = 240, 128, 8
SAMPLES = {"COVTRACE": 96, "CYCLES": 256}
BOUNCES = 12


def facing(tree, blend):
    return tree.node("LayerWeight", None, {"Blend": blend}), "Facing"


def fresnel(tree, index):
    return tree.node("Fresnel", None, {"IOR": index}), 0


def ramp(tree, factor, *colours):
    node = tree.node("ValToRGB", None, {"Fac": factor})
    elements = node.color_ramp.elements
    elements[0].color, elements[1].color = colours[0], colours[-1]
    for i, colour in enumerate(colours[1:-1], 1):
        elements.new(i / (len(colours) - 1)).color = colour
    return node, 0


def mixed(tree, share, first, second):
    return tree.node("MixShader", None, {0: share, 1: first, 2: second})


def paint(tree):
    colour = ramp(tree, facing(tree, 0.4), (0.6, 0.02, 0.02, 1), (0.3, 0.05, 0.5, 1), (0.05, 0.3, 0.9, 1))
    return tree.node("BsdfPrincipled", None, {"Base Color": colour, "Metallic": 0.6, "Roughness": 0.35, "Coat Weight": 1.0})


def rim(tree):
    strength = tree.node("Math", {"operation": "MULTIPLY"}, {0: facing(tree, 0.3), 1: 2.0})
    light = tree.node("Emission", None, {"Color": (1, 0.6, 0.2, 1), "Strength": (strength, 0)})
    return tree.node("AddShader", None, {0: tree.node("BsdfDiffuse", None, {"Color": (0.2, 0.02, 0.1, 1)}), 1: light})


def x_ray(tree):
    light = tree.node("Emission", None, {"Color": (0.2, 0.6, 1, 1), "Strength": 1.5})
    return mixed(tree, facing(tree, 0.3), tree.node("BsdfTransparent"), light)


def two_colours(tree):
    return mixed(tree, fresnel(tree, 1.8), tree.node("BsdfDiffuse", None, {"Color": (0.05, 0.1, 0.4, 1)}),
                 tree.node("BsdfGlossy", None, {"Color": (1, 0.7, 0.2, 1), "Roughness": 0.2}))


def plastic(tree):
    return mixed(tree, fresnel(tree, 1.5), tree.node("BsdfDiffuse", None, {"Color": (0.6, 0.1, 0.1, 1)}),
                 tree.node("BsdfGlossy", None, {"Color": (1, 1, 1, 1), "Roughness": 0.1}))


def bubble(tree):
    return mixed(tree, fresnel(tree, 1.4), tree.node("BsdfTransparent"),
                 tree.node("BsdfGlossy", None, {"Color": (1, 0.8, 0.9, 1), "Roughness": 0.05}))


def glass(tree):
    return mixed(tree, fresnel(tree, 1.45), tree.node("BsdfRefraction", None, {"IOR": 1.45, "Roughness": 0.0}),
                 tree.node("BsdfGlossy", None, {"Color": (1, 1, 1, 1), "Roughness": 0.0}))


def stripes():
    values = np.ones((64, 64, 4), np.float32)
    is_first = np.arange(64) % 8 < 4
    values[..., 0], values[..., 1] = np.where(is_first, 0.9, 0.2), 0.3
    values[..., 2] = np.where(is_first, 0.8, 0.1)[:, None]
    image = bpy.data.images.new("stripes", 64, 64, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(values.ravel())
    return image


def two_images(tree):
    image = tree.node("TexImage", {"image": stripes()}, {"Vector": tree.uv()})
    colour = tree.node("MixRGB", None, {0: facing(tree, 0.3), 1: (image, 0), 2: (0.05, 0.6, 0.1, 1)})
    return tree.node("BsdfPrincipled", None, {"Base Color": (colour, 0), "Roughness": 0.5})


def several_images(tree):
    image = tree.node("TexImage", {"image": stripes()}, {"Vector": tree.uv()})
    red = tree.node("SeparateColor", None, {0: (image, 0)})
    product = tree.node("Math", {"operation": "MULTIPLY"}, {0: facing(tree, 0.5), 1: (red, 0)})
    colour = ramp(tree, (product, 0), (0.02, 0.02, 0.3, 1), (0.9, 0.1, 0.1, 1), (0.1, 0.9, 0.3, 1))
    return tree.node("BsdfPrincipled", None, {"Base Color": colour, "Roughness": 0.5})


def noise(tree):
    first = ramp(tree, (tree.node("TexNoise", None, {"Scale": 4.0}), 0), (0.9, 0.8, 0.1, 1), (0.1, 0.1, 0.5, 1))
    colour = tree.node("MixRGB", None, {0: facing(tree, 0.4), 1: first, 2: (0.9, 0.9, 0.9, 1)})
    return tree.node("BsdfDiffuse", None, {"Color": (colour, 0)})


def satin(tree):
    return tree.node("BsdfGlossy", None, {"Color": (0.9, 0.9, 0.9, 1), "Roughness": facing(tree, 0.5)})


def veil(tree):
    alpha = tree.node("Math", {"operation": "SUBTRACT"}, {0: 1.0, 1: facing(tree, 0.3)})
    return tree.node("BsdfPrincipled", None, {"Base Color": (0.1, 0.5, 0.2, 1), "Alpha": (alpha, 0)})


MATERIALS = {f.__name__: f for f in (paint, rim, x_ray, two_colours, plastic, bubble, glass, two_images, several_images, noise, satin, veil)}


SHOWN = (("paint", "rim", "x_ray"), ("two_colours", "bubble", "satin"))


def build(make):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if not hasattr(bpy.types.Scene, "covtrace"):
        covtrace_blender.register()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.35, 0.4, 0.5, 1)
    bpy.ops.object.camera_add(location=(0, -6.5, 2.2), rotation=(1.3, 0, 0))
    scene.camera = bpy.context.object
    scene.camera.data.lens = 40
    floor = Tree("floor")
    floor.show(floor.node("TexChecker", None, {"Vector": floor.uv(), "Scale": 16.0, "Color1": (0.7, 0.7, 0.7, 1), "Color2": (0.25, 0.25, 0.25, 1)}))
    bpy.ops.mesh.primitive_plane_add(size=20)
    bpy.context.object.data.materials.append(floor.material)
    bpy.ops.object.light_add(type="AREA", location=(3, -3, 5), rotation=(0.6, 0.4, 0.6))
    bpy.context.object.data.size, bpy.context.object.data.energy = 1.5, 350
    tree = Tree("by angle")
    tree.link(make(tree), 0, tree.tree.nodes["Material Output"].inputs["Surface"])
    bpy.ops.mesh.primitive_uv_sphere_add(location=(-1.25, 0, 1.05), segments=64, ring_count=32)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(tree.material)
    bpy.ops.mesh.primitive_monkey_add(location=(1.25, 0, 1.05))
    bpy.context.object.modifiers.new("smooth", "SUBSURF").render_levels = 2
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(tree.material)
    cycles = scene.cycles
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    for kind in ("max", "diffuse", "glossy", "transmission", "transparent_max"):
        setattr(cycles, f"{kind}_bounces", BOUNCES)
    scene.covtrace.max_depth, cycles.samples, scene.covtrace.samples = BOUNCES, SAMPLES["CYCLES"], SAMPLES["COVTRACE"]


def picture(engine, folder):
    """(h, w, 3) linear, from the top."""
    render = bpy.context.scene.render
    render.engine, render.filepath = engine, os.path.join(folder, engine + ".exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath)
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(HEIGHT, WIDTH, -1)[::-1, :, :3]


def save_png(path, values):
    image = bpy.data.images.new("sheet", values.shape[1], values.shape[0])
    rgba = np.ones((*values.shape[:2], 4), np.float32)
    rgba[..., :3] = to_srgb(values[::-1])
    image.pixels.foreach_set(rgba.ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()


def blocks(values):
    return values.reshape(HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK, 3).mean((1, 3))


def main():
    out = pathlib.Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    rows, sheet = [], {}
    for name in sys.argv[2:] or MATERIALS:
        build(MATERIALS[name])
        with tempfile.TemporaryDirectory() as folder:
            ours, theirs = (picture(engine, folder) for engine in ("COVTRACE", "CYCLES"))
        off = np.abs(blocks(ours) - blocks(theirs))
        light = " ".join(f"{r:.3f}" for r in ours.mean((0, 1)) / theirs.mean((0, 1)))
        rows.append(f"| {name} | {light} | {off.mean() / theirs.mean():.4f} | {off.max():.3f} |")
        np.savez_compressed(out / f"{name}.npz", covtrace=ours, cycles=theirs)
        sheet[name] = np.vstack((ours, theirs))
        save_png(out / f"{name}.png", sheet[name])
    if all(name in sheet for names in SHOWN for name in names):
        save_png(out / "sheet.png", np.vstack([np.hstack([sheet[name] for name in names]) for names in SHOWN]))
    print("| material | light, R G B | mean difference of blocks | largest |\n| --- | --- | --- | --- |")
    print("\n".join(rows), flush=True)
    os._exit(0)  # Blender's own end of the module may be noisy


if __name__ == "__main__":
    main()
