"""Lamps. Blender's watts are radiometric: a point lamp of W watts has W / (4 pi) watts per steradian."""

import math

import bpy

from .shader_nodes.blackbody import blackbody, blackbody_temperature
from .export_shaders import numbers
from .visibility import has_extent, hidden_from


# Kinds of lamps that are shapes, which may move while the shutter is open.
MAY_MOVE = ("POINT", "AREA")
# Radians. Wider spreads of area lamps take nothing from their light; narrower ones are a beam, which no sampling of places finds.
MOST_SPREAD, LEAST_SPREAD = math.radians(179.9), math.radians(1)
LEAST_MOVING_RADIUS = 1e-3  # of points that move: there is no other light without extent that does


def write_lamp(out, lamp, transform, hidden, warn, moves=False):
    """One lamp; `transform`: text that places its object (no scale in it matters but an area's); `hidden`: the kinds of rays
    that do not find it; `moves`: whether the transform does. Rays pass a lamp, as in Cycles."""
    colour = [c * shaded for c, shaded in zip(_power(lamp), _shader_colour(lamp, warn))]
    if max(colour) <= 0:
        return
    out.write("AttributeBegin\n" + transform)
    if lamp.type == "SUN":
        # Blender's sun shines along -z of its object.
        out.write(f'LightSource "distant" "point3 from" [0 0 1] "point3 to" [0 0 0] "rgb L" [{numbers(colour)}] '
                  f'"float angle" {math.degrees(lamp.angle):.9g}{hidden_from(hidden) if has_extent(lamp) else ""}\n')
    elif lamp.type == "AREA":
        _write_area(out, lamp, colour, hidden)
    elif lamp.type == "SPOT":
        outer = lamp.spot_size / 2
        inner = math.acos(math.cos(outer) + (1 - math.cos(outer)) * lamp.spot_blend)
        cone = f'"float coneangle" {math.degrees(outer):.9g} "float conedeltaangle" {math.degrees(max(outer - inner, 0)):.9g}'
        if lamp.shadow_soft_size > 0:
            out.write("Rotate 180 1 0 0\n")  # cones of shapes lie about +z
            _write_ball(out, lamp, lamp.shadow_soft_size, colour, cone, hidden)
        else:
            intensity = numbers(c / (4 * math.pi) for c in colour)
            out.write(f'LightSource "spot" "point3 from" [0 0 0] "point3 to" [0 0 -1] "rgb I" [{intensity}] {cone}\n')
    elif lamp.shadow_soft_size > 0 or moves:
        _write_ball(out, lamp, max(lamp.shadow_soft_size, LEAST_MOVING_RADIUS if moves else 0), colour, "", hidden)
    else:
        out.write(f'LightSource "point" "rgb I" [{numbers(c / (4 * math.pi) for c in colour)}]\n')
    out.write("AttributeEnd\n")


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
    out.write(f'AreaLightSource "diffuse" "rgb L" [{radiance}] "bool letslightpass" true{soft} {cone}\n'
              f'Shape "sphere" "float radius" {radius:.9g}{hidden_from(hidden)}\n')


def _shader_colour(lamp, warn):
    """Colour by which the lamp's nodes multiply its power."""
    if not lamp.use_nodes or not lamp.node_tree:
        return (1, 1, 1)
    output = lamp.node_tree.get_output_node("CYCLES")
    return _emitted(output.inputs["Surface"], lamp, warn) if output else (0, 0, 0)


def _emitted(socket, lamp, warn):
    """Colour that the tree of shaders at a socket emits: of each Emission the share that mixtures leave it."""
    shader = socket.links[0].from_node if socket.is_linked else None
    while shader is not None and shader.type == "REROUTE":
        socket = shader.inputs[0]
        shader = socket.links[0].from_node if socket.is_linked else None
    if shader is None:
        return (0, 0, 0)
    if shader.type in ("MIX_SHADER", "ADD_SHADER"):
        first, second = (_emitted(part, lamp, warn) for part in shader.inputs[-2:])
        if shader.type == "ADD_SHADER":
            return tuple(a + b for a, b in zip(first, second))
        _tell_linked(shader.inputs[0], lamp, warn)
        share = min(max(shader.inputs[0].default_value, 0), 1)
        return tuple((1 - share) * a + share * b for a, b in zip(first, second))
    if shader.type != "EMISSION":
        if shader.type.startswith("BSDF_"):
            return (0, 0, 0)
        warn(f"lamp '{lamp.name}': its shader '{shader.name}' is not supported; its own colour and power are used")
        return (1, 1, 1)
    colour = tuple(shader.inputs["Color"].default_value)[:3]
    for socket in shader.inputs:
        temperature = blackbody_temperature(socket)
        if temperature is not None:
            colour = blackbody(temperature)
        else:
            _tell_linked(socket, lamp, warn)
    strength = shader.inputs["Strength"].default_value
    return tuple(c * strength for c in colour)


def _tell_linked(socket, lamp, warn):
    if socket.is_linked:
        warn(f"lamp '{lamp.name}': what is linked to '{socket.name}' of its shader is not supported; "
             "the socket's own value is used")


def _corners(lamp):
    """(x, y) of an area lamp's border, anticlockwise seen from +z."""
    width = lamp.size
    height = lamp.size if lamp.shape in ("SQUARE", "DISK") else lamp.size_y
    if lamp.shape in ("DISK", "ELLIPSE"):
        return [(0.5 * width * math.cos(a), 0.5 * height * math.sin(a)) for a in (2 * math.pi * k / 64 for k in range(64))]
    return [(-0.5 * width, -0.5 * height), (0.5 * width, -0.5 * height), (0.5 * width, 0.5 * height), (-0.5 * width, 0.5 * height)]


def _area(corners):
    return 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, corners[1:] + corners[:1]))


def _write_area(out, lamp, colour, hidden):
    """Shines along -z of its object, from one side, with the radiance W / (pi area); in Cycles 3.4 W / (4 area) (measured)."""
    corners, grid, gain = _corners(lamp), "", 1
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
    out.write(f'AreaLightSource "diffuse" "rgb L" [{numbers(radiance)}] "bool letslightpass" true{grid}\n'
              f'Shape "trianglemesh" "point3 P" [{points}] "integer indices" [{indices}]{hidden_from(hidden)}\n')


def area_scale(lamp, matrix):
    """Factor on a lamp's radiance where its object is scaled: the power stays, the area grows; without normalization both grow."""
    if not getattr(lamp, "normalize", True):
        return 1
    return 1 / max(abs(matrix.col[0].xyz.length * matrix.col[1].xyz.length), 1e-12) if lamp.type == "AREA" else 1
