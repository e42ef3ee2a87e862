"""Small, very bright lamps far behind what is in focus: discs of light on a dark picture."""

from math import radians, tan
from random import Random

from .camera import Camera
from .loft import smooth_path, tube
from .mesh import Mesh, lathe
from .pbrt_text import SceneText
from .stage import (
    add_image_texture,
    add_mesh,
    add_options,
    add_quad,
    add_quad_light,
    facing_square,
    glossy,
    matt,
    metal,
)
from .wood import write_wood

NAME = "bulbs"
HEADER = """
bulbs: bright bulbs out of focus behind sharp things.
Metres, z up. A vase, a cup and balls stand on a polished table at night; behind them strings of
small bulbs, which few samples of the open lens meet, each of them hundreds to thousands of times
brighter than what lies around.
"""

_CAMERA = Camera(eye=(0.10, -1.05, 0.34), target=(0.02, 0.0, 0.135), fov=25, resolution=(640, 360))
_LENS_RADIUS = 0.03
_FOCUS = (0.0, -0.04, 0.08)
_BULB = 0.009  # radius
_DISC = 1.6  # radiance of a bulb's disc in the image
# Degrees of each string's ends above the horizon, the nearest first.
_STRINGS = (-5.0, -3.1, -1.7, -0.2)

_COLORS = [
    (1.0, 0.56, 0.22),
    (1.0, 0.72, 0.42),
    (1.0, 0.18, 0.06),
    (0.20, 0.75, 0.25),
    (0.25, 0.45, 1.0),
]


def _string(index):
    """Points where the bulbs of one sagging string hang."""
    random = Random(100 + index)
    distance, count = 0.9 + 0.62 * index, 8 + index
    away = distance - _CAMERA.eye[1]
    points = []
    for i in range(count):
        t = (i + 0.5 + random.uniform(-0.2, 0.2)) / count
        sag = 1.9 * (1 - (2 * t - 1) ** 2) + random.uniform(-0.2, 0.2)
        z = _CAMERA.eye[2] + away * tan(radians(_STRINGS[index] - sag))
        points.append((0.86 * away * (t - 0.5), distance, z))
    return points


def _radiance(point):
    """Radiance of a bulb there: its light spread over the circle of confusion leaves _DISC."""
    focus, depth = _CAMERA.depth(_FOCUS), _CAMERA.depth(point)
    confusion = _LENS_RADIUS * (depth / focus - 1)
    return _DISC * (confusion / _BULB) ** 2


def _smooth_lathe(profile, segments=64, steps=8):
    path = smooth_path([(r, z, 0.0) for r, z in profile], steps)
    return lathe([(max(r, 1e-4), z) for r, z, _ in path], segments)


def _vase():
    outside = [(0.001, 0.0), (0.034, 0.0), (0.036, 0.006), (0.050, 0.035), (0.060, 0.075)]
    outside += [(0.050, 0.115), (0.026, 0.150), (0.019, 0.175), (0.024, 0.198), (0.034, 0.210)]
    inside = [(0.031, 0.211), (0.021, 0.198), (0.015, 0.175), (0.012, 0.150)]
    return _smooth_lathe([*outside, *inside])


def _cup():
    outside = [(0.001, 0.0), (0.024, 0.0), (0.026, 0.004), (0.036, 0.020)]
    outside += [(0.042, 0.050), (0.044, 0.072)]
    inside = [(0.041, 0.073), (0.039, 0.050), (0.033, 0.020), (0.020, 0.008), (0.001, 0.006)]
    return _smooth_lathe([*outside, *inside])


def _handle():
    bow = [(0.037, 0.060), (0.058, 0.062), (0.068, 0.044), (0.058, 0.024), (0.036, 0.018)]
    return tube(smooth_path([(x, 0.0, z) for x, z in bow], 8), 0.0048, 16)


def _add_things(scene, folder):
    scene.comment("What is in focus.")
    with scene.attributes():
        scene.plain("Translate", -0.075, 0.02, 0)
        add_mesh(scene, folder, "vase", glossy([0.03, 0.16, 0.20], 0.0), _vase())
    with scene.attributes():
        scene.plain("Translate", 0.085, -0.03, 0)
        scene.plain("Rotate", -25, 0, 0, 1)
        china = glossy([0.70, 0.66, 0.58], 0.02)
        add_mesh(scene, folder, "cup", china, _cup())
        add_mesh(scene, folder, "handle", china, _handle())
    for x, y, radius, material in (
        (0.005, -0.10, 0.020, metal("Cu", 0.05)),
        (0.175, 0.06, 0.032, metal("Ag", 0.0)),
        (-0.175, -0.05, 0.024, ("dielectric", {"float eta": 1.5})),
    ):
        with scene.attributes():
            scene.plain("Translate", x, y, radius)
            scene.entity("Material", *material)
            scene.entity("Shape", "sphere", {"float radius": radius})


def _add_strings(scene, folder):
    scene.comment("The bulbs and their wires.")
    wires = Mesh()
    random = Random(7)
    for index in range(len(_STRINGS)):
        points = _string(index)
        hung = [(x, y, z + 0.012) for x, y, z in points]
        wires.append(tube(smooth_path(hung, 4), 0.002, 8))
        for point in points:
            color = _COLORS[0] if random.random() < 0.45 else random.choice(_COLORS)
            with scene.attributes():
                scene.plain("Translate", *point)
                radiance = [_radiance(point) * channel for channel in color]
                scene.entity("AreaLightSource", "diffuse", {"rgb L": radiance})
                scene.entity("Shape", "sphere", {"float radius": _BULB})
    add_mesh(scene, folder, "wires", matt([0.03, 0.03, 0.03]), wires)


def write(folder):
    """Writes the scene and its assets."""
    (folder / "textures").mkdir()
    (folder / "meshes").mkdir()
    walnut = (0.020, 0.009, 0.004), (0.16, 0.075, 0.032)
    write_wood(folder / "textures" / "walnut.png", 512, 256, *walnut, 8, 19)
    scene = SceneText(HEADER)
    lens = {"float lensradius": _LENS_RADIUS, "float focaldistance": _CAMERA.depth(_FOCUS)}
    add_options(scene, NAME, _CAMERA, 6, lens)
    scene.plain("WorldBegin")
    scene.entity("LightSource", "infinite", {"rgb L": [0.012, 0.016, 0.028]})
    with scene.attributes():
        scene.comment("A weak lamp on the left.")
        square = facing_square((-0.8, -0.7, 0.9), (0, 0, 0.1), 0.22)
        add_quad_light(scene, [26.0, 21.0, 15.0], square)
    scene.comment("The table, and a wall far behind.")
    add_image_texture(scene, "walnut")
    table = {"texture reflectance": "walnut", "float roughness": 0.08}
    scene.entity("Material", "coateddiffuse", table)
    corners = [(-1.0, -1.2, 0), (1.0, -1.2, 0), (1.0, 0.55, 0), (-1.0, 0.55, 0)]
    add_quad(scene, corners, [0, 0, 4, 0, 4, 6, 0, 6])
    scene.entity("Material", *matt([0.10, 0.085, 0.09]))
    add_quad(scene, [(-5, 3.6, -2), (5, 3.6, -2), (5, 3.6, 3), (-5, 3.6, 3)])
    _add_things(scene, folder)
    _add_strings(scene, folder)
    scene.write(folder / "scene.pbrt")
