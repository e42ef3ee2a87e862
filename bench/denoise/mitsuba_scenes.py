"""Scenes for Mitsuba 3 as XML texts, all our own: what is hard for denoisers, in small rooms.

`SCENES` names them. `xml_of(name, filter)` is the text; the textures that it names are written beside it by
`write_textures(folder)`, as binary PPM, which need no library."""
import math
import pathlib

WIDTH, HEIGHT = 128, 96
TEXTURE = 256  # texels along a side


def rgb(name, r, g, b):
    return f'<rgb name="{name}" value="{r} {g} {b}"/>'


def diffuse(r, g, b):
    return f'<bsdf type="twosided"><bsdf type="diffuse">{rgb("reflectance", r, g, b)}</bsdf></bsdf>'


def textured(inner):
    return f'<bsdf type="twosided"><bsdf type="diffuse">{inner}</bsdf></bsdf>'


def checkers(name, dark, light, u, v):
    return (f'<texture type="checkerboard" name="{name}">{rgb("color0", *dark)}{rgb("color1", *light)}'
            f'<transform name="to_uv"><scale x="{u}" y="{v}"/></transform></texture>')


def bitmap(name, file, times=1):
    return (f'<texture type="bitmap" name="{name}"><string name="filename" value="{file}"/>'
            f'<transform name="to_uv"><scale x="{times}" y="{times}"/></transform></texture>')


def metal(material, alpha):
    return (f'<bsdf type="twosided"><bsdf type="roughconductor"><string name="material" value="{material}"/>'
            f'<float name="alpha" value="{alpha}"/></bsdf></bsdf>')


GLASS = '<bsdf type="dielectric"/>'


def plastic(r, g, b):
    return f'<bsdf type="plastic">{rgb("diffuse_reflectance", r, g, b)}</bsdf>'


def area(r, g, b):
    return f'<emitter type="area">{rgb("radiance", r, g, b)}</emitter>'


def ball(x, y, z, radius, inner):
    return f'<shape type="sphere"><point name="center" x="{x}" y="{y}" z="{z}"/><float name="radius" value="{radius}"/>{inner}</shape>'


def block(x, y, z, size, turned, inner):
    sx, sy, sz = size
    return (f'<shape type="cube"><transform name="to_world"><scale x="{sx / 2}" y="{sy / 2}" z="{sz / 2}"/>'
            f'<rotate y="1" angle="{turned}"/><translate x="{x}" y="{y}" z="{z}"/></transform>{inner}</shape>')


def plate(place, axis, angle, size, inner):
    """A rectangle, turned about an axis out of the plane that looks along +z."""
    x, y, z = place
    return (f'<shape type="rectangle"><transform name="to_world"><scale x="{size[0] / 2}" y="{size[1] / 2}"/>'
            f'<rotate {axis}="1" angle="{angle}"/><translate x="{x}" y="{y}" z="{z}"/></transform>{inner}</shape>')


def room(back, floor=(0.5, 0.45, 0.4), left=(0.7, 0.2, 0.15), right=(0.2, 0.6, 0.25), front=True):
    """Four metres wide, two high, from z = -1.5 to 4."""
    walls = [plate((0, 0, 1.25), "x", -90, (4, 5.5), diffuse(*floor)), plate((0, 2, 1.25), "x", 90, (4, 5.5), diffuse(0.8, 0.8, 0.8)),
             plate((0, 1, -1.5), "y", 0, (4, 2), back), plate((-2, 1, 1.25), "y", 90, (5.5, 2), diffuse(*left)),
             plate((2, 1, 1.25), "y", -90, (5.5, 2), diffuse(*right))]
    if front:
        walls.append(plate((0, 1, 4), "y", 180, (4, 2), diffuse(0.6, 0.6, 0.6)))
    return "".join(walls)


def camera(origin, target, fov, lens=""):
    kind = "thinlens" if lens else "perspective"
    return (kind, f'<float name="fov" value="{fov}"/>{lens}<transform name="to_world"><lookat origin="{origin}" target="{target}" '
                  'up="0, 1, 0"/></transform>')


