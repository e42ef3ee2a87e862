"""The part of a pbrt file before WorldBegin: the camera of a scene or of a viewport, film, sampler and integrator."""

import math

import numpy as np
from mathutils import Matrix, Vector

from .export_shaders import numbers
from .panorama import is_fisheye, left_out_of_panorama, panorama_text, turned
from .placement import placement
from .shutter import moves_blurred

# Blender's cameras look along -z, pbrt's along +z; both have x to the right and y up.
TURN = Matrix.Diagonal((1, 1, -1, 1))

# Blender's panoramas have -z in the middle and x to the right of it, pbrt's -x and -z; both have y up.
TURN_OF_PANORAMAS = Matrix(((0, 0, 1, 0), (0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 0, 1)))


def _world_to_camera(matrix, turn=TURN):
    return turn @ matrix.normalized().inverted()


def _exposure(scene):
    """The factor on all light that Cycles has among its settings of the film."""
    return getattr(getattr(scene, "cycles", None), "film_exposure", 1.0)


def _aperture(dof):
    """The parameters of its blades, without which it is round."""
    is_polygon = dof.aperture_blades >= 3  # Cycles has no fewer blades
    blades = f' "integer apertureblades" {dof.aperture_blades} "float aperturerotation" {math.degrees(dof.aperture_rotation):.9g}' \
        if is_polygon else ""
    ratio = min(max(dof.aperture_ratio, 1e-3), 1e3)
    return blades + (f' "float apertureratio" {ratio:.9g}' if abs(ratio - 1) > 1e-6 else "")


KINDS = {"PERSP": "perspective", "ORTHO": "orthographic", "PANO": "spherical"}


def _settings(scene):
    chosen = scene.covtrace
    return (f'Sampler "zsobol" "integer pixelsamples" {max(1, round(chosen.samples))}\n'
            f'Integrator "volpath" "integer maxdepth" {chosen.max_depth} "bool channelbychannel" true\n')


