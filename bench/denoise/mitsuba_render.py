"""Renders the scenes of mitsuba_scenes.py. Run by a Python that has `mitsuba` (pip install mitsuba):

    python bench/denoise/mitsuba_render.py FOLDER NAME FILTER halves SAMPLES SEED IMAGE.exr
    python bench/denoise/mitsuba_render.py FOLDER NAME FILTER single SAMPLES SEED IMAGE.exr

`halves` is one render, of more than 256 samples the mean of several. `single` is the mean of SAMPLES renders of one sample, with the layer `variance`: that of the mean,
from their spread. Textures are written to FOLDER. Several jobs may follow each other, separated by `+`. Files that are there
are kept. Prints one line for each image that it makes. Where DRJIT_LIBLLVM_PATH names LLVM's library (16 or newer), Mitsuba
compiles its path tracer, which is then eight times as fast, with other random numbers."""
import os
import pathlib
import sys
import time

if "--help" in sys.argv:  # before what only that Python has
    print(__doc__)
    sys.exit()
import mitsuba as mi
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mitsuba_scenes  # noqa: E402
from render_jobs import jobs  # noqa: E402

mi.set_variant("llvm_ad_rgb" if os.environ.get("DRJIT_LIBLLVM_PATH") else "scalar_rgb")
MOST = 256  # samples per pixel of one render, whose paths are in memory at once


def load(folder, name, pixel_filter):
    mi.file_resolver().append(str(folder))
    return mi.load_string(mitsuba_scenes.xml_of(name, pixel_filter))


def layers(scene):
    """The film's pixels and the names of their channels."""
    bitmap = scene.sensors()[0].film().bitmap(raw=False)
    return np.array(bitmap), [field.name for field in bitmap.struct_()]


def write(pixels, names, file):
    bitmap = mi.Bitmap(np.ascontiguousarray(pixels, np.float32), mi.Bitmap.PixelFormat.MultiChannel, names)
    partial = file.with_suffix(".partial.exr")
    bitmap.write(str(partial))
    partial.replace(file)


def render(scene, samples, seed, file):
    total, parts = 0, max(1, samples // MOST)
    for k in range(parts):
        mi.render(scene, spp=samples // parts, seed=1000 * seed + k)
        pixels, names = layers(scene)
        total = total + pixels.astype(np.float64)
    write(total / parts, names, file)


def render_single(scene, samples, seed, file):
    """One image with the variance of its pixels, from renders of one sample each."""
    total = squares = 0
    for k in range(samples):
        mi.render(scene, spp=1, seed=1000 * seed + k)
        pixels, names = layers(scene)
        total, squares = total + pixels, squares + pixels.astype(np.float64)**2
    mean = total / samples
    colours = [names.index(c) for c in "RGB"]
    spread = np.maximum(0, squares / samples - mean.astype(np.float64)**2)[..., colours] / (samples - 1)
    write(np.concatenate([mean, spread], 2), names + [f"variance.{c}" for c in "RGB"], file)


def main():
    scenes = {}
    for folder, name, pixel_filter, kind, samples, seed, out in jobs(sys.argv[1:]):
        file = pathlib.Path(out)
        if file.exists():
            continue
        if not scenes:
            mitsuba_scenes.write_textures(folder)
        if (name, pixel_filter) not in scenes:
            scenes[name, pixel_filter] = load(folder, name, pixel_filter)
        start = time.monotonic()
        make = render if kind == "halves" else render_single
        make(scenes[name, pixel_filter], int(samples), int(seed), file)
        print(f"{file.name}  {time.monotonic() - start:.1f} s", flush=True)
    os._exit(0)  # Mitsuba may hang where Python ends it


if __name__ == "__main__":
    main()
