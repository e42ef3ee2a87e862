"""Choices of the user: the program (add-on preferences) and how to render (a panel of the scene)."""

import os
import shutil

import bpy

ENGINE = "COVTRACE"

# Panels of other engines that make sense here: all that name EEVEE's or Cycles' companions as compatible.
_WITHOUT = {"RENDER_PT_gpencil", "VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes"}


class CovtracePreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="Program", subtype="FILE_PATH",
        description="The covtrace program; empty: COVTRACE of the environment, else the one in PATH")

    def draw(self, context):
        self.layout.prop(self, "program")


class CovtraceSettings(bpy.types.PropertyGroup):
    method: bpy.props.EnumProperty(
        name="Method", default="hybrid",
        items=[("hybrid", "Hybrid", "Predicted and measured sampling, filters chosen by their error"),
               ("covariance", "Covariance", "Belcour's covariance tracing"),
               ("uniform", "Uniform", "The plain path tracer")])
    samples: bpy.props.FloatProperty(
        name="Samples", default=64, min=0.01, soft_max=4096, description="Average samples per pixel")
    viewport_samples: bpy.props.FloatProperty(
        name="Viewport Samples", default=32, min=0.01, soft_max=1024, description="Average samples per pixel in viewports")
    seconds: bpy.props.FloatProperty(
        name="Time Limit", default=0, min=0, subtype="TIME_ABSOLUTE", unit="TIME_ABSOLUTE",
        description="Seconds for the whole render; 0: none")
    error: bpy.props.FloatProperty(
        name="Error", default=0, min=0, precision=3,
        description="Stop at this estimated relative error of the image; 0: never")
    denoise: bpy.props.BoolProperty(
        name="Denoise", default=True,
        description="Hybrid: Open Image Denoise among the filters, where it is found beside the program")
    max_depth: bpy.props.IntProperty(
        name="Bounces", default=12, min=0, max=1024, description="Most scattering events of a path")
    seed: bpy.props.IntProperty(name="Seed", default=0, min=0)
    threads: bpy.props.IntProperty(name="Threads", default=0, min=0, max=4096,
                                   description="Worker threads; 0: all cores")


class RENDER_PT_covtrace(bpy.types.Panel):
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_label = "covtrace"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("method", "samples", "viewport_samples", "seconds", "error", "denoise", "max_depth", "seed", "threads"):
            layout.prop(context.scene.covtrace, name)
        layout.prop(context.scene.render, "use_motion_blur")
        layout.prop(context.scene.render, "motion_blur_shutter")


CLASSES = (CovtracePreferences, CovtraceSettings, RENDER_PT_covtrace)


def _shared_panels():
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        if "BLENDER_RENDER" in engines and panel.__name__ not in _WITHOUT:
            yield panel


def register():
    bpy.types.Scene.covtrace = bpy.props.PointerProperty(type=CovtraceSettings)
    for panel in _shared_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    for panel in _shared_panels():
        panel.COMPAT_ENGINES.discard(ENGINE)
    del bpy.types.Scene.covtrace


def find_program():
    """The program's path; raises RuntimeError where there is none."""
    addon = bpy.context.preferences.addons.get(__package__)
    wanted = (bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else
              os.environ.get("COVTRACE", "covtrace"))
    program = shutil.which(wanted)
    if not program:
        raise RuntimeError(f"covtrace: the program '{wanted}' was not found; set its path in the add-on's preferences")
    return program
