"""Run by Blender's Python: renders one scene of scenes.py by both engines, and writes images and times.

    python bench/blender/render.py SCENE FOLDER WIDTH HEIGHT REFERENCE_SAMPLES

FOLDER gets SCENE.npz: (rows, columns, 3) images from the top by `ENGINE SAMPLES`; `seconds ENGINE SAMPLES`: user seconds of
this process and of the program that it runs. With one thread each, so that they say how long it takes.
"""

import os
import pathlib
import sys
import tempfile

import bpy
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "blender")]
import covtrace_blender
import scenes

SAMPLES = {"covtrace": (4, 16, 64), "cycles": (8, 32, 128, 512)}


def user_seconds():
    times = os.times()
    return np.array([times.user, times.children_user])


def picture(folder):
    """The image that was rendered and the user seconds that it took."""
    scene = bpy.context.scene
    scene.render.threads_mode, scene.render.threads, scene.covtrace.threads = "FIXED", 1, 1
    scene.render.filepath = os.path.join(folder, "image.exr")
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "ZIP"
    before = user_seconds()
    bpy.ops.render.render(write_still=True)
    seconds = user_seconds() - before
    image = bpy.data.images.load(scene.render.filepath)
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(*tuple(image.size)[::-1], -1)[::-1, :, :3].copy()
    bpy.data.images.remove(image)
    return values, seconds


def covtrace(samples, folder, is_reference=False):
    scene = bpy.context.scene
    scene.render.engine = "COVTRACE"
    scene.covtrace.samples, scene.covtrace.method = samples, "uniform" if is_reference else "hybrid"
    scene.covtrace.seed = 1 if is_reference else 0
    return picture(folder)


def cycles(samples, folder, is_reference=False):
    """As people set it: adaptive sampling, Open Image Denoise, and Cycles' own values but for as many bounces of each kind as
    covtrace has; its 4 diffuse ones make rooms darker. The reference is without the clamps, which do so, too."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples, cycles.seed = samples, 1 if is_reference else 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = scene.covtrace.max_depth
    cycles.use_adaptive_sampling = cycles.use_denoising = not is_reference
    if not is_reference:
        cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.sample_clamp_indirect, cycles.blur_glossy = (0, 0) if is_reference else (10, 1)
    return picture(folder)


def main(name, folder, width, height, reference_samples):
    if "cycles" not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module="cycles")
    covtrace_blender.register()
    scenes.build(name, int(width), int(height))
    found = {}
    with tempfile.TemporaryDirectory() as work:
        for engine in (covtrace, cycles):
            engine(1, work)  # what is loaded, and baked, once
            for samples in SAMPLES[engine.__name__]:
                found[f"{engine.__name__} {samples}"], found[f"seconds {engine.__name__} {samples}"] = engine(samples, work)
            found[f"{engine.__name__} reference"], _ = engine(int(reference_samples), work, True)
    np.savez_compressed(os.path.join(folder, name + ".npz"), **found)


main(*sys.argv[1:])
sys.stdout.flush()
os._exit(0)  # the module's own end may take minutes
