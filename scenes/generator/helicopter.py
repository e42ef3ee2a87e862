"""A toy helicopter over its landing pad: fast rotors, paint, glass, a ground out of focus."""

from math import pi

from . import helicopter_body as body
from . import helicopter_rotors as rotors
from .camera import Camera
from .helicopter_textures import CREAM, NAVY, RED, write_blade, write_livery, write_pad, write_tiles
from .mesh import arc, lathe, rounded_prism
from .pbrt_text import SceneText
from .stage import (
    add_floor,
    add_image_texture,
    add_mesh,
    add_options,
    add_quad_light,
    facing_square,
    glossy,
    matt,
    metal,
)

NAME = "helicopter"
HEADER = """
helicopter: motion blur and depth of field, after figure 5.11 of Belcour's thesis.
Decimetres, z up. A toy helicopter hovers under one square light; both rotors turn about their axes
while the shutter is open, and so do their shadows and reflections. The lens is focused on the
cabin, the patterned ground behind it dissolves.
"""

_HOVER = 1.62  # height of the body's middle over the ground
_YAW, _PITCH, _BANK = 14, 5, -5
_BLADES, _RADIUS = 3, 2.75
# Degrees while the shutter is open. From half a turn on pbrt would interpolate the other way round.
MAIN_TURN, TAIL_TURN = 70, 150

CAMERA = Camera(eye=(3.4, 12.8, 6.3), target=(-0.68, 0.0, 1.62), fov=21, resolution=(640, 360))
_LENS_RADIUS = 0.24
# The part of the light that the pane mirrors; the rest passes straight, that of shadow rays too.
# Behind a dielectric no shadow ray reaches the lamp, which then is met by chance alone: isolated
# bright pixels all over the cabin's floor.
_PANE = 0.09
_TILE = 2.0
_TEXTURES = {"livery": write_livery, "blade": write_blade, "pad": write_pad, "tiles": write_tiles}


def _focal_distance():
    return CAMERA.depth((0.6, 0.6, _HOVER))


def _add_materials(scene):
    for name in _TEXTURES:
        add_image_texture(scene, name)
    materials = {
        "livery": ("coateddiffuse", {"texture reflectance": "livery", "float roughness": 0.0}),
        "red": glossy(RED, 0.0),
        "cream": glossy(CREAM, 0.02),
        "navy": glossy(NAVY, 0.05),
        "yellow": glossy((0.80, 0.45, 0.02), 0.05),
        "blade": ("coateddiffuse", {"texture reflectance": "blade", "float roughness": 0.1}),
        "glass": ("conductor", {"rgb reflectance": [0.95, 0.95, 0.95], "float roughness": 0.0}),
        "cockpit": matt((0.055, 0.06, 0.07)),
        "wood": glossy((0.62, 0.40, 0.22), 0.2),
        "steel": metal("Al", 0.05),
        "brass": metal("CuZn", 0.15),
        "pad": ("coateddiffuse", {"texture reflectance": "pad", "float roughness": 0.15}),
        "tiles": ("coateddiffuse", {"texture reflectance": "tiles", "float roughness": 0.25}),
    }
    for name, (kind, parameters) in materials.items():
        scene.entity("MakeNamedMaterial", name, {"string type": kind, **parameters})


def _add_body(scene, folder):
    add_mesh(scene, folder, "cabin", "livery", body.cabin_and_boom())
    add_mesh(scene, folder, "chin", "cream", body.chin())
    add_mesh(scene, folder, "glass", "glass", body.glass(), _PANE)
    add_mesh(scene, folder, "frames", "cream", body.frames())
    add_mesh(scene, folder, "interior", "cockpit", body.interior())
    for (name, mesh), material in zip(body.pilot().items(), ("navy", "wood", "yellow")):
        add_mesh(scene, folder, name, material, mesh)
    add_mesh(scene, folder, "engine", "red", body.engine())
    add_mesh(scene, folder, "exhausts", "steel", body.exhausts())
    add_mesh(scene, folder, "skids", "steel", body.skids())
    add_mesh(scene, folder, "fins", "red", body.fins())


