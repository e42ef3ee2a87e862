"""The demo: a snooker table in a lit room, with an open lens and a rolling ball."""

from math import hypot

from . import cue, table
from .ball_decals import write_numbered, write_spotted
from .camera import Camera
from .cloth import write_chalk, write_weave
from .mesh import rounded_prism
from .pbrt_text import SceneText
from .room import write_room
from .snooker_balls import EVERY_MATERIAL, RADIUS, ROLLING, pack, place, require_clearance
from .stage import add_mesh, add_options
from .wood import write_wood

NAME = "snooker"
HEADER = """
snooker: depth of field, motion blur and glossy reflection in one picture.
Metres, z up. Balls of every kind of material lie on a woven cloth under an environment map; the
lens is open and focused on the black ball, and the spotted cue ball rolls while the shutter is
open. All files beside this one were made by scenes/generate.py.
"""

_WEAVE_TILE = 0.064  # metres of cloth in one repeat of the weave: yarns of 2 mm

CAMERA = Camera(
    eye=place(-0.57, 0.0, 0.215), target=place(0.36, 0.004, 0.012), fov=29, resolution=(640, 360)
)
_LENS_RADIUS = 0.012


def _focal_distance(ball):
    """Depth of the front of the ball in focus, where its number is."""
    return CAMERA.depth(ball.center) - 0.8 * RADIUS


def write(folder):
    """Writes the scene and its assets."""
    write_table(folder, NAME, HEADER, EVERY_MATERIAL)


def write_table(folder, name, header, balls):
    """Writes a scene of this table with the given BallSet, whose first resting ball is in focus."""
    require_clearance(balls)
    (folder / "textures").mkdir()
    (folder / "meshes").mkdir()
    _write_textures(folder / "textures", balls)
    scene = SceneText(header)
    distance = _focal_distance(balls.resting[0])
    lens = {"float lensradius": _LENS_RADIUS, "float focaldistance": distance}
    add_options(scene, name, CAMERA, 8, {**lens, "float shutteropen": 0, "float shutterclose": 1})
    scene.plain("WorldBegin")
    room = {"string filename": "textures/room.pfm", "float scale": 1.3}
    scene.entity("LightSource", "infinite", room)
    _add_textures(scene)
    _add_table(scene, folder)
    _add_cue(scene, folder)
    _add_balls(scene, balls)
    scene.write(folder / "scene.pbrt")


def _cloth_size():
    return (
        2 * (table.HALF_LENGTH + table.CUSHION_DEPTH),
        2 * (table.HALF_WIDTH + table.CUSHION_DEPTH),
    )


def _chalk_marks():
    """Strokes (see write_chalk) where chalk came off, around the focus."""
    width, height = _cloth_size()
    marks = []
    for ahead, right, turn, length, breadth, strength in (
        (-0.030, 0.034, (1.0, 0.35), 0.008, 0.0022, 0.30),
        (-0.010, -0.125, (1.0, -0.2), 0.013, 0.0020, 0.28),
        (0.050, 0.165, (0.6, 1.0), 0.007, 0.0030, 0.25),
        (0.175, 0.035, (1.0, 0.6), 0.016, 0.0025, 0.28),
        (-0.115, 0.015, (1.0, -0.8), 0.007, 0.0020, 0.28),
        (0.340, 0.140, (1.0, 0.1), 0.016, 0.0040, 0.25),
        (0.270, -0.260, (0.4, 1.0), 0.020, 0.0040, 0.25),
    ):
        x, y, _ = place(ahead, right)
        u, v = x / width + 0.5, (y + height / 2) / width
        marks.append((u, v, turn, length / width, breadth / width, strength))
    return marks


def _write_textures(folder, balls):
    write_weave(folder / "weave.png")
    write_chalk(folder / "chalk.png", 2048, 1048, _chalk_marks())
    write_wood(
        folder / "mahogany.png", 1024, 256, (0.030, 0.008, 0.004), (0.25, 0.075, 0.030), 9, 3
    )
    write_wood(folder / "ash.png", 1024, 128, (0.30, 0.17, 0.07), (0.66, 0.47, 0.26), 5, 7)
    for name, (number, color, striped, _) in balls.numbered.items():
        write_numbered(folder / f"{name}.png", number, color, striped)
    write_spotted(folder / "cue-ball.png", ROLLING.color, ROLLING.spot_color)
    write_room(folder / "room.pfm", 512, 2)


def _image_texture(scene, name, file, scale_u=1.0, scale_v=1.0):
    parameters = {"string filename": f"textures/{file}"}
    if (scale_u, scale_v) != (1.0, 1.0):
        parameters |= {"float uscale": scale_u, "float vscale": scale_v}
    scene.entity("Texture", [name, "spectrum", "imagemap"], parameters)


