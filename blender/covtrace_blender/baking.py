"""Trees of nodes as images over UV: what is the same everywhere stays a constant."""

import itertools

import numpy as np

from .shader_nodes.evaluator import Evaluator
from .shader_nodes.place import Place

SMALLEST, LARGEST = 512, 2048  # pixels along a side
PROBES = 256
# Mean error of an image against the nodes, at which a finer one is not worth its memory: a step of 8 bits.
TOLERANCE = 1 / 255
SAMPLES_AT_ONCE = 4096  # whose arrays stay in the caches

# Step between neighbours, as a share of the image's range, from which a texel is a mean over its square: the centre alone
# would round the width of mortar and the like to whole texels.
EDGE = 1 / 32
# Places in such a texel, (u, v) in [0, 1]: Hammersley's points, no two of which are in line along an axis.
PLACES = np.array([((k + 0.5) / 16, (int(f"{k:04b}"[::-1], 2) + 0.5) / 16) for k in range(16)])


_numbers = itertools.count(1)  # of names, which are unique among all exports


class BakedImage:
    """Pixels that no image of Blender has."""

    def __init__(self, name_full, values):
        self.name_full, self.values = name_full, values


class Layout:
    """The part of the UV plane that an image shows: (u, v) from `low` on, `extent` wide; beyond it, it `wrap`s."""

    def __init__(self, low, extent, wrap):
        self.low, self.extent, self.wrap = np.array(low, float), np.array(extent, float), wrap

    def is_unit_square(self):
        return bool((self.low == 0).all() and (self.extent == 1).all())

    def mapping(self):
        """Scale and offset of (u, v), as Value has them."""
        return (*(1 / self.extent), *(-self.low / self.extent))


class Surface:
    """The meshes that a material is on, as far as baking has to know them.

    ranges: {UV map: ((u, v) smallest, (u, v) largest)}, "" being the one that is active for rendering. object_of_uv: as
    Place has it.
    """

    def __init__(self, ranges=None, object_of_uv=None):
        self.ranges, self.object_of_uv = ranges or {}, object_of_uv or {}

    def range(self, uv_map):
        found = self.ranges.get(uv_map, self.ranges.get("", ((0, 0), (1, 1))))
        return np.array(found[0], float), np.array(found[1], float)


class Baked:
    """The result: a constant, or an image and its layout; and what it hangs on. is_cut: it repeats where the nodes do
    not."""

    def __init__(self, constant=None, image=None, layout=None, place=None, is_cut=False):
        self.constant, self.image, self.layout, self.place, self.is_cut = constant, image, layout, place, is_cut