def _add_rotors(scene, folder):
    scene.comment(f"The main rotor turns by {MAIN_TURN} degrees.")
    with scene.attributes():
        scene.plain("Translate", *body.MAST)
        scene.plain("Rotate", 17, 0, 0, 1)
        scene.moving([], [("Rotate", MAIN_TURN, 0, 0, 1)])
        add_mesh(scene, folder, "main-blades", "blade", rotors.main_blades(_BLADES, _RADIUS))
        add_mesh(scene, folder, "main-hub", "steel", rotors.main_hub(_BLADES))
    scene.comment(f"The tail rotor turns by {TAIL_TURN} degrees.")
    with scene.attributes():
        scene.plain("Translate", *body.TAIL_HUB)
        scene.plain("Rotate", -90, 1, 0, 0)
        scene.plain("Rotate", 35, 0, 0, 1)
        scene.moving([], [("Rotate", TAIL_TURN, 0, 0, 1)])
        add_mesh(scene, folder, "tail-blades", "blade", rotors.tail_blades(0.56))
        add_mesh(scene, folder, "tail-hub", "steel", rotors.tail_hub())


def _pad():
    """The landing pad: top and rounded rim; uv of the top from above in [0, 1]."""
    radius, height = 2.75, 0.14
    rim = arc((radius - 0.05, height - 0.05), 0.05, 0.0, pi / 2, 6)
    mesh = lathe([(radius, 0.0), *rim, (1e-4, height)], 96)
    mesh.uvs = [(0.5 + 0.5 * x / radius, 0.5 + 0.5 * y / radius) for x, y, _ in mesh.positions]
    return mesh


def _add_ground(scene, folder):
    scene.comment(f"The ground: tiles of {_TILE / 10:g} m.")
    half = 80
    scene.entity("NamedMaterial", "tiles")
    add_floor(scene, half, 2 * half / _TILE)
    with scene.attributes():
        scene.plain("Rotate", _YAW, 0, 0, 1)
        add_mesh(scene, folder, "pad", "pad", _pad())


# Material, size, position, turn (degrees).
_BLOCKS = [
    ("yellow", 1.5, (-5.6, -6.4), 20),
    ("navy", 1.5, (-7.4, -5.6), 48),
    ("red", 1.3, (-6.4, -6.0), 70),
    ("cream", 1.6, (2.4, -9.4), 12),
]
_BALLS = [
    ("red", 0.9, (-0.2, -8.6)),
    ("steel", 0.8, (2.9, -5.4)),
    ("yellow", 0.55, (-2.4, -6.4)),
    ("brass", 0.4, (-3.9, 2.2)),
]


def _add_toys(scene, folder):
    scene.comment("Blocks and balls around it, out of focus.")
    for i, (material, size, (x, y), turn) in enumerate(_BLOCKS):
        h = size / 2
        outline = [(-h, -h), (h, -h), (h, h), (-h, h)]
        with scene.attributes():
            scene.plain("Translate", x, y, 1.5 if i == 2 else 0)
            scene.plain("Rotate", turn, 0, 0, 1)
            block = rounded_prism(outline, 0.0, size, 0.1, lambda x, y, z: (x, y))
            add_mesh(scene, folder, f"block-{i + 1}", material, block)
    for material, radius, (x, y) in _BALLS:
        with scene.attributes():
            scene.plain("Translate", x, y, radius)
            scene.entity("NamedMaterial", material)
            scene.entity("Shape", "sphere", {"float radius": radius})


def write(folder):
    """Writes the scene and its assets."""
    (folder / "textures").mkdir()
    (folder / "meshes").mkdir()
    for name, draw in _TEXTURES.items():
        draw(folder / "textures" / f"{name}.png")
    scene = SceneText(HEADER)
    lens = {"float lensradius": _LENS_RADIUS, "float focaldistance": _focal_distance()}
    add_options(scene, NAME, CAMERA, 8, {**lens, "float shutteropen": 0, "float shutterclose": 1})
    scene.plain("WorldBegin")
    scene.entity("LightSource", "infinite", {"rgb L": [0.34, 0.40, 0.50]})
    with scene.attributes():
        scene.comment("The light: a square of 0.7 m, 1.4 m up.")
        add_quad_light(scene, [24.0, 22.0, 19.2], facing_square((6.0, 6.0, 14.0), (-1, -1, 1), 3.5))
    _add_materials(scene)
    _add_ground(scene, folder)
    _add_toys(scene, folder)
    scene.comment("The helicopter hovers, nose a little down.")
    with scene.attributes():
        scene.plain("Translate", 0, 0, _HOVER)
        scene.plain("Rotate", _YAW, 0, 0, 1)
        scene.plain("Rotate", _PITCH, 0, 1, 0)
        scene.plain("Rotate", _BANK, 1, 0, 0)
        _add_body(scene, folder)
        _add_rotors(scene, folder)
    scene.write(folder / "scene.pbrt")
