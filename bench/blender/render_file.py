"""Run by a Python that has bpy: renders one .blend file by both engines, as it is but for its size and samples.

    python bench/blender/render_file.py FILE.blend STEM WIDTH SAMPLES CYCLES_SAMPLES

Writes STEM.json (means of the channels, seconds, warnings, the share of faces that lie on others) and STEM.png: covtrace's
picture on the left, Cycles' on the right, both by the file's own view transform. Cycles denoises and has the bounces of the file; where any mean differs by more than 5 %,
it renders once more with as many bounces as covtrace, without its clamps and its filter of glossy light, which take light away.
Scripts in the file are not run.
"""

import collections
import json
import os
import pathlib
import sys
import tempfile
import time

import bpy
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE.parents[1] / "blender")]
import covtrace_blender
from covtrace_blender import export_scene
from covtrace_blender.warnings_together import together

MOST_SECONDS = 60  # of each picture
TOLERANCE = 0.05


def open_file(file, width):
    """The scene of a file, its frame's longer side of so many pixels."""
    if "cycles" not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module="cycles")
    covtrace_blender.register()
    bpy.ops.wm.open_mainfile(filepath=file, load_ui=False, use_scripts=False)
    scene = bpy.context.scene
    render = scene.render
    share = min(1.0, width / max(render.resolution_x, render.resolution_y))
    render.resolution_x = max(1, round(render.resolution_x * share))
    render.resolution_y = max(1, round(render.resolution_y * share))
    render.resolution_percentage, render.use_sequencer, render.use_file_extension = 100, False, True
    return scene


def pixels_of(path):
    image = bpy.data.images.load(str(path), check_existing=False)
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    return image, values.reshape(*tuple(image.size)[::-1], -1)


def picture(scene, engine, folder):
    """Mean of R, G, B; the picture's bytes as the view transform shows them; seconds."""
    scene.render.engine = engine
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # from Blender 5.0 on
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGBA", "32"
    scene.render.filepath = os.path.join(folder, engine + ".exr")
    before = time.monotonic()
    bpy.ops.render.render(write_still=True)
    seconds = time.monotonic() - before
    image, values = pixels_of(scene.render.filepath)
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "8"
    shown = os.path.join(folder, engine + ".png")
    image.save_render(shown, scene=scene)
    return [float(v) for v in values[..., :3].mean((0, 1), dtype=float)], pixels_of(shown)[1], seconds


def recorded(found):
    """Keeps what exporting tells, and its seconds."""
    write = export_scene.SceneExporter.write

    def timed(exporter):
        before = time.monotonic()
        try:
            return write(exporter)
        finally:
            found["export"] = found.get("export", 0) + time.monotonic() - before
            found["warnings"] = list(dict.fromkeys(found.get("warnings", []) + together(exporter.warnings)))

    export_scene.SceneExporter.write = timed


def doubled_share(depsgraph):
    """The share of the faces of all meshes whose middle is that of another one. Cycles lets such faces shade each other."""
    found = collections.Counter()
    for instance in depsgraph.object_instances:
        if instance.object.type == "MESH":
            matrix = instance.matrix_world
            found.update(tuple(round(v, 3) for v in matrix @ polygon.center) for polygon in instance.object.data.polygons)
    return sum(n for n in found.values() if n > 1) / max(sum(found.values()), 1)


def by_cycles(scene, samples, folder):
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.time_limit = "CPU", samples, MOST_SECONDS
    cycles.use_denoising, cycles.denoiser = True, "OPENIMAGEDENOISE"
    return picture(scene, "CYCLES", folder)


def like_covtrace(scene):
    cycles = scene.cycles
    for kind in ("max", "diffuse", "glossy", "transmission", "volume"):
        setattr(cycles, f"{kind}_bounces", scene.covtrace.max_depth)
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.use_fast_gi = False


def ratios(ours, theirs):
    return [o / t if t > 1e-6 else (1.0 if o < 1e-6 else float("inf")) for o, t in zip(ours, theirs)]


def differs(ours, theirs):
    return max(abs(r - 1) for r in ratios(ours, theirs)) > TOLERANCE


def side_by_side(path, left, right):
    both = np.concatenate([left[..., :3], right[..., :3]], axis=1)
    both = np.concatenate([both, np.ones_like(both[..., :1])], axis=2).astype(np.float32)
    image = bpy.data.images.new("both", both.shape[1], both.shape[0])
    image.pixels.foreach_set(both.ravel())
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()


def main(file, stem, width, samples, cycles_samples):
    scene = open_file(file, int(width))
    found = {"version": list(bpy.data.version), "engine": scene.render.engine}
    recorded(found)
    try:
        if scene.camera is None:
            raise RuntimeError("the file has no camera")
        scene.covtrace.samples, scene.covtrace.seconds = int(samples), MOST_SECONDS
        found["doubled"] = doubled_share(bpy.context.evaluated_depsgraph_get())
        with tempfile.TemporaryDirectory() as folder:
            theirs, right, found["cycles seconds"] = by_cycles(scene, int(cycles_samples), folder)
            ours, left, found["covtrace seconds"] = picture(scene, "COVTRACE", folder)
            found["file's bounces"] = ratios(ours, theirs)
            if differs(ours, theirs):
                like_covtrace(scene)
                theirs, right, _ = by_cycles(scene, int(cycles_samples), folder)
                found["same bounces"] = ratios(ours, theirs)
            found["covtrace"], found["cycles"] = ours, theirs
            side_by_side(stem + ".png", left, right)
    except RuntimeError as problem:
        found["problem"] = str(problem).strip()
    pathlib.Path(stem + ".json").write_text(json.dumps(found))


if __name__ == "__main__":
    main(*sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # the module's own end may take minutes
