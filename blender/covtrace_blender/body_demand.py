"""How many images materials make over bodies, and how many texels all of them together may have."""

import io

import numpy as np

from .atlas import MARGIN
from .atlases import digest
from .baked import Baked, BakedImage, Layout
from .baking import Surface
from .charts import WAYS
from .export_materials import MaterialExporter
from .shader_nodes.evaluator import Evaluator
from .shader_nodes.place import BodyPlace, UvPlace
from .shader_nodes.unsupported import NeedsBody

# In the images of all atlases of a picture together, and of a viewport; each takes 4 or 12 bytes while the scene is exported.
MOST_TEXELS, MOST_TEXELS_OF_PREVIEWS = 1 << 26, 1 << 23
PROBES = 64


class _AnyBody:
    """A body that has all coordinates, at random."""

    @staticmethod
    def knows(kind):
        return True

    @staticmethod
    def values(kind, texels, shift):
        return np.random.default_rng(len(kind)).random((len(texels), 3), np.float32)


class _Counter:
    """Looks at nodes as a Baker does, at few places, and counts the images that it would bake."""

    def __init__(self, pixels_of):
        self._pixels_of, self.ray, self.images = pixels_of, None, 0

    def bake(self, get, surface, only_unit_square=False):
        place = BodyPlace(_AnyBody, np.arange(PROBES), (0.0, 0.0), self._pixels_of, self.ray) if surface.body else \
            UvPlace(np.random.default_rng(0).random((PROBES, 2), np.float32), self._pixels_of, self.ray)
        value = get(Evaluator(place))
        if place.is_uniform:
            return Baked(constant=value)
        self.images += 1
        return Baked(image=BakedImage(np.zeros((1, 1, 3), np.float32)), layout=Layout((0, 0), (1, 1), "repeat"))


class _NoFiles:
    """A writer of images that writes none."""

    def __init__(self, source):
        self.source = source

    def write(self, image, key, treat=None):
        return ""

    write_emission = write_heights = write


class _NotKept:
    """A stand-in for BakedImages that bakes anew."""

    @staticmethod
    def of(socket, surface, how, bake):
        return bake()

    @staticmethod
    def turned(image, body, uv_map, strength):
        return image


class _Probe(MaterialExporter):
    """Exports a material to nowhere. source: as TextureFiles has it."""

    def __init__(self, source):
        super().__init__(io.StringIO(), None, lambda text: None)
        self.files, self.baker, self.baked = _NoFiles(source), _Counter(source), _NotKept()

    def images_on_body(self, material, active_uv_map):
        """How many it makes; 0 where a UV map is enough."""
        self.surface = Surface(body_of=lambda: _AnyBody, active_uv_map=active_uv_map)
        try:
            self._variants(material)
            return 0
        except NeedsBody:
            self.surface, self.baker.images = self.surface.on_body(), 0
            self._variants(material)
            return self.baker.images


class BodyDemand:
    """The texels of the images over all bodies that are added. source: as TextureFiles has it."""

    def __init__(self, source):
        self._source, self._known, self._added, self.texels = source, {}, set(), 0

    def images(self, material, active_uv_map):
        """How many images a material makes over an object's body."""
        key = material.name_full, active_uv_map
        if key not in self._known:
            self._known[key] = _Probe(self._source).images_on_body(material, active_uv_map)
        return self._known[key]

    def add(self, material, images, corners, density):
        """Adds a body, unless one like it, which has the same images, is there."""
        key = material.name_full, digest(corners, density)
        if key not in self._added:
            self._added.add(key)
            self.texels += images * texels_wanted(corners, density)


def texels_wanted(corners, density):
    """About how many texels an atlas has of (n, 3, 3) corners of triangles with (n,) texels per unit."""
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return 1.3 * float((areas * density**2).sum()) + len(WAYS) * (2 * MARGIN + 1) ** 2


def share_of_density(wanted, most):
    """The factor by which densities are lowered, so that `wanted` texels become `most` or fewer: a power of the root of 2, so that small moves change
    nothing."""
    return 1.0 if wanted <= most else 2.0 ** (np.floor(np.log2(most / wanted)) / 2)