def _add_textures(scene):
    scene.comment("Cloth: the uv are metres; chalk lies over the weave.")
    width, height = _cloth_size()
    _image_texture(scene, "weave", "weave.png", 1 / _WEAVE_TILE, 1 / _WEAVE_TILE)
    scene.entity(
        "Texture",
        ["chalk", "float", "imagemap"],
        {
            "string filename": "textures/chalk.png",
            "string encoding": "linear",
            "string wrap": "clamp",
            "float uscale": 1 / width,
            "float vscale": 1 / height,
            "float udelta": 0.5,
            "float vdelta": 0.5,
        },
    )
    scene.entity(
        "Texture",
        ["cloth", "spectrum", "mix"],
        {"texture tex1": "weave", "rgb tex2": [0.33, 0.45, 0.50], "texture amount": "chalk"},
    )
    scene.comment("Wood: the uv are metres, u along the grain.")
    _image_texture(scene, "mahogany", "mahogany.png", 1 / 0.6, 1 / 0.15)
    _image_texture(scene, "ash", "ash.png", 1 / 0.5, 1 / 0.04)


def _named_material(scene, name, kind, parameters):
    scene.entity("MakeNamedMaterial", name, {"string type": kind, **parameters})


def _glossy_material(scene, name, texture, roughness):
    parameters = {"texture reflectance": texture, "float roughness": roughness}
    _named_material(scene, name, "coateddiffuse", parameters)


def _add_table(scene, folder):
    scene.comment("The table.")
    _named_material(scene, "cloth", "diffuse", {"texture reflectance": "cloth"})
    _glossy_material(scene, "varnish", "mahogany", 0.02)
    _named_material(
        scene,
        "leather",
        "coateddiffuse",
        {"rgb reflectance": [0.030, 0.018, 0.012], "float roughness": 0.3},
    )
    _named_material(
        scene,
        "brass",
        "conductor",
        {"spectrum eta": "metal-CuZn-eta", "spectrum k": "metal-CuZn-k", "float roughness": 0.05},
    )
    add_mesh(scene, folder, "bed", "cloth", table.bed())
    add_mesh(scene, folder, "cushions", "cloth", table.cushions())
    add_mesh(scene, folder, "rails", "varnish", table.rails())
    add_mesh(scene, folder, "pockets", "leather", table.pocket_liners())
    add_mesh(scene, folder, "pocket-rims", "brass", table.pocket_rims())


def _add_cue(scene, folder):
    scene.comment("The cue behind the cue ball, and a cube of chalk on the far rail.")
    _glossy_material(scene, "ash", "ash", 0.05)
    _named_material(scene, "chalk", "diffuse", {"rgb reflectance": [0.10, 0.30, 0.48]})
    dx, dy = ROLLING.travel
    length = hypot(dx, dy)
    back = (-dx / length, -dy / length, 0.085)
    tip = [p + (RADIUS + 0.035) * d for p, d in zip(ROLLING.start, back)]
    materials = {"tip": "chalk", "ferrule": "brass", "shaft": "ash", "butt": "varnish"}
    with scene.attributes():
        scene.plain("Transform", "[", *cue.placement(tip, back), "]")
        for part, mesh in cue.parts().items():
            add_mesh(scene, folder, f"cue-{part}", materials[part], mesh)
    half = 0.011
    square = [(-half, -half), (half, -half), (half, half), (-half, half)]
    cube = rounded_prism(square, 0.0, 0.021, 0.0015, lambda x, y, z: (x, y))
    with scene.attributes():
        x = table.HALF_LENGTH + table.CUSHION_DEPTH + 0.05
        scene.plain("Translate", x, 0.19, table.RAIL_TOP)
        scene.plain("Rotate", 24, 0, 0, 1)
        add_mesh(scene, folder, "chalk", "chalk", cube)


def _add_sphere(scene):
    scene.entity("Shape", "sphere", {"float radius": RADIUS})


def _add_balls(scene, balls):
    scene.comment("Balls.")
    for name, (_, _, _, roughness) in balls.numbered.items():
        _image_texture(scene, name, f"{name}.png")
        _glossy_material(scene, name, name, roughness)
    for name, (kind, parameters) in balls.plain.items():
        _named_material(scene, name, kind, parameters)
    for ball in balls.resting:
        x, y = CAMERA.project(ball.center)
        scene.comment(f"{ball.name}: at pixel ({x:.0f}, {y:.0f})")
        with scene.attributes():
            scene.plain("Translate", *ball.center)
            if ball.name in balls.numbered:
                for rotation in ball.rotations(CAMERA.eye):
                    scene.plain(*rotation)
            scene.entity("NamedMaterial", ball.name)
            _add_sphere(scene)
    scene.comment("The pack.")
    scene.entity("NamedMaterial", "red")
    for center in pack(balls.pack_rows):
        with scene.attributes():
            scene.plain("Translate", *center)
            _add_sphere(scene)
    scene.comment("The cue ball rolls without slipping.")
    _image_texture(scene, "cue-ball", "cue-ball.png")
    _glossy_material(scene, "cue-ball", "cue-ball", 0.0)
    with scene.attributes():
        scene.moving(*ROLLING.motion())
        scene.plain("Rotate", 20, 0.3, 0.5, 1)
        scene.entity("NamedMaterial", "cue-ball")
        _add_sphere(scene)