def interior():
    """A matt room, lit through its ceiling, with a gold block."""
    return camera("0, 1, 3.9", "0, 1, 0", 45), 8, room(diffuse(0.6, 0.6, 0.55)) + "".join([
        plate((0, 1.99, 0.3), "x", 90, (0.9, 0.7), area(18, 16, 13)), block(-0.7, 0.6, -0.4, (0.7, 1.2, 0.7), 20, metal("Au", 0.15)),
        block(0.6, 0.35, 0.3, (0.7, 0.7, 0.7), -18, diffuse(0.7, 0.7, 0.7))])


def indirect():
    """The lamp shines at the ceiling alone: all other light is from there. A mirror and a textured wall."""
    return camera("0, 1, 3.9", "0, 1, 0", 45), 10, room(textured(checkers("reflectance", (0.15, 0.2, 0.4), (0.7, 0.7, 0.6), 16, 8))) + "".join([
        plate((-1.1, 1.3, -0.6), "x", -90, (0.4, 0.4), area(60, 52, 40)), ball(0.7, 0.45, -0.3, 0.45, metal("Al", 0.05)),
        ball(-0.5, 0.35, 0.5, 0.35, plastic(0.3, 0.2, 0.6))])


def caustic():
    """Glass under a small lamp: caustics that few paths find, and few of them twice."""
    return camera("0, 1.1, 3.9", "0, 0.7, 0", 42), 10, room(diffuse(0.55, 0.55, 0.6)) + "".join([
        ball(0.4, 1.7, 0.4, 0.12, area(90, 80, 62)), ball(-0.6, 0.45, 0.2, 0.45, GLASS), ball(0.6, 0.3, 0.9, 0.3, GLASS),
        block(0.5, 0.5, -0.7, (0.6, 1, 0.6), 25, metal("Cu", 0.08))])


def glossy():
    """Metal plates of four roughnesses under four lamps from small and bright to large and dim."""
    shapes = [plate((0, -0.3, 0), "x", -90, (20, 20), diffuse(0.4, 0.4, 0.4)), plate((0, 0, -4), "y", 0, (20, 20), diffuse(0.3, 0.3, 0.35))]
    for k, (y, z, alpha) in enumerate([(0.0, 2.2, 0.01), (0.3, 1.0, 0.05), (0.8, -0.2, 0.1), (1.5, -1.4, 0.2)]):
        shapes.append(plate((0, y, z), "x", -70 + 8 * k, (4, 0.9), metal("Cr", alpha)))
    for k, (x, radius) in enumerate([(-1.8, 0.05), (-0.6, 0.15), (0.6, 0.3), (1.8, 0.5)]):
        light = 1.2 / radius**2
        shapes.append(ball(x, 3.2, -1.5, radius, area(light, light * (0.6 + 0.1 * k), light * (1 - 0.2 * k))))
    return camera("0, 2, 8", "0, 1.4, 0", 40), 5, "".join(shapes)


def lens():
    """Balls before and behind the focus of a wide lens, on small checkers, under a sky and a low sun."""
    thin = '<float name="aperture_radius" value="0.12"/><float name="focus_distance" value="6"/>'
    sky = f'<emitter type="constant">{rgb("radiance", 0.35, 0.45, 0.65)}</emitter>'
    shapes = [sky, ball(-14, 9, 8, 3.5, area(19, 15.5, 10.5)),
              plate((0, 0, 0), "x", -90, (16, 16), textured(checkers("reflectance", (0.1, 0.12, 0.15), (0.7, 0.65, 0.5), 12, 12)))]
    for x, z, radius, inner in [(-2.2, 0, 0.9, plastic(0.8, 0.2, 0.1)), (0, 0, 0.9, GLASS), (2.2, 0, 0.9, metal("Cu", 0.1)),
                                (-1.2, -3, 0.9, diffuse(0.2, 0.5, 0.8)), (1.3, 2, 0.5, plastic(0.1, 0.6, 0.2))]:
        shapes.append(ball(x, radius, z, radius, inner))
    return camera("0, 2.2, 6", "0, 0.7, 0", 40, thin), 8, "".join(shapes)


