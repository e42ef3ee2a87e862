"""Installs the add-on's archive in Blender, as a user does, and renders Blender's cube with it.

    blender --background --factory-startup -noaudio --python-exit-code 1 --python packaging/check_extension.py -- ARCHIVE

or by a Python that has Blender's module bpy. COVTRACE names the program. Blender's folder for its user's files
(BLENDER_USER_RESOURCES, before 4.2 BLENDER_USER_SCRIPTS) has to be an empty one.
"""
import array
import os
import pathlib
import sys
import tempfile

import bpy


def install(archive):
    """The name by which Blender knows the add-on from then on."""
    if bpy.app.version >= (4, 2, 0):
        bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
        return "bl_ext.user_default.covtrace"
    bpy.ops.preferences.addon_install(filepath=archive)
    bpy.ops.preferences.addon_enable(module="covtrace_blender")
    return "covtrace_blender"


def render():
    """The mean of the picture's colours, once it is read back from its file."""
    scene = bpy.context.scene
    scene.render.engine = "COVTRACE"
    scene.covtrace.samples = 4
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "image.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        values = array.array("f", bytes(4 * len(image.pixels)))
        image.pixels.foreach_get(values)
    size = tuple(image.size)
    if size != (64, 36):
        raise SystemExit(f"check_extension: the picture has {size} pixels")
    return sum(sum(values[i::4]) for i in range(3)) / (3 * size[0] * size[1])


def main(archive):
    bpy.ops.wm.read_factory_settings()
    name = install(archive)
    if name not in bpy.context.preferences.addons:
        raise SystemExit(f"check_extension: Blender {bpy.app.version_string} has not enabled {name}")
    installed = pathlib.Path(sys.modules[name].__file__)
    if pathlib.Path(__file__).resolve().parents[1] in installed.resolve().parents:
        raise SystemExit(f"check_extension: {installed} is the source, not what was installed")
    light = render()
    # The cube, the lamp and the grey world of Blender's first scene.
    if not 0.01 < light < 10:
        raise SystemExit(f"check_extension: the picture's mean is {light}")
    print(f"Blender {bpy.app.version_string}: {name} rendered, mean {light:.3f}", flush=True)


main(sys.argv[sys.argv.index("--") + 1] if "--" in sys.argv else sys.argv[1])
