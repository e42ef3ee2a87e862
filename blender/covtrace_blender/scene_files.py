"""A scene as files to keep, which the program renders without Blender: File > Export > covtrace (.pbrt)."""

import os
import re
import shutil

import bpy
from bpy_extras.io_utils import ExportHelper

from .export_scene import SceneExporter
from .settings import ENGINE
from .warnings_together import together

SCENE = "scene.pbrt"

_wanted = None  # the scene file that a render is to write, in place of its picture


def is_wanted():
    return _wanted is not None


def write(engine, depsgraph, folder, tell):
    """Writes the scene as a render sees it, by way of an empty folder; gives what it tells. Meshes and images lie in a folder
    of their own beside the scene file, which may be moved together with it."""
    exporter = SceneExporter(engine, depsgraph, folder, tell)
    exporter.write()
    stem = os.path.splitext(_wanted)[0]
    beside = os.path.basename(stem) + "-files"
    names = set(os.listdir(folder)) - {SCENE}
    with open(os.path.join(folder, SCENE), encoding="utf-8") as scene:
        text = re.sub(r'"([^"\n]+)"', lambda quoted: f'"{beside}/{quoted[1]}"' if quoted[1] in names else quoted[0], scene.read())
    os.makedirs(f"{stem}-files", exist_ok=True)
    for name in names:
        shutil.copy(os.path.join(folder, name), os.path.join(f"{stem}-files", name))
    unfinished = _wanted + ".part"
    with open(unfinished, "w", encoding="utf-8") as kept:
        kept.write(text)
    os.replace(unfinished, _wanted)
    return together(exporter.warnings)


class ExportScene(bpy.types.Operator, ExportHelper):
    """Write the current frame as a scene file, with its meshes and images beside it"""
    bl_idname = "export_scene.covtrace"
    bl_label = "Export covtrace"
    filename_ext = ".pbrt"
    filter_glob: bpy.props.StringProperty(default="*.pbrt", options={"HIDDEN"})

    def execute(self, context):
        global _wanted
        scene, before = context.scene, context.scene.render.engine
        _wanted = bpy.path.ensure_ext(bpy.path.abspath(self.filepath), self.filename_ext)
        scene.render.engine = ENGINE
        try:
            # A render has other subdivision, visibility and instances than viewports show.
            bpy.ops.render.render(scene=scene.name, layer=context.view_layer.name)
        except RuntimeError as problem:
            self.report({"ERROR"}, str(problem).strip())
            return {"CANCELLED"}
        finally:
            _wanted, scene.render.engine = None, before
        return {"FINISHED"}


def _draw(menu, context):
    menu.layout.operator(ExportScene.bl_idname, text="covtrace (.pbrt)")


def register():
    bpy.utils.register_class(ExportScene)
    bpy.types.TOPBAR_MT_file_export.append(_draw)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(_draw)
    bpy.utils.unregister_class(ExportScene)
