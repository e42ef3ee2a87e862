"""The render engine: exports the scene, runs the program beside Blender, reads the layers back."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback

import bpy
import numpy as np

from . import export_scene, layers, scene_files, settings, shadow_catchers, viewport
from .warnings_together import together

# Passes beside the image: (name as covtrace's Blender layer names have it, channels, their names, type).
PASSES = (
    ("Depth", 1, "Z", "VALUE"),
    ("Denoising Normal", 3, "XYZ", "VECTOR"),
    ("Denoising Albedo", 3, "RGB", "COLOR"),
    ("Noisy Image", 3, "RGB", "COLOR"),
    ("variance", 3, "RGB", "COLOR"),
    ("error", 1, "X", "VALUE"),
    ("Debug Sample Count", 1, "X", "VALUE"),
    ("density", 1, "X", "VALUE"),
    ("filter", 3, "XYZ", "VECTOR"),
)


# Those that a view layer asks for: (its switch, the pass, covtrace's layer).
PASSES_ON_DEMAND = (
    ("use_pass_normal", ("Normal", 3, "XYZ", "VECTOR"), "N"),
    ("use_pass_position", ("Position", 3, "XYZ", "VECTOR"), "P"),
)

# The same by covtrace's own names.
LAYERS = "Z,N,albedo,raw,variance,error,samples"
PREDICTED_LAYERS = "density,filter"  # not of uniform, where naming them would be a warning

SECONDS_BETWEEN_LINES = 1


def passes_of(view_layer):
    return [render_pass for switch, render_pass, _ in PASSES_ON_DEMAND if getattr(view_layer, switch)]


def passes_without_counterpart(view_layer):
    """Names of the switches of those that a view layer asks for."""
    known = {"use_pass_combined", "use_pass_z", "use_pass_cryptomatte_accurate"} | {switch for switch, *_ in PASSES_ON_DEMAND}
    return [p.name for p in view_layer.bl_rna.properties
            if p.identifier.startswith("use_pass_") and p.identifier not in known and getattr(view_layer, p.identifier)]


def _set_pixels(render_pass, pixels):
    """`pixels`: a row for each. Blender 3.4 counts the rows, newer versions the numbers."""
    try:
        render_pass.rect.foreach_set(pixels)
    except TypeError:
        render_pass.rect.foreach_set(pixels.reshape(-1))


def _is_command_line_render():
    """Whether Blender's own options render (blender -b scene.blend -f 1), not a script, which gets an exception."""
    options = sys.argv[:sys.argv.index("--")] if "--" in sys.argv else sys.argv
    return bpy.app.background and bool(bpy.app.binary_path) and \
        not {"-f", "--render-frame", "-a", "--render-anim"}.isdisjoint(options)


