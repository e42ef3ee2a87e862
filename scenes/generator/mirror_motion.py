"""Motion seen in mirrors: moving things before a still mirror, still things in a moving one."""

from math import cos, pi, sin

from .ball_decals import write_spotted
from .camera import Camera
from .loft import tube
from .mesh import Mesh, grid, lathe, rounded_prism
from .pbrt_text import SceneText
from .stage import (
    add_floor,
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

NAME = "mirror-motion"
HEADER = """
mirror-motion: motion that reaches the camera by way of mirrors.
Metres, z up. A pinwheel turns and a ball falls before a flat mirror, and each is seen
twice. The round mirror on the right turns itself, so that the still posts in it blur, and not those
beside it. One square light, dim sky, no lens.
"""

_CAMERA = Camera(eye=(0.25, -5.4, 1.75), target=(0.12, 0.3, 0.83), fov=27, resolution=(640, 360))
_MIRROR = (-0.35, 1.5)  # x, y of the flat mirror's middle
_HALF_WIDTH, _BOTTOM, _TOP = 1.45, 0.16, 1.86
_VANES = 8


def _bar(low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    outline = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    return rounded_prism(outline, z0, z1, 0.02, lambda x, y, z: (x + z, y + z))


def _frame():
    """Four bars around the mirror."""
    width = 0.09
    x0, x1 = _MIRROR[0] - _HALF_WIDTH, _MIRROR[0] + _HALF_WIDTH
    y0, y1 = _MIRROR[1] - 0.05, _MIRROR[1] + 0.05
    mesh = Mesh()
    for low, high in (
        ((x0 - width, y0, 0.0), (x0, y1, _TOP + width)),
        ((x1, y0, 0.0), (x1 + width, y1, _TOP + width)),
        ((x0, y0, _TOP), (x1, y1, _TOP + width)),
        ((x0, y0, _BOTTOM - width), (x1, y1, _BOTTOM)),
    ):
        mesh.append(_bar(low, high))
    return mesh


def _vanes(first):
    """Every other bent sheet of the pinwheel, in the plane of x and z, its hollow towards +y."""
    mesh = Mesh()
    for vane in range(first, _VANES, 2):
        rows = []
        for i in range(9):
            radius = 0.05 + 0.40 * i / 8
            row = []
            for j in range(9):
                angle = 2 * pi * (vane + 0.95 * j / 8) / _VANES
                lift = 0.16 * (radius / 0.45) * (j / 8) ** 2
                row.append((radius * cos(angle), lift, radius * sin(angle)))
            rows.append(row)
        mesh.append(grid(rows, [[(0, 0)] * 9] * 9))
    return mesh


def _add_pinwheel(scene, folder):
    scene.comment("The pinwheel turns by 55 degrees.")
    x, y, z = -0.98, 0.25, 1.02
    stick = tube([(x, y - 0.03, 0.0), (x, y - 0.03, z)], 0.02)
    add_mesh(scene, folder, "stick", glossy([0.50, 0.34, 0.18], 0.2), stick)
    with scene.attributes():
        scene.plain("Translate", x, y, z)
        scene.moving([("Rotate", 10, 0, 1, 0)], [("Rotate", 65, 0, 1, 0)])
        add_mesh(scene, folder, "vanes-red", matt([0.62, 0.04, 0.03]), _vanes(0))
        add_mesh(scene, folder, "vanes-yellow", matt([0.75, 0.52, 0.06]), _vanes(1))
        hub = tube([(0, -0.04, 0), (0, 0.06, 0)], 0.045)
        add_mesh(scene, folder, "hub", metal("CuZn", 0.05), hub)


def _add_ball(scene):
    scene.comment("The ball falls by 0.42 m and spins.")
    with scene.attributes():
        scene.moving(
            [("Translate", -0.02, -0.1, 1.02)],
            [("Translate", 0.04, -0.1, 0.60), ("Rotate", 60, 1, 0.3, 0)],
        )
        add_image_texture(scene, "spots")
        coat = {"texture reflectance": "spots", "float roughness": 0.02}
        scene.entity("Material", "coateddiffuse", coat)
        scene.entity("Shape", "sphere", {"float radius": 0.24})


def _add_round_mirror(scene, folder):
    scene.comment("The round mirror turns by 3 degrees.")
    foot = [(0.26, 0.0), (0.26, 0.02), (0.05, 0.05), (0.025, 0.10), (0.025, 0.34)]
    with scene.attributes():
        scene.plain("Translate", 1.52, 0.12, 0)
        add_mesh(scene, folder, "foot", metal("CuZn", 0.1), lathe(foot, 48))
        scene.plain("Translate", 0, 0, 0.86)
        scene.moving([("Rotate", -30, 0, 0, 1)], [("Rotate", -33, 0, 0, 1)])
        ring = [(0.54 * cos(a), 0.0, 0.54 * sin(a)) for a in (pi * k / 36 for k in range(73))]
        add_mesh(scene, folder, "ring", metal("CuZn", 0.1), tube(ring, 0.03, 16))
        scene.plain("Rotate", 90, 1, 0, 0)
        scene.entity("Material", *metal("Ag"))
        scene.entity("Shape", "disk", {"float radius": 0.53})


# Position, height, first and second colour of the still posts; the first four only mirrors show.
_POSTS = [
    ((-1.7, -2.5), 1.7, (0.70, 0.66, 0.58), (0.03, 0.13, 0.34)),
    ((-2.35, -2.0), 1.5, (0.70, 0.66, 0.58), (0.45, 0.03, 0.03)),
    ((-2.9, -1.2), 1.6, (0.70, 0.66, 0.58), (0.02, 0.22, 0.09)),
    ((-1.0, -3.2), 1.4, (0.70, 0.66, 0.58), (0.30, 0.14, 0.02)),
    ((0.78, 0.75), 1.25, (0.70, 0.66, 0.58), (0.03, 0.13, 0.34)),
    ((2.18, 0.55), 1.45, (0.70, 0.66, 0.58), (0.45, 0.03, 0.03)),
]


def _add_posts(scene, folder):
    scene.comment("Still posts.")
    for i, ((x, y), height, first, second) in enumerate(_POSTS):
        name = f"stripes-{i + 1}"
        stripes = {"float uscale": 2, "float vscale": round(height / 0.14)}
        colors = {"rgb tex1": first, "rgb tex2": second}
        scene.entity("Texture", [name, "spectrum", "checkerboard"], {**stripes, **colors})
        post = lathe([(0.11, 0.0), (0.11, height), (1e-4, height + 0.06)], 40)
        with scene.attributes():
            scene.plain("Translate", x, y, 0)
            paint = ("diffuse", {"texture reflectance": name})
            add_mesh(scene, folder, f"post-{i + 1}", paint, post)


def write(folder):
    """Writes the scene and its assets."""
    (folder / "textures").mkdir()
    (folder / "meshes").mkdir()
    write_spotted(folder / "textures" / "spots.png", (0.03, 0.20, 0.42), (0.82, 0.62, 0.10))
    oak = (0.16, 0.085, 0.04), (0.46, 0.29, 0.155)
    write_wood(folder / "textures" / "oak.png", 512, 256, *oak, 7, 5)
    scene = SceneText(HEADER)
    shutter = {"float shutteropen": 0, "float shutterclose": 1}
    add_options(scene, NAME, _CAMERA, 8, shutter)
    scene.plain("WorldBegin")
    scene.entity("LightSource", "infinite", {"rgb L": [0.48, 0.53, 0.62]})
    with scene.attributes():
        scene.comment("The light: 1.6 m wide, over the mirror and behind it, so without caustics.")
        add_quad_light(scene, [34, 31, 27], facing_square((-1.1, 2.3, 4.3), (0, -0.6, 0.4), 0.8))
    scene.comment("The floor.")
    add_image_texture(scene, "oak")
    floor = {"texture reflectance": "oak", "float roughness": 0.15}
    scene.entity("Material", "coateddiffuse", floor)
    add_floor(scene, 8, 10)
    scene.comment("The wall behind the mirror, and a striped one behind the camera.")
    stripes = {"float uscale": 26, "float vscale": 1}
    colors = {"rgb tex1": [0.50, 0.44, 0.33], "rgb tex2": [0.30, 0.09, 0.07]}
    scene.entity("Texture", ["paper", "spectrum", "checkerboard"], {**stripes, **colors})
    scene.entity("Material", *matt([0.20, 0.33, 0.34]))
    add_quad(scene, [(-8, 1.7, 0), (8, 1.7, 0), (8, 1.7, 2.6), (-8, 1.7, 2.6)])
    scene.entity("Material", "diffuse", {"texture reflectance": "paper"})
    wall = [(8, -6.5, 0), (-8, -6.5, 0), (-8, -6.5, 3), (8, -6.5, 3)]
    add_quad(scene, wall, [0, 0, 1, 0, 1, 1, 0, 1])
    scene.comment("The flat mirror in its frame.")
    scene.entity("Material", *metal("Ag"))
    x0, x1, y = _MIRROR[0] - _HALF_WIDTH, _MIRROR[0] + _HALF_WIDTH, _MIRROR[1]
    add_quad(scene, [(x0, y, _BOTTOM), (x1, y, _BOTTOM), (x1, y, _TOP), (x0, y, _TOP)])
    add_mesh(scene, folder, "frame", glossy([0.10, 0.035, 0.02], 0.05), _frame())
    _add_pinwheel(scene, folder)
    _add_ball(scene)
    _add_round_mirror(scene, folder)
    _add_posts(scene, folder)
    scene.write(folder / "scene.pbrt")
