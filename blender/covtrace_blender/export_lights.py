"""Lamps. Blender's watts are radiometric: a point lamp of W watts has W / (4 pi) watts per steradian."""

import math

import bpy
import mathutils
import numpy as np

from .export_shaders import numbers
from .lamp_emission import LampEmission
from .placement import placement, with_extent
from .visibility import has_extent, hidden_from


# Kinds of lamps that are shapes, which may move while the shutter is open.
MAY_MOVE = ("POINT", "AREA")
# Radians. Wider spreads of area lamps take nothing from their light; narrower ones are a beam, which no sampling of places finds.
MOST_SPREAD, LEAST_SPREAD = math.radians(179.9), math.radians(1)
LEAST_MOVING_RADIUS = 1e-3  # of points that move: there is no other light without extent that does


def lit_matrix(lamp):
    """The function that gives a matrix of the lamp's object with an extent along all axes, or None where it does not shine: as in
    Cycles points shine on objects of any scale, and others along the z axis, if there is one."""
    def of_point(matrix):
        return with_extent(matrix) or mathutils.Matrix.Translation(matrix.translation)

    def of_area(matrix):
        is_dark = bpy.app.version >= (4, 0, 0) and any(column.xyz.length == 0 for column in matrix.col[:3])
        return None if is_dark else with_extent(matrix)  # Cycles 3.4 shines without an extent along z, 4.5 does not

    def of_others(matrix):
        return with_extent(matrix) if matrix.col[2].xyz.length > 0 else None

    return {"POINT": of_point, "AREA": of_area}.get(lamp.type, of_others)


def write_lamp(out, lamp, matrix, end, hidden, images, warn):
    """One lamp; `matrix`: of its object; `end`: the same when the shutter closes, or None where it stays; `hidden`: the kinds of
    rays that do not find it; `images`: PhotometricImages. Rays pass a lamp, as in Cycles."""
    scale = [max(matrix.col[axis].xyz.length, 1e-12) for axis in range(3)]
    if lamp.type == "SPOT" and bpy.app.version < (4, 0, 0):  # Cycles 3.4 takes nothing of a spot's scale, 4.5 does
        scale = [1.0, 1.0, 1.0]
    has_radius = lamp.type in ("POINT", "SPOT") and (lamp.shadow_soft_size > 0 or end is not None)
    for colour, image in images.emission(LampEmission(lamp, images, _directions(lamp, scale, has_radius), warn)):
        _write_light(out, lamp, matrix, end, hidden, images, [c * shaded for c, shaded in zip(_power(lamp), colour)], image, scale, has_radius)


def _write_light(out, lamp, matrix, end, hidden, images, colour, image, scale, has_radius):
    """One light of a lamp: watts per channel, and the image of LampEmission; scale: of its object, as far as it counts; has_radius: whether
    it is a ball."""
    is_spot = lamp.type == "SPOT"
    if max(colour) <= 0 or lamp.type == "AREA" and _area(_corners(lamp)) == 0:
        return
    if lamp.type == "AREA" and image is not None:  # which has its colour in the image
        colour, image = [max(colour)] * 3, image * (np.array(colour) / max(colour))
    if lamp.type != "AREA":  # no other lamp grows with its object
        matrix, end = matrix.normalized(), end and end.normalized()
    out.write("AttributeBegin\n" + placement("ConcatTransform", matrix, end))
    if lamp.type == "SUN":
        # Blender's sun shines along -z of its object.
        out.write(f'LightSource "distant" "point3 from" [0 0 1] "point3 to" [0 0 0] "rgb L" [{numbers(colour)}] '
                  f'"float angle" {math.degrees(lamp.angle):.9g}{hidden_from(hidden) if has_extent(lamp) else ""}\n')
    elif lamp.type == "AREA":
        _write_area(out, lamp, colour, hidden, images.write(image) if image is not None else None)
    else:
        cone = ""
        if is_spot:
            outer = lamp.spot_size / 2
            inner = math.acos(math.cos(outer) + (1 - math.cos(outer)) * lamp.spot_blend)
            cone = f' "float coneangle" {math.degrees(outer):.9g} "float conedeltaangle" {math.degrees(max(outer - inner, 0)):.9g}'
            out.write("Rotate 180 1 0 0\n")  # cones lie about +z
        if has_radius:
            if is_spot:
                cone += f' "float conestretch" [{numbers((scale[0] / scale[2], scale[1] / scale[2]))}]'
            if image is not None:
                cone += f' "string goniometricfilename" "{images.write(image)}"'
            _write_ball(out, lamp, max(lamp.shadow_soft_size, 0 if end is None else LEAST_MOVING_RADIUS), colour, cone, hidden)
        else:
            if is_spot:
                out.write(f"Scale {numbers(scale)}\n")
            kind = "goniometric" if image is not None else "spot" if is_spot else "point"
            file = f' "string filename" "{images.write(image)}"' if image is not None else ""
            out.write(f'LightSource "{kind}" "rgb I" [{numbers(c / (4 * math.pi) for c in colour)}]{file}{cone}\n')
    out.write("AttributeEnd\n")