class Baker:
    """Bakes what functions of an Evaluator give, to rays of the kind `ray`. `pixels_of`, `ray`: as Place has them."""

    def __init__(self, pixels_of):
        self.pixels_of, self.ray = pixels_of, None

    def bake(self, get, surface, only_unit_square=False):
        """Bakes `get(evaluator)`, a number or a vector; only_unit_square: for what has no other layout.

        Raises Unsupported of the node that cannot be evaluated.
        """
        def at(uv):
            nonlocal place
            place = Place(np.asarray(uv, np.float32), surface.object_of_uv, self.pixels_of, self.ray)
            return get(Evaluator(place))

        place = None
        random = np.random.default_rng(0)
        value = at(random.random((PROBES, 2)))
        if not place.uv_maps:
            return Baked(constant=value, place=place)
        shape = value.shape if len(value.shape) and value.shape[0] == PROBES else (PROBES, *value.shape)

        def values_at(uv):
            return np.broadcast_to(at(uv), (len(uv), *shape[1:]))

        low, high = surface.range(place.uv_maps[0])
        probes = low + random.random((PROBES, 2)) * np.maximum(high - low, 1e-3)
        period = next((n for n in (1, 2) if _repeats(values_at, probes, n)), None)
        layout = _layout(low, high, period)
        is_cut = only_unit_square and period != 1 and (low.min() < -1e-4 or high.max() > 1 + 1e-4)
        if only_unit_square:
            layout = Layout((0, 0), (1, 1), "repeat")
        size = _size(values_at, layout, place.images, random)
        pixels = self._pixels(values_at, layout, size, len(shape) > 1)
        return Baked(image=BakedImage(f"baked {next(_numbers)}", pixels), layout=layout, place=place, is_cut=is_cut)

    @staticmethod
    def _pixels(values_at, layout, size, is_colour):
        """(h, w, 4) float32 from the top, alpha 1."""
        width, height = size
        channels = 3 if is_colour else 1
        texel = layout.extent / size

        def mean_at(columns, rows, places):
            """Mean over `places` of the texels' squares."""
            corner = layout.low + np.column_stack((columns, height - 1 - rows)) * texel
            found = np.zeros((len(columns), channels), np.float32)
            at_once = max(1, SAMPLES_AT_ONCE // len(places))
            for first in range(0, len(columns), at_once):
                uv = corner[first:first + at_once, None] + places * texel
                found[first:first + at_once] = values_at(uv.reshape(-1, 2)).reshape(len(uv), len(places), channels).mean(1)
            return found

        rows, columns = (axis.ravel() for axis in np.mgrid[:height, :width])
        values = mean_at(columns, rows, np.array([[0.5, 0.5]])).reshape(height, width, channels)
        rows, columns = np.nonzero(_edges(values))
        values[rows, columns] = mean_at(columns, rows, PLACES)
        pixels = np.ones((height, width, 4), np.float32)
        pixels[..., :3] = values
        return pixels


def _edges(values):
    """(h, w): where (h, w, n) values step more than EDGE to a neighbour."""
    least_step = EDGE * max(float(np.ptp(values)), 1e-30)
    is_edge = np.zeros(values.shape[:2], bool)
    for axis in (0, 1):
        steps = np.abs(np.diff(values, axis=axis)).max(-1) > least_step
        before, after = (slice(None, -1), slice(1, None))
        for side in (before, after):
            is_edge[(side, slice(None)) if axis == 0 else (slice(None), side)] |= steps
    return is_edge


def _repeats(values_at, uv, period):
    here = values_at(uv)
    return all(np.mean(np.abs(values_at(uv + shift) - here)) < 1e-4 for shift in ((period, 0), (0, period)))


def _layout(low, high, period):
    """One turn of what repeats, else what the meshes show."""
    if (low >= -1e-4).all() and (high <= 1 + 1e-4).all():
        # Texels of images stay where they are, unless only a small part is shown.
        is_small = high - low < 0.5
        margin = 0.02 * (high - low) + 1e-6
        return Layout(np.where(is_small, low - margin, 0), np.where(is_small, high - low + 2 * margin, 1),
                      "repeat" if period == 1 and not is_small.any() else "clamp")
    if period:
        return Layout((0, 0), (period, period), "repeat")
    return Layout(low, np.maximum(high - low, 1e-6), "clamp")


def _size(values_at, layout, images, random):
    """(width, height): whole multiples of the largest image's, and as fine as the nodes need."""
    sizes = []
    for axis in (0, 1):
        base = max([image.size[axis] for image in images if 0 < image.size[axis] <= LARGEST], default=SMALLEST)
        size = base * -(-SMALLEST // base)
        sizes.append([size * 2**k for k in range(3) if size * 2**k <= LARGEST] or [LARGEST])
    steps = max(len(s) for s in sizes)
    uv = layout.low + random.random((4 * PROBES, 2)) * layout.extent
    exact = values_at(uv)
    for step in range(steps):
        size = np.array([s[min(step, len(s) - 1)] for s in sizes])
        if step == steps - 1 or np.mean(np.abs(_interpolated(values_at, layout, size, uv) - exact)) < TOLERANCE:
            break
    return tuple(int(s) for s in size)


def _interpolated(values_at, layout, size, uv):
    """Values that an image of this size would show."""
    texel = (uv - layout.low) / layout.extent * size - 0.5
    first = np.floor(texel)
    share = texel - first
    total = 0
    for corner in itertools.product((0, 1), repeat=2):
        weight = np.prod(np.where(corner, share, 1 - share), axis=1)
        value = values_at(layout.low + (first + corner + 0.5) / size * layout.extent)
        total = total + (weight if value.ndim == 1 else weight[:, None]) * value
    return total
