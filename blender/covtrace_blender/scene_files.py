"""A scene as files to keep, which the program renders without Blender: File > Export > covtrace (.pbrt)."""

import os
import re
import shutil

import bpy

from .export_scene import SceneExporter
from .settings import ENGINE
from .warnings_together import together

SCENE = "scene.pbrt"
ESCAPES = str.maketrans({"\\": r"\\", '"': r'\"', "\n": r"\n", "\r": r"\r"})

_wanted = None  # the scene file that a render is to write, in place of its picture
_is_written = False


def is_wanted():
    return _wanted is not None


def _target(filepath):
    """The scene file that a path means; RuntimeError where it names none."""
    path = bpy.path.abspath(filepath)
    if not os.path.basename(path).removesuffix(".pbrt").strip("."):
        raise RuntimeError(f"covtrace: the path '{filepath}' names no file; expected one such as 'scene.pbrt'")
    return bpy.path.ensure_ext(path, ".pbrt")


def write(engine, depsgraph, folder, tell):
    """Writes the scene as a render sees it, by way of an empty folder; gives what it tells. Meshes and images lie in a folder
    of their own beside the scene file, which may be moved together with it."""
    global _is_written
    exporter = SceneExporter(engine, depsgraph, folder, tell)
    exporter.write()
    stem = os.path.splitext(_wanted)[0]
    beside = (os.path.basename(stem) + "-files").translate(ESCAPES)
    names = set(os.listdir(folder)) - {SCENE}
    with open(os.path.join(folder, SCENE), encoding="utf-8") as scene:
        text = re.sub(r'"([^"\n]+)"', lambda quoted: f'"{beside}/{quoted[1]}"' if quoted[1] in names else quoted[0], scene.read())
    if os.path.isdir(_wanted):
        raise RuntimeError(f"covtrace: '{_wanted}' is a folder; expected the name of a file")
    os.makedirs(f"{stem}-files", exist_ok=True)
    for name in names:
        shutil.copy(os.path.join(folder, name), os.path.join(f"{stem}-files", name))
    unfinished = _wanted + ".part"
    with open(unfinished, "w", encoding="utf-8") as kept:
        kept.write(text)
    os.replace(unfinished, _wanted)
    _is_written = True
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
        global _wanted, _is_written
        scene, layer, render = context.scene, context.view_layer, context.scene.render
        # A compositor could write the blank picture over others; a layer that is not ticked would not be rendered.
        settings = [(render, "engine", ENGINE), (render, "use_compositing", False), (render, "use_sequencer", False), (layer, "use", True)]
        before = [(owner, name, getattr(owner, name)) for owner, name, _ in settings]
        try:
            _wanted, _is_written = _target(self.filepath), False
            for owner, name, value in settings:
                setattr(owner, name, value)
            # A render has other subdivision, visibility and instances than viewports show.
            bpy.ops.render.render(scene=scene.name, layer=layer.name)
            if not _is_written:
                raise RuntimeError("covtrace: Blender rendered nothing, and no scene was written")
        except RuntimeError as problem:
            self.report({"ERROR"}, str(problem).strip().removeprefix("Error: "))
            return {"CANCELLED"}
        finally:
            _wanted = None
            for owner, name, value in before:
                setattr(owner, name, value)
        return {"FINISHED"}


def _draw(menu, context):
    menu.layout.operator(ExportScene.bl_idname, text="covtrace (.pbrt)")


def register():
    bpy.utils.register_class(ExportScene)
    bpy.types.TOPBAR_MT_file_export.append(_draw)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(_draw)
    bpy.utils.unregister_class(ExportScene)
