"""The preview in a viewport: follows its view and the scene, and draws the newest image."""

import tempfile
import weakref

import bpy
import gpu
from gpu_extras.presets import draw_texture_2d

from . import settings
from .export_camera import viewport_text
from .export_scene import SceneExporter
from .preview_session import PreviewSession, View

SECONDS_BETWEEN_LOOKS = 0.05


class Viewport:
    """One viewport of the engine `engine`, which draws it again when there is a new image."""

    def __init__(self, engine):
        self._session = PreviewSession(settings.find_program())
        self._engine = weakref.ref(engine)
        # Blender lets go of the engine where a viewport is closed or shows something else, and forbids its __del__ to
        # look at it.
        weakref.finalize(engine, self._session.stop)
        self._is_changed, self._content, self._around, self._key = True, None, "", None
        self._drawn, self._texture, self._warnings, self._failure = 0, None, [], ""
        look = weakref.WeakMethod(self._look)

        def timer():
            method = look()
            return None if method is None else method()

        bpy.app.timers.register(timer)

    def change(self):
        """The scene is another one."""
        self._is_changed = True

    def _look(self):
        """Asks for a redraw where there is a new image, or what changed waits for its turn."""
        try:
            if self._session.version != self._drawn or (self._is_changed and not self._session.is_waiting()):
                self._engine().tag_redraw()
        except (AttributeError, ReferenceError):
            return None  # the engine is gone
        return SECONDS_BETWEEN_LOOKS

    def draw(self, context, depsgraph):
        self._follow(context, depsgraph)
        session, region = self._session, context.region
        if session.version != self._drawn:
            self._drawn = session.version
            if session.image is not None:
                self._texture = _texture(session.image)
        if self._texture is not None:
            gpu.state.blend_set("ALPHA_PREMULT")
            self._engine().bind_display_space_shader(depsgraph.scene)
            draw_texture_2d(self._texture, (0, 0), region.width, region.height)
            self._engine().unbind_display_space_shader()
            gpu.state.blend_set("NONE")
        state = self._failure or session.failure or ("rendering" if session.is_busy else "done")
        # The log of a render has all of them.
        self._engine().update_stats("", "; ".join([state, *self._warnings[:1]]))

    def _follow(self, context, depsgraph):
        """Asks for an image where the view or the scene has changed; one change waits while the last one has no image."""
        if self._session.is_waiting():
            return
        scene, seen, region = depsgraph.scene, context.region_data, context.region
        chosen = scene.covtrace
        pixel = int(scene.render.preview_pixel_size) if scene.render.preview_pixel_size != "AUTO" else 1
        size = (max(1, region.width // pixel), max(1, region.height // pixel))
        options = ["--method", chosen.method, "--spp", repr(chosen.viewport_samples), "--seed", str(chosen.seed)]
        if not chosen.denoise:
            options += ["--denoiser", "none"]
        elif chosen.method == "hybrid":
            # A view has often changed before high quality, which takes several times as long, is there
            options += ["--denoiser-quality", "fast"]
        if chosen.threads > 0:
            options += ["--threads", str(chosen.threads)]
        text = viewport_text(scene, size, seen.view_matrix, seen.window_matrix)
        key = (text, options)
        if key == self._key and not self._is_changed:
            return
        self._key = key
        if self._is_changed:
            self._is_changed = False
            self._export(depsgraph)
        if self._content is None:
            return
        folder, content = self._content
        # Other media around the eye are not found here.
        self._session.show(View(self._around + text, folder.name, content, size, options, keep=folder))

    def _export(self, depsgraph):
        """Writes the scene; where it cannot be written nothing new is shown until it changes."""
        folder = tempfile.TemporaryDirectory(prefix="covtrace-view-")
        exporter = SceneExporter(None, depsgraph, folder.name)
        self._content, self._failure = None, ""
        try:
            self._content = folder, exporter.write_content()
            self._around = exporter.medium_everywhere()
        except (RuntimeError, OSError) as problem:
            self._failure = str(problem)
        self._warnings = exporter.warnings


def _texture(image):
    height, width, _ = image.shape
    buffer = gpu.types.Buffer("FLOAT", image.size, image.ravel())
    return gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
