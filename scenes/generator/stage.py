"""What most scenes begin with: film, filter, sampler, integrator, camera, and flat quads, lit or not."""

from .camera import cross, dot, normalize, subtract

_QUAD = [0, 1, 2, 0, 2, 3]


def add_options(scene, name, camera, max_depth, camera_parameters=None, pixel_filter=True):
    """Adds everything before WorldBegin; the film is called after the scene.

    Without `pixel_filter` the format's default stays; with it, a Gaussian of 1.5 pixels.
    """
    width, height = camera.resolution
    size = {"integer xresolution": width, "integer yresolution": height}
    scene.entity("Film", "rgb", {"string filename": f"{name}.exr", **size})
    if pixel_filter:
        scene.entity("PixelFilter", "gaussian", {"float xradius": 1.5, "float yradius": 1.5})
    scene.entity("Sampler", "zsobol", {"integer pixelsamples": 64})
    scene.entity("Integrator", "path", {"integer maxdepth": max_depth})
    camera.emit(scene, camera_parameters or {})


def add_quad(scene, corners, uv=None):
    """Adds a quad of four points; its front is where they run counter-clockwise. `uv`: 8 numbers."""
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
    """Adds a quad that shines from its front and reflects nothing. To be called within attributes()."""
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


def add_image_texture(scene, name, parameters=None, kind="spectrum"):
    """Adds the texture `name` from textures/NAME.png."""
    file = {"string filename": f"textures/{name}.png"}
    scene.entity("Texture", [name, kind, "imagemap"], {**file, **(parameters or {})})


def metal(name, roughness):
    """Material type and parameters of one of pbrt's named metals."""
    spectra = {"spectrum eta": f"metal-{name}-eta", "spectrum k": f"metal-{name}-k"}
    return "conductor", {**spectra, "float roughness": roughness}


def glossy(color, roughness):
    """Material type and parameters of a coat of that roughness over a diffuse base."""
    return "coateddiffuse", {"rgb reflectance": color, "float roughness": roughness}


def matt(color):
    """Material type and parameters of a diffuse surface."""
    return "diffuse", {"rgb reflectance": color}
