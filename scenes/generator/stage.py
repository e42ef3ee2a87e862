"""Parts that most scenes have: options before the world, quads that are lit or shine, materials."""

from .camera import cross, dot, normalize, subtract
from .files import write_ply

_QUAD = [0, 1, 2, 0, 2, 3]


def add_options(scene, name, camera, max_depth, parameters=None, pixel_filter=True):
    """Adds everything before WorldBegin; the film is called after the scene, and
    `parameters` go to the camera.

    Without `pixel_filter` the format's default stays; with it, a Gaussian of 1.5 pixels.
    """
    width, height = camera.resolution
    size = {"integer xresolution": width, "integer yresolution": height}
    scene.entity("Film", "rgb", {"string filename": f"{name}.exr", **size})
    if pixel_filter:
        scene.entity("PixelFilter", "gaussian", {"float xradius": 1.5, "float yradius": 1.5})
    scene.entity("Sampler", "zsobol", {"integer pixelsamples": 64})
    scene.entity("Integrator", "path", {"integer maxdepth": max_depth})
    camera.emit(scene, parameters or {})


def add_quad(scene, corners, uv=None):
    """Adds a quad; its four corners run counter-clockwise seen from its front. `uv`: 8 numbers."""
    parameters = {"point3 P": [number for corner in corners for number in corner]}
    if uv:
        parameters["point2 uv"] = uv
    scene.entity("Shape", "trianglemesh", {**parameters, "integer indices": _QUAD})


def add_floor(scene, half, repeats=None):
    """Adds a level square from -half to half at z = 0, its uv running from 0 to `repeats`."""
    corners = [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)]
    uv = repeats and [0, 0, repeats, 0, repeats, repeats, 0, repeats]
    add_quad(scene, corners, uv)


def add_quad_light(scene, radiance, corners):
    """Adds a quad that shines from its front and reflects nothing; belongs in attributes()."""
    scene.entity("AreaLightSource", "diffuse", {"rgb L": radiance})
    scene.entity("Material", "diffuse", {"rgb reflectance": [0, 0, 0]})
    add_quad(scene, corners)


def facing_square(center, target, half):
    """Corners of a square around `center` whose front looks at `target`; one side is level."""
    ahead = normalize(subtract(target, center))
    side = (1, 0, 0) if abs(dot(ahead, (0, 0, 1))) > 0.999 else normalize(cross(ahead, (0, 0, 1)))
    up = cross(side, ahead)
    # Counter-clockwise for one who looks back along -ahead.
    signs = ((1, -1), (-1, -1), (-1, 1), (1, 1))
    return [
        tuple(c + half * (s * a + t * b) for c, a, b in zip(center, side, up)) for s, t in signs
    ]


def add_mesh(scene, folder, name, material, mesh, alpha=1.0):
    """Writes meshes/NAME.ply into the scene's folder and adds it.

    `material`: a named one, or a type and its parameters. `alpha`: the part of the light that
    meets it; the rest passes.
    """
    write_ply(folder / "meshes" / f"{name}.ply", mesh)
    if isinstance(material, str):
        scene.entity("NamedMaterial", material)
    else:
        scene.entity("Material", *material)
    parameters = {"string filename": f"meshes/{name}.ply"}
    if alpha < 1:
        parameters["float alpha"] = alpha
    scene.entity("Shape", "plymesh", parameters)


def add_image_texture(scene, name, parameters=None, kind="spectrum"):
    """Adds the texture `name` from textures/NAME.png."""
    file = {"string filename": f"textures/{name}.png"}
    scene.entity("Texture", [name, kind, "imagemap"], {**file, **(parameters or {})})


def metal(name, roughness=None):
    """Material type and parameters of one of pbrt's named metals, by default a perfect mirror."""
    parameters = {"spectrum eta": f"metal-{name}-eta", "spectrum k": f"metal-{name}-k"}
    if roughness is not None:
        parameters["float roughness"] = roughness
    return "conductor", parameters


def glossy(color, roughness):
    """Material type and parameters of a coat of that roughness over a diffuse base."""
    return "coateddiffuse", {"rgb reflectance": color, "float roughness": roughness}


def matt(color):
    """Material type and parameters of a diffuse surface."""
    return "diffuse", {"rgb reflectance": color}
