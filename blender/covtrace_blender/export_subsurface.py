"""Light that is scattered below the surface, of Principled and of the node Subsurface Scattering, as pbrt-v4 materials."""

import math

import bpy
import numpy as np

from .emission import EmissionReader, either
from .export_shaders import squared
from .values import Value


def reflectance_of_dipole(albedo, far):
    """Diffuse reflectance of a half space of reduced albedo `albedo` (array): equation 15 of Jensen, Marschner, Levoy and
    Hanrahan 2001, "A practical model for subsurface light transport", with far = 4 A / 3."""
    root = np.sqrt(3 * (1 - albedo))
    return albedo / 2 * (1 + np.exp(-far * root)) * np.exp(-root)


def radius_of_skin(colour, eta):
    """Factor on the radius by which Cycles has the mean free path of its random walk for skin: the square root of 3 (1 - a),
    with a the reduced albedo of the medium under a border of index eta which sends back the share `colour` (array)."""
    inside = -1.440 / eta**2 + 0.710 / eta + 0.668 + 0.0636 * eta  # diffuse Fresnel reflectance, ibid.
    far = 4 / 3 * (1 + inside) / (1 - inside)
    least, most = np.zeros_like(colour), np.ones_like(colour)
    for _ in range(30):
        middle = (least + most) / 2
        is_dark = reflectance_of_dipole(middle, far) < colour
        least, most = np.where(is_dark, middle, least), np.where(is_dark, most, middle)
    return np.sqrt(3 * (1 - (least + most) / 2))


def factor_of_fixed_radius():
    """Cycles' factor on the radius of the walk that is not for skin, by which it looked as older models did. Blender 5.3 has none,
    4.5 has it; those between were not tried."""
    return 0.25 / math.pi if bpy.app.version < (5, 3) else 1.0


def is_skin(method):
    """Whether a node's method, by the name that this Blender has for it, adapts the radius to colour and index."""
    return method == ("RANDOM_WALK_SKIN" if bpy.app.version >= (4, 0) else "RANDOM_WALK")


def entry(method, eta, roughness):
    """Parameters of how light enters: evenly before Blender 4.0. Since then by the facets of the surface, and for skin half of it
    evenly, half by facets as rough as can be."""
    if bpy.app.version < (4, 0):
        return []
    share, alpha = (0.5, 1) if is_skin(method) else (1, squared(roughness))
    return [f'"float refractedshare" {share}', f'"float faceteta" {eta:.9g}', f'"float facetalpha" {alpha:.9g}']


class SubsurfaceExporter(EmissionReader):
    """Writes the materials of bodies that scatter light inside: Cycles' random walks, in which light enters and leaves evenly in
    all directions."""

    def _body(self, node, method, colour, radius, scale, eta, parameters):
        """radius: the socket of the mean distances of red, green and blue, which are multiplied by `scale`. eta: index by which
        light enters, but for skin, which has one of its own. parameters: those of the border."""
        get = node.inputs
        anisotropy = either(get, "Subsurface Anisotropy", "Anisotropy")
        g = self._plain(anisotropy) if anisotropy is not None else 0.0
        if is_skin(method):
            eta = self._plain(either(get, "Subsurface IOR", "IOR"))
        eta = max(eta, 1.01)
        rough = Value(1.0) if is_skin(method) or "Roughness" not in get else self._value(get["Roughness"], True)
        # An image of it turns the directions in which light enters but little.
        parameters = parameters + entry(method, eta, get["Roughness"].default_value if rough.varies else rough.constant)
        free_path = self._value(radius)
        if is_skin(method):
            if free_path.varies:
                self.warn(f"material '{self.name}': an image at '{radius.name}' is not supported; the socket's own value is used")
                free_path = Value(tuple(radius.default_value)[:3])
            lengths = np.array(free_path.constant, dtype=float)
            most = max(float(lengths.max()), 1e-9)
            widest = radius_of_skin(np.zeros(1), eta)[0]

            def treat(pixels):
                return lengths / most * radius_of_skin(np.clip(np.asarray(pixels, dtype=float), 0, 0.999), eta) / widest

            mean_free_path = self._colour("mfp", colour, treat, ("skin", tuple(lengths), eta))
            scale *= most * widest
        else:
            mean_free_path = self._index("mfp", free_path)
            scale *= factor_of_fixed_radius()
        # The radius is that of the light which is scattered evenly: 1 - g times the mean free path.
        return self._make("subsurface", [
            self._colour("reflectance", colour), mean_free_path, f'"float scale" {scale * (1 - g):.9g}', f'"float g" {g:.9g}',
            '"bool refracts" false', *parameters])

    def _subsurface_scattering(self, node):
        """The node of that name: a body without a border."""
        get = node.inputs
        return self._body(node, node.falloff, self._value(get["Color"]), get["Radius"], self._plain(get["Scale"]),
                          self._plain(get["IOR"]) if "IOR" in get else 1.4, ['"float eta" 1', *self._normal_map(node)])