class SceneCamera:
    """The camera that a scene renders with. `size`: of the whole frame; `region`: x0, y0, x1, y1 of the pixels that are
    rendered, rows from the bottom, end exclusive."""

    def __init__(self, scene, depsgraph):
        self.scene, self.depsgraph, self._held = scene, depsgraph, None
        render = scene.render
        scale = render.resolution_percentage / 100
        self.size = (max(1, int(render.resolution_x * scale)), max(1, int(render.resolution_y * scale)))
        self.region = self._region(render)

    def _region(self, render):
        """Rounded as Blender does, which makes pictures of this size whether they are cropped or put into the frame
        afterwards."""
        width, height = self.size
        if not render.use_border:
            return 0, 0, width, height
        x0, x1 = int(render.border_min_x * width), int(render.border_max_x * width)
        y0, y1 = int(render.border_min_y * height), int(render.border_max_y * height)
        if x0 >= x1 or y0 >= y1:
            raise RuntimeError("the render region holds no pixel")
        return x0, y0, x1, y1

    def _object(self):
        if self.scene.camera is None:
            raise RuntimeError("covtrace: the scene has no camera")
        if self.scene.camera.type != "CAMERA":
            raise RuntimeError(f"covtrace: the scene's camera, '{self.scene.camera.name}', is of type {self.scene.camera.type}; expected a camera")
        return self.scene.camera.evaluated_get(self.depsgraph)

    def matrix(self):
        """Its place at the time at which the depsgraph stands, or stood at `hold_if_sharp`."""
        return self._held or self._object().matrix_world.copy()

    def from_world(self):
        """(4, 4) from the world to the camera, x to the right, y up and z ahead, without the camera's scale; None without a camera."""
        return np.array(_world_to_camera(self.matrix())) if self.scene.camera else None

    def is_blurred(self):
        """Whether its motion blurs the picture."""
        return moves_blurred(self._object())

    def hold_if_sharp(self):
        """Keeps its place where it is now, unless its motion blurs the picture."""
        self._held = None if self.is_blurred() else self.matrix()

    def _window(self):
        """(x0, x1, y0, y1) of the whole frame, at distance 1 of cameras with a perspective."""
        data = self._object().data
        corners = data.view_frame(scene=self.scene)
        depth = -corners[0].z if data.type == "PERSP" else 1.0
        xs, ys = [c.x / depth for c in corners], [c.y / depth for c in corners]
        return min(xs), max(xs), min(ys), max(ys)

    def pixel(self):
        """(width of a pixel in _window's unit, whether it grows with the distance)."""
        if self.is_panorama():
            return 2 * math.pi / self.size[0], True
        x0, x1, _, _ = self._window()
        return (x1 - x0) / self.size[0], self._object().data.type != "ORTHO"

    def left_out(self):
        """Texts that tell what its lens and film have in Blender and not here."""
        is_glass_clear = self.scene.render.film_transparent and getattr(getattr(self.scene, "cycles", None), "film_transparent_glass", False)
        glass = ["Transparent Glass of the film is left out: glass before it is opaque"] if is_glass_clear else []
        return glass + self._left_out_of_lens()

    def _left_out_of_lens(self):
        data = self._object().data
        return left_out_of_panorama(data) if data.type == "PANO" else []

    def _frame(self):
        """The sides of the frame in one unit, as wide and high as its pixels are."""
        render = self.scene.render
        return self.size[0] * render.pixel_aspect_x, self.size[1] * render.pixel_aspect_y

    def clip_range(self):
        """(Clip Start, Clip End): distances, along the axis of sight but for panoramas."""
        data = self._object().data
        return data.clip_start, data.clip_end

    def is_panorama(self):
        return self._object().data.type == "PANO"

    def rays_to_near(self, count):
        """count x count pairs of a start and a way to Clip Start, in the camera's space, of rays across the whole frame."""
        x0, x1, y0, y1 = self._window()
        near, is_perspective = self._object().data.clip_start, self._object().data.type == "PERSP"
        shares = [k / (count - 1) for k in range(count)]
        for place in (Vector((x0 + s * (x1 - x0), y0 + t * (y1 - y0), 0)) for s in shares for t in shares):
            yield (Vector(), near * (place + Vector((0, 0, -1)))) if is_perspective else (place, Vector((0, 0, -near)))

    def text(self, shutter=None, end=None):
        """shutter: (open, close) in frames; end: its matrix at the closing, where it moves."""
        data = self._object().data
        if data.type not in KINDS:
            raise RuntimeError(f"covtrace: cameras of the type {data.type} are not supported")
        times = f"TransformTimes {shutter[0]:.9g} {shutter[1]:.9g}\n" if shutter else ""
        turn = turned(data, TURN_OF_PANORAMAS) if data.type == "PANO" and not is_fisheye(data) else TURN
        place = placement("Transform", _world_to_camera(self.matrix(), turn), _world_to_camera(end, turn) if end else None)
        parameters = [panorama_text(data, self._frame())] if data.type == "PANO" else [f'"float screenwindow" [{numbers(self._window())}]']
        if data.type == "PERSP":
            parameters.append('"float fov" 90')
        if shutter:
            parameters.append(f'"float shutteropen" {shutter[0]:.9g} "float shutterclose" {shutter[1]:.9g}')
        if data.dof.use_dof and data.type != "PANO":
            parameters.append(self._lens(data, data.type == "PERSP"))
        x0, y0, x1, y1 = self.region
        # The exposure's length is no brightness in Blender.
        iso = 100 / (shutter[1] - shutter[0]) if shutter else 100
        return (times + place + f'Camera "{KINDS[data.type]}" {" ".join(parameters)}\n'
                f'Film "rgb" "integer xresolution" {self.size[0]} "integer yresolution" {self.size[1]} '
                f'"float iso" {iso * _exposure(self.scene):.9g} "integer pixelbounds" [{x0} {x1} {self.size[1] - y1} {self.size[1] - y0}]\n'
                + _settings(self.scene))

    def _lens(self, data, is_perspective):
        distance = data.dof.focus_distance
        if data.dof.focus_object:
            at = data.dof.focus_object.evaluated_get(self.depsgraph).matrix_world.translation
            distance = -(self.matrix().normalized().inverted() @ at).z
        focal_length = data.lens * 1e-3 if is_perspective else 1.0
        radius = focal_length / (2 * max(data.dof.aperture_fstop, 1e-3))
        return f'"float lensradius" {radius:.9g} "float focaldistance" {max(distance, 1e-4):.9g}{_aperture(data.dof)}'


def viewport_text(scene, size, view_matrix, window_matrix):
    """The same for a viewport, all in focus: its matrices are those of the region's 3D view, from the world to the view and on to
    [-1, 1] in x and y."""
    is_perspective = window_matrix[3][3] == 0
    view = view_matrix.copy()
    column = 2 if is_perspective else 3
    window = [(edge + sign * window_matrix[axis][column]) / window_matrix[axis][axis]
              for axis in (0, 1) for edge, sign in ((-1, 1 if is_perspective else -1), (1, 1 if is_perspective else -1))]
    if not is_perspective:
        # Such views show what is behind them, too, as far as their clipping planes reach.
        view = Matrix.Translation((0, 0, -2 / abs(window_matrix[2][2]))) @ view
    fov = '"float fov" 90' if is_perspective else ""
    return (placement("Transform", TURN @ view, None) +
            f'Camera "{"perspective" if is_perspective else "orthographic"}" "float screenwindow" [{numbers(window)}] {fov}\n'
            f'Film "rgb" "integer xresolution" {size[0]} "integer yresolution" {size[1]} '
            f'"float iso" {100 * _exposure(scene):.9g}\n' + _settings(scene))
