"""Spheres from near-specular to broad: how the analysis sees a highlight."""

from .camera import Camera
from .pbrt_text import SceneText
from .stage import add_options, add_quad_light

NAME = "shininess"
HEADER = """
shininess: one sphere per roughness, after figure 5.8 of Belcour's thesis.
Metres, z up. GGX roughness rises from left to right. Above metal, one glossy lobe; below a coat
over a diffuse base, a diffuse and a glossy lobe. One square light, no lens, nothing moves: what
the analysis allows to be smoothed depends on the lobes alone.
"""

ROUGHNESS = (0.03, 0.1, 0.25, 0.6)

_CAMERA = Camera(eye=(0.0, -9.0, 1.0), target=(0.0, 0.0, 1.0), fov=12.7, resolution=(640, 320))
_RADIUS, _STEP = 0.47, 1.0
_ROWS = (
    (1.5, "conductor", {"spectrum eta": "metal-Al-eta", "spectrum k": "metal-Al-k"}),
    (0.5, "coateddiffuse", {"rgb reflectance": [0.35, 0.08, 0.05]}),
)


def write(folder):
    """Writes the scene."""
    scene = SceneText(HEADER)
    add_options(scene, NAME, _CAMERA, 3, pixel_filter=False)
    scene.plain("WorldBegin")
    scene.entity("LightSource", "infinite", {"rgb L": [0.02, 0.02, 0.02]})
    with scene.attributes():
        scene.comment("The light: 1 m wide, before the spheres and above them.")
        lower, upper = (-4.35, 4.35), (-3.65, 5.05)
        corners = [(-0.5, *lower), (-0.5, *upper), (0.5, *upper), (0.5, *lower)]
        add_quad_light(scene, [40, 40, 40], corners)
    for height, kind, parameters in _ROWS:
        for i, roughness in enumerate(ROUGHNESS):
            with scene.attributes():
                scene.comment(f"{kind}, roughness {roughness}")
                scene.plain("Translate", (i - (len(ROUGHNESS) - 1) / 2) * _STEP, 0, height)
                rough = {"float roughness": roughness, "bool remaproughness": False}
                scene.entity("Material", kind, {**parameters, **rough})
                scene.entity("Shape", "sphere", {"float radius": _RADIUS})
    scene.write(folder / "scene.pbrt")
