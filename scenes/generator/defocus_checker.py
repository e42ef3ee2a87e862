"""A checkerboard floor under a wide-open lens."""

from .camera import Camera
from .pbrt_text import SceneText
from .stage import add_floor, add_options, add_quad_light, glossy, matt, metal

NAME = "defocus-checker"
HEADER = """
defocus-checker: strong depth of field over a checkerboard.
Metres, z up. The lens is focused on the middle row of spheres; the squares before and behind it
dissolve. Constant sky and one square light.
"""

_CAMERA = Camera(eye=(0.6, -5.4, 1.75), target=(0.05, 0.0, 0.42), fov=34, resolution=(640, 360))
_FOCUS = (0.0, 0.0, 0.5)
_HALF_FLOOR, _SQUARE = 24.0, 0.4


# Material, radius, position on the floor.
_SPHERES = [
    (glossy([0.60, 0.05, 0.04], 0.0), 0.5, (0.0, 0.0)),
    (glossy([0.05, 0.13, 0.50], 0.15), 0.4, (-1.3, 0.1)),
    (matt([0.75, 0.55, 0.12]), 0.4, (1.25, -0.05)),
    (metal("Al", 0.0), 0.45, (-0.95, 1.9)),
    (metal("Cu", 0.1), 0.55, (1.6, 3.2)),
    (matt([0.10, 0.42, 0.16]), 0.6, (-2.9, 5.5)),
    (glossy([0.50, 0.50, 0.48], 0.05), 0.26, (-0.55, -2.2)),
    (("dielectric", {"float eta": 1.5}), 0.28, (1.05, -1.75)),
]


def write(folder):
    """Writes the scene."""
    scene = SceneText(HEADER)
    lens = {"float lensradius": 0.22, "float focaldistance": _CAMERA.depth(_FOCUS)}
    add_options(scene, NAME, _CAMERA, 8, lens)
    scene.plain("WorldBegin")
    scene.entity("LightSource", "infinite", {"rgb L": [0.40, 0.47, 0.60]})
    with scene.attributes():
        scene.comment("The light: 2 m wide, 4 m up, shining down.")
        corners = [(-3, -2, 4), (-3, 0, 4), (-1, 0, 4), (-1, -2, 4)]
        add_quad_light(scene, [9.0, 8.4, 7.4], corners)
    scene.comment(f"The floor: squares of {_SQUARE} m.")
    squares = 2 * _HALF_FLOOR / _SQUARE
    scene.entity(
        "Texture",
        ["squares", "spectrum", "checkerboard"],
        {
            "float uscale": squares,
            "float vscale": squares,
            "rgb tex1": [0.72, 0.70, 0.65],
            "rgb tex2": [0.05, 0.05, 0.06],
        },
    )
    scene.entity("Material", "diffuse", {"texture reflectance": "squares"})
    add_floor(scene, _HALF_FLOOR, 1)
    scene.comment("The spheres.")
    for (kind, parameters), radius, (x, y) in _SPHERES:
        with scene.attributes():
            scene.plain("Translate", x, y, radius)
            scene.entity("Material", kind, parameters)
            scene.entity("Shape", "sphere", {"float radius": radius})
    scene.write(folder / "scene.pbrt")