def textures():
    """Fine textures on all that is seen, one of them cut out of leaves of a screen before the wall."""
    cut = ('<bsdf type="mask">' + bitmap("opacity", "holes.ppm", 3) + diffuse(0.35, 0.5, 0.2) + "</bsdf>")
    return camera("0, 1, 3.9", "0, 0.9, 0", 45), 8, "".join([
        plate((0, 1, -1.5), "y", 0, (4, 2), textured(bitmap("reflectance", "cells.ppm", 2))),
        plate((0, 0, 1.25), "x", -90, (4, 5.5), textured(bitmap("reflectance", "waves.ppm", 4))),
        plate((0, 2, 1.25), "x", 90, (4, 5.5), diffuse(0.8, 0.8, 0.8)), plate((-2, 1, 1.25), "y", 90, (5.5, 2), diffuse(0.6, 0.55, 0.5)),
        plate((2, 1, 1.25), "y", -90, (5.5, 2), diffuse(0.6, 0.6, 0.6)), plate((0.9, 0.6, -0.3), "y", -20, (1.2, 1.2), cut),
        plate((-0.2, 1.99, 0.6), "x", 90, (0.5, 0.5), area(30, 28, 24)),
        ball(-0.7, 0.5, 0.1, 0.5, '<bsdf type="roughplastic"><float name="alpha" value="0.1"/>' + bitmap("diffuse_reflectance", "cells.ppm", 3)
             + "</bsdf>")])


def bulb():
    """A dark room with one small lamp in view, and a mirror that shows it again."""
    return camera("0, 1, 3.9", "0, 1, 0", 45), 10, room(diffuse(0.25, 0.22, 0.2), (0.2, 0.18, 0.16), (0.3, 0.1, 0.08), (0.1, 0.2, 0.25)) + "".join([
        ball(-0.9, 1.35, -0.5, 0.04, area(900, 700, 420)), plate((1.0, 1, -1.3), "y", -20, (0.9, 1.2), metal("Al", 0.02)),
        block(-0.6, 0.3, 0.2, (0.6, 0.6, 0.6), 30, diffuse(0.5, 0.5, 0.5)), ball(0.5, 0.3, 0.6, 0.3, plastic(0.5, 0.3, 0.1))])


SCENES = {f.__name__: f for f in (interior, indirect, caustic, glossy, lens, textures, bulb)}


def xml_of(name, pixel_filter):
    """The scene as a text for `mi.load_string`, with the layers that `covtrace denoise` reads."""
    (kind, sensor), depth, shapes = SCENES[name]()
    film = (f'<film type="hdrfilm"><integer name="width" value="{WIDTH}"/><integer name="height" value="{HEIGHT}"/>'
            '<string name="pixel_format" value="rgb"/><string name="component_format" value="float32"/>'
            f'<rfilter type="{pixel_filter}"/></film>')
    return ('<scene version="3.0.0"><integrator type="aov"><string name="aovs" value="albedo:albedo,nn:sh_normal,dd:depth"/>'
            f'<integrator type="path"><integer name="max_depth" value="{depth}"/></integrator></integrator>'
            f'<sensor type="{kind}">{sensor}<sampler type="independent"/>{film}</sensor>{shapes}</scene>')


def write_ppm(file, value):
    """Writes the texels `value(u, v)`, three numbers in [0, 1], u and v in [0, 1)."""
    texels = bytearray()
    for y in range(TEXTURE):
        for x in range(TEXTURE):
            texels += bytes(round(255 * min(1, max(0, c))) for c in value(x / TEXTURE, y / TEXTURE))
    file.write_bytes(f"P6 {TEXTURE} {TEXTURE} 255\n".encode() + texels)


def cells(u, v):
    """Crooked stripes of two colours with dark joints."""
    bent = u + 0.03 * math.sin(6 * math.tau * v)
    joint = min(abs((8 * bent) % 1 - 0.5), abs((12 * v) % 1 - 0.5)) < 0.06
    tone = 0.5 + 0.5 * math.sin(math.tau * (5 * u + 3 * v))
    return (0.08, 0.07, 0.06) if joint else (0.35 + 0.45 * tone, 0.3 + 0.2 * tone, 0.6 - 0.35 * tone)


def waves(u, v):
    tone = 0.5 + 0.25 * math.sin(math.tau * (9 * u + math.sin(3 * math.tau * v))) + 0.25 * math.sin(math.tau * 17 * v)
    return (0.15 + 0.6 * tone, 0.12 + 0.5 * tone, 0.1 + 0.3 * tone)


def holes(u, v):
    open_here = math.sin(math.tau * 2 * u) * math.sin(math.tau * 2 * v) > 0.25
    return (0, 0, 0) if open_here else (1, 1, 1)


def write_textures(folder):
    for value in (cells, waves, holes):
        write_ppm(pathlib.Path(folder) / f"{value.__name__}.ppm", value)
