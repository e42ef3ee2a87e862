"""A scene as files to keep, which the program renders without Blender: File > Export > covtrace (.pbrt)."""

import os
import re
import shutil

import bpy

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


class ExportScene(bpy.types.Operator):
    """Write the current frame as a scene file, with its meshes and images beside it"""
    bl_idname = "export_scene.covtrace"
    bl_label = "Export covtrace"

    filepath: bpy.props.StringProperty(subtype="FILE_PATH", description="The scene file")
    filter_glob: bpy.props.StringProperty(default="*.pbrt", options={"HIDDEN"})

    def invoke(self, context, event):
        self.filepath = os.path.splitext(bpy.data.filepath or "scene")[0] + ".pbrt"
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        global _wanted
        scene, render = context.scene, context.scene.render
        # A compositor could write the blank picture over others.
        settings = {"engine": ENGINE, "use_compositing": False, "use_sequencer": False}
        before = {name: getattr(render, name) for name in settings}
        _wanted = bpy.path.ensure_ext(bpy.path.abspath(self.filepath), ".pbrt")
        for name, value in settings.items():
            setattr(render, name, value)
        try:
            # A render has other subdivision, visibility and instances than viewports show.
            bpy.ops.render.render(scene=scene.name, layer=context.view_layer.name)
        except RuntimeError as problem:
            self.report({"ERROR"}, str(problem).strip())
            return {"CANCELLED"}
        finally:
            _wanted = None
            for name, value in before.items():
                setattr(render, name, value)
        return {"FINISHED"}


def _draw(menu, context):
    menu.layout.operator(ExportScene.bl_idname, text="covtrace (.pbrt)")


def register():
    bpy.utils.register_class(ExportScene)
    bpy.types.TOPBAR_MT_file_export.append(_draw)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(_draw)
    bpy.utils.unregister_class(ExportScene)
