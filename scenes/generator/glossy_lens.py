"""A glossy floor under an open lens: what stands on it and what glows above it, smeared twice."""

from math import pi

from .camera import Camera
from .files import write_ply
from .loft import smooth_path
from .mesh import arc, lathe
from .pbrt_text import SceneText
from .stage import add_floor, add_options, add_quad, add_quad_light, glossy, matt, metal

NAME = "glossy-lens"
HEADER = """
glossy-lens: reflections of middling sharpness, out of focus.
Metres, z up. A lacquered floor, whose roughness changes from square to square, and an inlay of
satin metal mirror game pieces and glowing bars. The lens is focused on the row in the middle:
reflections are blurred by the floor's lobe and again by the lens, for which a mirror image is
farther away than the floor that carries it.
"""

_CAMERA = Camera(eye=(0.5, -4.6, 1.35), target=(0.0, 0.5, 0.30), fov=27, resolution=(640, 360))
_FOCUS = (0.0, 0.0, 0.35)
_LENS_RADIUS = 0.1

# Smooth profiles (radius, height), bottom to top.
_PAWN = [(0.30, 0.0), (0.30, 0.07), (0.24, 0.12), (0.14, 0.22), (0.09, 0.42), (0.10, 0.50)]
_PAWN += [(0.17, 0.54)]
_CONE = [(0.30, 0.0), (0.30, 0.04), (0.20, 0.30), (0.09, 0.70), (0.03, 0.86)]


def _piece(profile, head):
    """A turned piece, with a ball of radius `head` on top."""
    path = smooth_path([(r, z, 0.0) for r, z in profile], 6)
    outline = [(r, z) for r, z, _ in path]
    top = profile[-1][1] + 0.8 * head
    first = -pi / 2 + 0.6
    outline += [(max(r, 1e-4), z) for r, z in arc((0.0, top), head, first, pi / 2, 20)]
    return lathe(outline, 56)


# Mesh, material, position.
_PIECES = [
    ("pawn", glossy([0.55, 0.03, 0.025], 0.03), (-0.95, 0.05)),
    ("pawn", metal("CuZn", 0.06), (0.05, 0.0)),
    ("pawn", glossy([0.03, 0.12, 0.40], 0.03), (1.0, -0.05)),
    ("cone", matt([0.62, 0.58, 0.50]), (-1.75, 1.9)),
    ("cone", glossy([0.02, 0.26, 0.12], 0.1), (0.65, 1.7)),
    ("pawn", glossy([0.72, 0.45, 0.05], 0.03), (2.1, 2.6)),
    ("pawn", metal("Al", 0.1), (-0.45, 2.9)),
    ("cone", glossy([0.70, 0.66, 0.58], 0.05), (-0.62, -1.75)),
]

# x, y, height, radiance of the glowing bars.
_BARS = [
    (-2.6, 4.6, 1.5, (4.5, 1.6, 0.45)),
    (-0.9, 5.0, 1.9, (3.0, 2.6, 2.1)),
    (0.9, 5.2, 1.6, (0.5, 1.9, 3.9)),
    (2.9, 4.8, 1.8, (4.0, 0.7, 1.2)),
]


def _add_lights(scene):
    scene.entity("LightSource", "infinite", {"rgb L": [0.07, 0.085, 0.12]})
    with scene.attributes():
        scene.comment("A panel overhead.")
        corners = [(-1.6, -1.4, 3.6), (-1.6, 0.6, 3.6), (0.4, 0.6, 3.6), (0.4, -1.4, 3.6)]
        add_quad_light(scene, [8.4, 8.0, 7.4], corners)
    scene.comment("Glowing bars in the background.")
    for x, y, height, radiance in _BARS:
        with scene.attributes():
            left, right = x - 0.09, x + 0.09
            top = [(right, y, height), (left, y, height)]
            add_quad_light(scene, radiance, [(left, y, 0.1), (right, y, 0.1), *top])


def _add_floor(scene):
    scene.comment("The floor: squares of two colours and two roughnesses, out of step.")
    half, squares = 12.0, 32
    scale = {"float uscale": squares, "float vscale": squares}
    colors = {"rgb tex1": [0.30, 0.28, 0.25], "rgb tex2": [0.035, 0.04, 0.05]}
    scene.entity("Texture", ["squares", "spectrum", "checkerboard"], {**scale, **colors})
    halves = {"float uscale": squares / 2, "float vscale": squares, "float udelta": 0.25}
    coats = {"float tex1": 0.04, "float tex2": 0.22}
    scene.entity("Texture", ["coats", "float", "checkerboard"], {**halves, **coats})
    floor = {"texture reflectance": "squares", "texture roughness": "coats"}
    scene.entity("Material", "coateddiffuse", floor)
    add_floor(scene, half, 1)
    scene.comment("An inlay of satin metal under the front pieces.")
    scene.entity("Material", *metal("Al", 0.12))
    inlay = [(-1.5, -0.65), (1.55, -0.65), (1.55, 0.6), (-1.5, 0.6)]
    add_quad(scene, [(x, y, 2e-3) for x, y in inlay])


def write(folder):
    """Writes the scene and its meshes."""
    (folder / "meshes").mkdir()
    for name, mesh in (("pawn", _piece(_PAWN, 0.17)), ("cone", _piece(_CONE, 0.07))):
        write_ply(folder / "meshes" / f"{name}.ply", mesh)
    scene = SceneText(HEADER)
    lens = {"float lensradius": _LENS_RADIUS, "float focaldistance": _CAMERA.depth(_FOCUS)}
    add_options(scene, NAME, _CAMERA, 6, lens)
    scene.plain("WorldBegin")
    _add_lights(scene)
    _add_floor(scene)
    scene.comment("The pieces.")
    for mesh, (kind, parameters), (x, y) in _PIECES:
        with scene.attributes():
            scene.plain("Translate", x, y, 3e-3)
            scene.entity("Material", kind, parameters)
            scene.entity("Shape", "plymesh", {"string filename": f"meshes/{mesh}.ply"})
    scene.write(folder / "scene.pbrt")
