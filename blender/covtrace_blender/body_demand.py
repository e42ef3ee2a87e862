"""How many images materials make over bodies, and how many texels all of them together may have."""

import io

import numpy as np

from . import body_normals
from .angles import BOTH_SIDES, of_constants, of_places
from .atlas import MARGIN
from .atlases import digest
from .baked import Baked, BakedImage, Layout, channels_of
from .baking import Surface
from .charts import WAYS
from .export_materials import MaterialExporter
from .shader_nodes.evaluator import evaluated
from .shader_nodes.place import BodyPlace, UvPlace
from .shader_nodes.unsupported import NeedsBody

# In the images of all atlases of a picture together, and of a viewport; each takes 4 or 12 bytes while the scene is exported.
MOST_TEXELS, MOST_TEXELS_OF_PREVIEWS = 1 << 26, 1 << 23
PROBES = 64
MOST_STEPS = 40  # of the root of 2 that densities are lowered by


class _AnyBody:
    """A body that has all coordinates, at random."""

    @staticmethod
    def knows(kind):
        return True

    @staticmethod
    def values(kind, texels, shift):
        return np.random.default_rng(len(kind)).random((PROBES, 3), np.float32)[texels]


class _Counter:
    """Looks at nodes as a Baker does, at few places, and knows the images that BakedImages would have. kinds: of coordinates on a body
    that these hang on."""

    def __init__(self, pixels_of):
        self._pixels_of, self.ray, self.owner, self._known, self.kinds = pixels_of, None, None, {}, set()

    def images(self):
        return sum(len(found.images) for found in self._known.values())

    def of(self, socket, surface, how, bake):
        return self._once((socket.node.path, socket.identifier, how), bake)

    def turned(self, image, body, uv_map, strengths):
        self.kinds.update(body_normals.kinds(uv_map))
        return self._once((image.name_full, uv_map, strengths), self._image).image

    def bake(self, get, surface, only_unit_square=False, by_angle=True):
        def place_of(times):
            if surface.body:
                return BodyPlace(_AnyBody, np.arange(PROBES).repeat(times), (0.0, 0.0), self._pixels_of, self.ray, self.owner)
            return UvPlace(_AnyBody.values("uv", np.arange(PROBES).repeat(times), None)[:, :2], self._pixels_of, self.ray, self.owner)

        place = place_of(1)
        value = evaluated(get, place)
        angles = None
        if place.hangs_on_angle and by_angle:
            if place.is_uniform:
                return of_constants(get, UvPlace(np.zeros((len(BOTH_SIDES), 2), np.float32), self._pixels_of, self.ray, self.owner), channels_of(value))
            angles = of_places(get, place_of(len(BOTH_SIDES)), channels_of(value))
        if place.is_uniform:
            return Baked(constant=value)
        if surface.body:
            self.kinds.update(place.kinds())
        return self._image(() if surface.body else place.uv_maps, angles)

    def _once(self, key, make):
        if key not in self._known:
            self._known[key] = make()
        return self._known[key]

    @staticmethod
    def _image(uv_maps=(), angles=None):
        images = [BakedImage(np.zeros((1, 1, 3), np.float32)) for _ in (angles.cosines if angles else (1,))]
        return Baked(images=images, layout=Layout((0, 0), (1, 1), "repeat"), uv_maps=uv_maps, angles=angles)


class _NoFiles:
    """A writer of images that writes none."""

    def __init__(self, source):
        self.source = source

    def write(self, image, key=None, treat=None):
        return ""

    write_emission = write_heights = write


class _Probe(MaterialExporter):
    """Exports a material to nowhere. source: as TextureFiles has it."""

    def __init__(self, source):
        super().__init__(io.StringIO(), None, lambda text: None)
        self.files = _NoFiles(source)

    def images_on_body(self, material, active_uv_map):
        """(how many it makes, kinds of coordinates that these hang on); (0, ()) where a UV map is enough."""
        self.surface = Surface(body_of=lambda: _AnyBody, active_uv_map=active_uv_map)
        try:
            self._look_at(material)
            return 0, ()
        except NeedsBody:
            self.surface = self.surface.on_body()
            return self._look_at(material)

    def _look_at(self, material):
        self.baker = self.baked = _Counter(self.files.source)
        self._variants(material)
        return self.baked.images(), self.baked.kinds


class BodyDemand:
    """The texels of the images over all bodies that are added. source: as TextureFiles has it. most_of_one: as Atlas has most_texels."""

    def __init__(self, source, most_of_one):
        self._source, self._most_of_one, self._known, self._added = source, most_of_one, {}, {}

    def images(self, material, active_uv_map):
        """How many images a material makes over an object's body, and the kinds of coordinates that these hang on."""
        key = material.name_full, active_uv_map
        if key not in self._known:
            self._known[key] = _Probe(self._source).images_on_body(material, active_uv_map)
        return self._known[key]

    def add(self, material, images, kinds, body, density):
        """Adds a Body, unless one like it, which has the same images, is there."""
        key = material.name_full, digest(body.rest, density), body.looks(kinds)
        self._added[key] = images, texels_wanted(body.rest, density)

    def texels(self, share=1.0):
        """About how many all images have, with a share of the densities."""
        images, wanted = np.array(list(self._added.values())).reshape(-1, 2).T
        margins = len(WAYS) * (2 * MARGIN + 1) ** 2
        return float((images * np.minimum(wanted * share**2 + margins, self._most_of_one)).sum())

    def share_of_density(self, most, warn):
        """The factor by which densities are lowered, so that there are `most` texels or fewer: a power of the root of 2, so that small moves
        change nothing. warn(text): is told where they are."""
        shares = (2.0 ** (-step / 2) for step in range(MOST_STEPS))
        share = next((share for share in shares if self.texels(share) <= most), 2.0 ** (-MOST_STEPS / 2))
        if share < 1:
            warn(f"the patterns on all objects would have about {self.texels() / 1e6:.0f} million texels, of which there are at most "
                 f"{most / 1e6:.0f}; all are {1 / share:.1f} times as coarse")
        return share


def texels_wanted(corners, density):
    """About how many texels without margins an atlas has of (n, 3, 3) corners of triangles with (n,) texels per unit."""
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return 1.3 * float((areas * density**2).sum())