class CovtraceEngine(bpy.types.RenderEngine):
    bl_idname = settings.ENGINE
    bl_label = "covtrace"
    bl_use_preview = False
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True

    def update_render_passes(self, scene=None, renderlayer=None):
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for name, channels, letters, kind in (*PASSES, *passes_of(renderlayer)):
            self.register_pass(scene, renderlayer, name, channels, letters, kind)

    def render(self, depsgraph):
        scene = depsgraph.scene
        try:
            with tempfile.TemporaryDirectory(prefix="covtrace-") as folder:
                if scene_files.is_wanted():
                    self._write_files(depsgraph, folder)
                else:
                    self._render(depsgraph, scene, folder)
        except (RuntimeError, OSError) as problem:
            self._give_blank(depsgraph)
            self._fail(str(problem))
        except Exception as problem:  # a defect of the add-on: Blender would go on with a blank picture
            traceback.print_exc()
            self._give_blank(depsgraph)
            self._fail(f"{type(problem).__name__}: {problem}")

    # -- viewport

    _viewport = None

    def view_update(self, context, depsgraph):
        if self._viewport is not None:
            self._viewport.change()

    def view_draw(self, context, depsgraph):
        try:
            if self._viewport is None:
                self._viewport = viewport.Viewport(self)
            self._viewport.draw(context, depsgraph)
        except (RuntimeError, OSError) as problem:
            self.update_stats("", str(problem))

    # -- images

    def _give_blank(self, depsgraph):
        """Hands back a blank picture. Blender 5 crashes where it writes all layers of none."""
        render = depsgraph.scene.render
        size = (max(1, side * render.resolution_percentage // 100) for side in (render.resolution_x, render.resolution_y))
        self.end_result(self.begin_result(0, 0, *size, layer=depsgraph.view_layer.name))

    def _fail(self, text):
        self.report({"ERROR"}, text)
        self.error_set(text)
        if _is_command_line_render():
            # Blender would write the blank picture, and its exit code know nothing of it.
            print("covtrace:", text, file=sys.stderr)
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(1)

    def _write_files(self, depsgraph, folder):
        for text in scene_files.write(self, depsgraph, folder, self._tell):
            self.report({"WARNING"}, text)
        self._give_blank(depsgraph)

    def _render(self, depsgraph, scene, folder):
        program = settings.find_program()
        self._tell("exporting the scene")
        layer = depsgraph.view_layer
        told, found, region = [], {}, None
        pictures = shadow_catchers.pictures(depsgraph)
        for number, picture in enumerate(pictures):
            self._done, self._share = number / len(pictures), 1 / len(pictures)
            own_folder = os.path.join(folder, picture or "whole")
            os.mkdir(own_folder)
            exporter = export_scene.SceneExporter(self, depsgraph, own_folder, self._tell, picture)
            file = exporter.write()
            region = exporter.camera.region
            missing = passes_without_counterpart(layer)
            if missing:
                exporter.warn(f"passes that have no counterpart: {', '.join(missing)}")
            for text in together(exporter.warnings):
                if text not in told:
                    self.report({"WARNING"}, text)
                    told.append(text)
            image = os.path.join(own_folder, "image.exr")
            code = self._run(self._command(program, file, image, scene.covtrace, layer, scene.covtrace.seconds * self._share))
            if os.path.exists(image):
                found[picture] = self._with_alpha(layers.read(image))
            if code != 0:
                break
        # A cancelled render shows what there is.
        if code in (0, 6) and shadow_catchers.MATTE in found:
            found = {None: self._composed(found)}
        if None in found:
            self._show(found[None], region, layer)
        elif code == 6:
            self._give_blank(depsgraph)  # cancelled before there was anything to see
        if code not in (0, 6):
            raise RuntimeError(f"covtrace: {self._last_error or f'it ended with exit code {code}'}")

    @staticmethod
    def _command(program, file, image, chosen, layer, seconds):
        """seconds: the most that it may render, 0 without a limit."""
        layer_names = LAYERS if chosen.method == "uniform" else f"{LAYERS},{PREDICTED_LAYERS}"
        if layer.use_pass_position:
            layer_names += ",P"
        command = [program, "render", file, "-o", image, "--method", chosen.method, "--progress", "json",
                   "--layer-names", "blender", "--layers", layer_names, "--seed", str(chosen.seed)]
        # Whichever comes first; a view layer's own samples go before those of the panel.
        command += ["--spp", repr(float(layer.samples) or chosen.samples)]
        if seconds > 0:
            command += ["--time", f"{seconds:.3f}"]
        if chosen.error > 0 and chosen.method != "covariance":
            command += ["--error", repr(chosen.error)]
        if not chosen.denoise:
            command += ["--denoiser", "none"]
        if chosen.threads > 0:
            command += ["--threads", str(chosen.threads)]
        return command

    @staticmethod
    def _with_alpha(channels):
        """Pictures have alpha where nothing is seen behind what they show."""
        if "ViewLayer.Combined.A" not in channels:
            channels["ViewLayer.Combined.A"] = np.ones_like(channels["ViewLayer.Combined.R"])
        return channels

    @staticmethod
    def _composed(found):
        """The channels of the matte, with the image that is composed of all pictures."""
        names = [f"ViewLayer.Combined.{letter}" for letter in "RGBA"]
        image = shadow_catchers.composed({picture: layers.pixels(channels, names) for picture, channels in found.items()})
        return {**found[shadow_catchers.MATTE], **{name: image[..., k] for k, name in enumerate(names)}}

    def _run(self, command):
        """The program's exit code; shows its progress, and interrupts it where Blender is asked to stop."""
        self._last_error = ""
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True, errors="replace")
        reader = threading.Thread(target=self._follow, args=(process.stderr,), daemon=True)
        reader.start()
        self._progress, self._next_line = None, 0
        stopped = False
        while True:
            try:
                process.wait(0.1)
                break
            except subprocess.TimeoutExpired:
                pass
            if not stopped and self._is_stopped():
                process.send_signal(signal.SIGINT)
                stopped = True
            self._show_progress()
        reader.join(5)
        return process.returncode

    def _is_stopped(self):
        return self.test_break()

    def _follow(self, stream):
        """On a thread of its own: keeps the last progress and the last message."""
        with stream:
            for line in stream:
                try:
                    self._progress = json.loads(line)
                except ValueError:
                    if line.strip():
                        self._last_error = line.strip()
                        print("covtrace:", line.strip())

    def _show_progress(self):
        p = self._progress
        if not p:
            return
        self.update_progress(self._done + self._share * p["fraction"])
        # Without a window each text is a line of the log.
        now = time.monotonic()
        if bpy.app.background and now < self._next_line:
            return
        self._next_line = now + SECONDS_BETWEEN_LINES
        text = f"{p['phase']}, {p['spp']:.1f} samples"
        if p.get("error"):
            text += f", error {p['error']:.3g}"
        self._tell(text)

    def _tell(self, text):
        self.update_stats("", text)

    def _show(self, channels, region, layer):
        for _, (name, *_), own in PASSES_ON_DEMAND:
            own = "Denoising Normal" if own == "N" else own
            for letter in "XYZ":
                if f"ViewLayer.{own}.{letter}" in channels:
                    channels[f"ViewLayer.{name}.{letter}"] = channels[f"ViewLayer.{own}.{letter}"]
        x0, y0, x1, y1 = region
        result = self.begin_result(0, 0, x1 - x0, y1 - y0, layer=layer.name)
        for render_pass in result.layers[0].passes:
            planes = [channels.get(f"ViewLayer.{render_pass.name}.{letter}") for letter in render_pass.channel_id]
            if any(plane is None for plane in planes):
                continue  # the method has no such layer
            pixels = np.stack(planes, axis=-1).reshape(-1, len(planes))
            _set_pixels(render_pass, np.ascontiguousarray(pixels, dtype=np.float32))
        self.end_result(result)
