"""Fast things over a still floor."""

from .ball_decals import write_spotted
from .camera import Camera
from .mesh import Mesh
from .motion_textures import write_target, write_tiles, write_wear
from .pbrt_text import SceneText
from .stage import add_floor, add_image_texture, add_mesh, add_options, add_quad_light, metal

NAME = "motion"
HEADER = """
motion: strong motion blur of textured objects, seen directly and in a mirror.
Metres, z up. A box slides and spins and a ball flies and tumbles while the shutter is open; the
floor and the mirror ball stand still. One square light, dim sky. The lens is a pinhole.
"""

_CAMERA = Camera(eye=(0.3, -6.2, 2.3), target=(0.1, 0.0, 0.72), fov=32, resolution=(640, 360))


def _box(half):
    """An axis-aligned cube; every face shows the whole texture upright or towards +y."""
    mesh = Mesh()
    faces = [
        ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
        ((-1, 0, 0), (0, -1, 0), (0, 0, 1)),
        ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
        ((0, 0, -1), (1, 0, 0), (0, -1, 0)),
    ]
    for normal, right, up in faces:
        indices = []
        for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
            axes = zip(normal, right, up)
            point = [half * (n + (2 * u - 1) * r + (2 * v - 1) * w) for n, r, w in axes]
            indices.append(mesh.add_vertex(point, normal, (u, v)))
        mesh.add_quad(*indices)
    return mesh


def _add_lights(scene):
    scene.entity("LightSource", "infinite", {"rgb L": [0.16, 0.19, 0.25]})
    with scene.attributes():
        scene.comment("The light: 2.4 m wide, above the camera's view, tilted towards the objects.")
        scene.plain("Translate", -1.2, -3.2, 4.4)
        scene.plain("Rotate", 38, 1, 0, 0)
        corners = [(-1.2, -1.2, 0), (-1.2, 1.2, 0), (1.2, 1.2, 0), (1.2, -1.2, 0)]
        add_quad_light(scene, [11.0, 10.2, 9.0], corners)


def _add_floor(scene):
    scene.comment("The floor: tiles of 0.4 m, darkened by a map of wear at another scale.")
    add_image_texture(scene, "tiles")
    mapping = {"float uscale": 0.37, "float vscale": 0.37}
    add_image_texture(scene, "wear", {"string encoding": "linear", **mapping}, "float")
    scene.entity(
        "Texture", ["floor", "spectrum", "scale"], {"texture tex": "tiles", "texture scale": "wear"}
    )
    scene.entity(
        "Material", "coateddiffuse", {"texture reflectance": "floor", "float roughness": 0.2}
    )
    add_floor(scene, 12, 15)


def _add_objects(scene, folder):
    scene.comment("The box slides 0.6 m to the right and spins by 50 degrees.")
    with scene.attributes():
        scene.moving(
            [("Translate", -1.85, -0.15, 0.55), ("Rotate", 15, 0, 0, 1)],
            [("Translate", -1.25, -0.25, 0.55), ("Rotate", 65, 0, 0, 1)],
        )
        add_image_texture(scene, "target")
        box = ("diffuse", {"texture reflectance": "target"})
        add_mesh(scene, folder, "box", box, _box(0.55))
    scene.comment("The ball flies upwards and tumbles by 80 degrees.")
    with scene.attributes():
        scene.moving(
            [("Translate", 1.55, -0.95, 0.62)],
            [("Translate", 1.85, -0.80, 0.98), ("Rotate", 80, 0.4, 1, 0.2)],
        )
        add_image_texture(scene, "spots")
        scene.entity(
            "Material", "coateddiffuse", {"texture reflectance": "spots", "float roughness": 0.02}
        )
        scene.entity("Shape", "sphere", {"float radius": 0.42})
    scene.comment("The mirror ball between them, at rest.")
    with scene.attributes():
        scene.plain("Translate", 0.55, 0.75, 0.85)
        scene.entity("Material", *metal("Ag"))
        scene.entity("Shape", "sphere", {"float radius": 0.85})


def write(folder):
    """Writes the scene and its assets."""
    (folder / "textures").mkdir()
    (folder / "meshes").mkdir()
    write_target(folder / "textures" / "target.png")
    write_tiles(folder / "textures" / "tiles.png")
    write_wear(folder / "textures" / "wear.png")
    write_spotted(folder / "textures" / "spots.png", (0.03, 0.20, 0.42), (0.82, 0.62, 0.10))
    scene = SceneText(HEADER)
    add_options(scene, NAME, _CAMERA, 8, {"float shutteropen": 0, "float shutterclose": 1})
    scene.plain("WorldBegin")
    _add_lights(scene)
    _add_floor(scene)
    _add_objects(scene, folder)
    scene.write(folder / "scene.pbrt")