def _directions(lamp, scale, has_radius):
    """The directions of LampEmission. Cycles takes the normal of the light into the lamp's space as a surface's: times the scale."""
    if lamp.type == "AREA":
        return None
    if lamp.type == "SUN":
        return np.array((0.0, 0.0, -1.0))
    if lamp.type == "POINT":
        return np.diag(scale)
    # Spots are written upside down, those without radius in a space that is scaled with them.
    return np.diag(np.array(scale) ** (1 if has_radius else 2) * (1, -1, -1))


def _power(lamp):
    """Watts, W / m^2 of a sun, per channel: energy times the lamp's own colours. Blender before 4.5 has no exposure, temperature and
    normalization."""
    strength = lamp.energy * 2 ** getattr(lamp, "exposure", 0)
    if not getattr(lamp, "normalize", True):
        strength *= _size(lamp) or 1
    warmth = lamp.temperature_color if getattr(lamp, "use_temperature", False) else (1, 1, 1)
    return [c * w * strength for c, w in zip(lamp.color, warmth)]


def _size(lamp):
    """The unit of an energy that is not normalized: the lamp's surface, m^2, and a sun's projected solid angle."""
    if lamp.type == "AREA":
        return _area(_corners(lamp))
    if lamp.type == "SUN":
        return math.pi * math.sin(lamp.angle / 2) ** 2
    return 4 * math.pi * lamp.shadow_soft_size**2


def _write_ball(out, lamp, radius, colour, cone, hidden):
    soft = ' "bool softfalloff" true' if bpy.app.version >= (4, 0, 0) and lamp.use_soft_falloff else ""
    radiance = numbers(c / (4 * math.pi * math.pi * radius**2) for c in colour)
    out.write(f'AreaLightSource "diffuse" "rgb L" [{radiance}] "bool letslightpass" true{soft}{cone}\n'
              f'Shape "sphere" "float radius" {radius:.9g}{hidden_from(hidden)}\n')


def _corners(lamp):
    """(x, y) of an area lamp's border, anticlockwise seen from +z."""
    width = lamp.size
    height = lamp.size if lamp.shape in ("SQUARE", "DISK") else lamp.size_y
    if lamp.shape in ("DISK", "ELLIPSE"):
        return [(0.5 * width * math.cos(a), 0.5 * height * math.sin(a)) for a in (2 * math.pi * k / 64 for k in range(64))]
    return [(-0.5 * width, -0.5 * height), (0.5 * width, -0.5 * height), (0.5 * width, 0.5 * height), (-0.5 * width, 0.5 * height)]


def _area(corners):
    return 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, corners[1:] + corners[:1]))


def _write_area(out, lamp, colour, hidden, file):
    """file: of an image that multiplies the colour, the same in all channels then; or None.

    Shines along -z of its object, from one side, with the radiance W / (pi area); in Cycles 3.4 W / (4 area) (measured)."""
    corners, grid, gain = _corners(lamp), "", 1
    width, height = (2 * max(abs(corner[axis]) for corner in corners) for axis in (0, 1))
    uvs = numbers(v for x, y in corners for v in (x / width + 0.5, y / height + 0.5))
    spread = max(lamp.spread, LEAST_SPREAD)
    if spread < MOST_SPREAD:
        # As much light as without a grid: the integral of sin cos (1 - tan / tan(half)) over the angle.
        half = 0.5 * spread
        gain = math.tan(half) / (math.tan(half) - half)
        grid = f' "float gridangle" {math.degrees(half):.9g}'
        out.write("Rotate 180 1 0 0\n")  # grids lie about +z
        corners = [(x, -y) for x, y in corners]
    solid_angle = math.pi if bpy.app.version >= (4, 2, 0) else 4  # of those between 3.4 and 4.2 none was measured
    radiance = [c * gain / (solid_angle * abs(_area(corners))) for c in colour]
    points = numbers(v for x, y in corners for v in (x, y, 0))
    # Clockwise seen from +z of the object, so that the front looks along -z.
    indices = " ".join(f"0 {k + 1} {k}" for k in range(1, len(corners) - 1))
    light = f'"rgb L" [{numbers(radiance)}]' if file is None else f'"float scale" {radiance[0]:.9g} "string filename" "{file}"'
    pattern = "" if file is None else f' "point2 uv" [{uvs}]'
    out.write(f'AreaLightSource "diffuse" {light} "bool letslightpass" true{grid}\n'
              f'Shape "trianglemesh" "point3 P" [{points}] "integer indices" [{indices}]{pattern}{hidden_from(hidden)}\n')


def area_scale(lamp, matrix):
    """Factor on a lamp's radiance where its object is scaled: the power stays, the area grows; without normalization both grow."""
    if not getattr(lamp, "normalize", True):
        return 1
    return 1 / max(abs(matrix.col[0].xyz.length * matrix.col[1].xyz.length), 1e-12) if lamp.type == "AREA" else 1


class ScaledLamp:
    """A lamp as it is on an object with a matrix: with its energy for an area of unit scale, and of a sun what comes to the scene of its colour
    by `reach`."""

    def __init__(self, lamp, matrix, reach):
        self._lamp, self.energy = lamp, lamp.energy * area_scale(lamp, matrix)
        self.color = [c * r for c, r in zip(lamp.color, reach if lamp.type == "SUN" else (1, 1, 1))]

    def __getattr__(self, name):
        return getattr(self._lamp, name)
