"""Renders Blender's scenes with covtrace: docs/guide/blender.md."""

bl_info = {
    "name": "covtrace",
    "author": "The covtrace authors",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Render Engine",
    "description": "Covariance tracing renderer",
    "category": "Render",
}

import bpy

from . import engine, preview_session, scene_files, settings

CLASSES = (*settings.CLASSES, engine.CovtraceEngine)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    settings.register()
    scene_files.register()


def unregister():
    preview_session.stop_all()
    scene_files.unregister()
    settings.unregister()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
