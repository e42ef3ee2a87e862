"""Thin leaves and bars under an area light: an occluder finer than a voxel grid resolves."""

from math import cos, pi, sin
from random import Random

from .camera import Camera, cross, normalize
from .mesh import Mesh
from .pbrt_text import SceneText
from .stage import add_floor, add_mesh, add_options, add_quad_light, matt

NAME = "foliage"
HEADER = """
foliage: the complex occluder (compare thesis figure 5.12).
Metres, z up. 700 leaves, 6 to 18 cm long and as good as flat, and a fence of thin bars throw soft
shadows on a plain floor; every part of a shadow has the width of its own leaf's penumbra. One square
light, dim sky.
"""

_CAMERA = Camera(eye=(0.2, -3.6, 2.6), target=(0.15, 0.1, 0.3), fov=34, resolution=(640, 360))
_LEAVES = 700


def _leaf(mesh, random, middle, size):
    """A rhombus of four triangles, bent a little along its middle."""
    z, phi = random.uniform(-1, 1), random.uniform(0, 2 * pi)
    r = (1 - z * z) ** 0.5
    along = (r * cos(phi), r * sin(phi), z)
    side = normalize(cross(along, (0.31, 0.53, 0.79)))
    normal = cross(along, side)
    points = [(-1, 0, 0), (0, -0.4, 0.05), (1, 0, 0), (0, 0.4, 0.05)]
    index = []
    for u, v, w in points:
        position = [
            m + size * (u * a + v * s + w * n)
            for m, a, s, n in zip(middle, along, side, normal)
        ]
        index.append(mesh.add_vertex(position, normal, (u, v)))
    mesh.faces += [(index[0], index[1], index[2]), (index[0], index[2], index[3])]


def _crown():
    """Leaves in an ellipsoid, 0.3 to 1.3 m above the floor."""
    random, mesh = Random(512), Mesh()
    while len(mesh.faces) < 2 * _LEAVES:
        p = [random.uniform(-1, 1) for _ in range(3)]
        if sum(c * c for c in p) > 1:
            continue
        middle = (0.9 * p[0] - 0.4, 0.7 * p[1] + 0.3, 0.8 + 0.5 * p[2])
        _leaf(mesh, random, middle, random.uniform(0.03, 0.09))
    return mesh


def _fence():
    """Upright bars, 1 cm wide, 7 cm apart."""
    mesh = Mesh()
    for i in range(18):
        x, y, h = 0.7 + 0.07 * i, 0.3, 0.005
        corners = [(x - h, y - h), (x + h, y - h), (x + h, y + h), (x - h, y + h)]
        for k, (a, b) in enumerate(zip(corners, corners[1:] + corners[:1])):
            normal = [(0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)][k]
            quad = [(*a, 0.0), (*b, 0.0), (*b, 0.9), (*a, 0.9)]
            mesh.add_quad(*[mesh.add_vertex(p, normal, (0, 0)) for p in quad])
    return mesh


def write(folder):
    """Writes the scene and its meshes."""
    (folder / "meshes").mkdir()
    scene = SceneText(HEADER)
    add_options(scene, NAME, _CAMERA, 5)
    scene.plain("WorldBegin")
    scene.entity("LightSource", "infinite", {"rgb L": [0.25, 0.30, 0.40]})
    with scene.attributes():
        scene.comment("The light: 0.6 m wide, 6 m up, shining down.")
        corners = [(-0.5, -0.7, 6), (-0.5, -0.1, 6), (0.1, -0.1, 6), (0.1, -0.7, 6)]
        add_quad_light(scene, [260.0, 243.0, 214.0], corners)
    scene.comment("The floor.")
    scene.entity("Material", *matt([0.6, 0.57, 0.52]))
    add_floor(scene, 12)
    scene.comment("The leaves and the fence.")
    add_mesh(scene, folder, "leaves", matt([0.12, 0.3, 0.07]), _crown())
    add_mesh(scene, folder, "bars", matt([0.35, 0.3, 0.27]), _fence())
    scene.write(folder / "scene.pbrt")
