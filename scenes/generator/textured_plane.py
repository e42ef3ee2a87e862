"""Analytic set-ups: a textured plane, facing the camera, with predictable image spectra."""

from math import atan, degrees

from .pbrt_text import SceneText, number
from .spectral_noise import DEVIATION, MEAN, amplitude_variance, write_noise

_RESOLUTION = 128
_DISTANCE = 4.0  # of the plane, which spans _TILE metres of the view in both directions
_TILE = 2.0
_SPREAD = 8.0
_TEXELS = 256
_PIXEL = _TILE / _RESOLUTION
_VARIANCE = amplitude_variance(_SPREAD) / _TILE**2
_IN_PIXELS = _VARIANCE * _PIXEL**2

_COMMON_HEADER = f"""
Known values (covariance of the AMPLITUDE spectrum; both image axes alike, no cross term):
  texture     {number(_VARIANCE)} (cycles/m)^2 per axis,
              {number(_IN_PIXELS)} (cycles/pixel)^2 where it is sharp
  albedo      mean {number(MEAN)}, standard deviation {number(DEVIATION)}
  sky         radiance 1, so that the image's mean is the albedo's
  plane       {number(_DISTANCE)} m away; a tile of {number(_TILE)} m fills the view
  pixel       {number(_PIXEL)} m of the plane
Right-hand directions of pixels, lens and motion are the same (+x of the world).
"""


def _start(header, name, camera):
    scene = SceneText(header.strip() + "\n" + _COMMON_HEADER)
    resolution = {"integer xresolution": _RESOLUTION, "integer yresolution": _RESOLUTION}
    scene.entity("Film", "rgb", {"string filename": f"{name}.exr", **resolution})
    scene.entity("PixelFilter", "box", {"float xradius": 0.5, "float yradius": 0.5})
    scene.entity("Sampler", "independent", {"integer pixelsamples": 64})
    scene.entity("Integrator", "path", {"integer maxdepth": 1})
    fov = 2 * degrees(atan(_TILE / 2 / _DISTANCE))
    scene.entity("Camera", "perspective", {"float fov": fov, **camera})
    scene.plain("WorldBegin")
    scene.entity("LightSource", "infinite", {"rgb L": [1, 1, 1]})
    scene.entity(
        "Texture", ["noise", "spectrum", "imagemap"], {"string filename": "textures/noise.pfm"}
    )
    scene.entity("Material", "diffuse", {"texture reflectance": "noise"})
    return scene


def _add_plane(scene):
    half, tiles = 1.5 * _TILE, 3
    scene.entity(
        "Shape",
        "trianglemesh",
        {
            "point3 P": [-half, -half, _DISTANCE, half, -half, _DISTANCE]
            + [half, half, _DISTANCE, -half, half, _DISTANCE],
            "point2 uv": [0, 0, tiles, 0, tiles, tiles, 0, tiles],
            "integer indices": [0, 1, 2, 0, 2, 3],
        },
    )


def _write_noise(folder):
    (folder / "textures").mkdir()
    write_noise(folder / "textures" / "noise.pfm", _TEXELS, _SPREAD, 17)


class Lens:
    """A thin lens focused in front of the plane."""

    NAME = "textured-plane-lens"
    _RADIUS, _FOCUS = 0.1, 2.5

    @classmethod
    def write(cls, folder):
        """Writes the scene and its texture."""
        shear = cls._RADIUS * (1 - _DISTANCE / cls._FOCUS)
        blur = abs(shear) / _PIXEL
        header = f"""
textured-plane-lens: random texture of known spectrum, out of focus, under a uniform sky.
A lens offset l (in lens radii) moves the seen point by R (1 - z / z_focus) l = {number(shear)} m l,
so
  pixel-lens  {number(_VARIANCE * _PIXEL * shear)} cycles/pixel x cycles/lens radius
  lens-lens   {number(_VARIANCE * shear**2)} (cycles/lens radius)^2
and the circle of confusion has a radius of {number(blur)} pixels.
"""
        camera = {"float lensradius": cls._RADIUS, "float focaldistance": cls._FOCUS}
        _write_noise(folder)
        scene = _start(header, cls.NAME, camera)
        _add_plane(scene)
        scene.write(folder / "scene.pbrt")


class Moving:
    """A pinhole and a plane that moves to the right at constant speed."""

    NAME = "textured-plane-moving"
    _TRAVEL = 0.125

    @classmethod
    def write(cls, folder):
        """Writes the scene and its texture."""
        header = f"""
textured-plane-moving: random texture of known spectrum, moving to the right, under a uniform sky.
The plane travels V = {number(cls._TRAVEL)} m = {number(cls._TRAVEL / _PIXEL)} pixels
while the shutter is open (time 0 to 1), so
  pixel-time  {number(-_VARIANCE * _PIXEL * cls._TRAVEL)} cycles/pixel x cycles/shutter
              (x only, 0 for y)
  time-time   {number(_VARIANCE * cls._TRAVEL**2)} (cycles/shutter)^2
"""
        _write_noise(folder)
        scene = _start(header, cls.NAME, {"float shutteropen": 0, "float shutterclose": 1})
        half = cls._TRAVEL / 2
        with scene.attributes():
            scene.moving([("Translate", -half, 0, 0)], [("Translate", half, 0, 0)])
            _add_plane(scene)
        scene.write(folder / "scene.pbrt")
