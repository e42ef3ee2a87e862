"""Trees of nodes as images over UV: what is the same everywhere stays a constant."""

import itertools

import numpy as np

from . import edges
from .angles import BOTH_SIDES, of_constants, of_places
from .baked import Baked, Layout, channels_of, images_of
from .body_baking import bake_body
from .parts import PART, by_parts
from .shader_nodes.evaluator import evaluated, evaluated_at
from .shader_nodes.place import RANDOMS, STRANDS, UvPlace

SMALLEST, LARGEST = 512, 2048  # pixels along a side
PROBES = 256
# Mean error of an image against the nodes, at which a finer one is not worth its memory: a step of 8 bits.
TOLERANCE = 1 / 255


class Surface:
    """The meshes that a material is on, as far as baking has to know them.

    ranges: {UV map: ((u, v) smallest, (u, v) largest)}, "" being the one that is active for rendering. body_of: makes the
    Body, with its atlas, for what hangs on the place on it; None where there is none. active_uv_map: the name of the one that
    is active for rendering. space_of: makes the VolumeSpace of what is within it; None where that is not known.
    """

    body = None

    def __init__(self, ranges=None, body_of=None, active_uv_map=None, space_of=None):
        self.ranges, self.body_of, self.active_uv_map, self.space_of = ranges or {}, body_of, active_uv_map, space_of

    def on_body(self):
        """The same, on which all is baked to the body's atlas."""
        found = Surface(self.ranges, space_of=self.space_of)
        found.body = self.body_of()
        return found

    def key(self, kinds):
        """A key that is equal for surfaces that look alike to nodes that ask for these kinds of coordinates on a body."""
        return self.body.key(kinds) if self.body else repr(self.ranges)

    def range(self, uv_map):
        if uv_map == STRANDS:
            return np.zeros(2), np.array((1.0, RANDOMS))
        found = self.ranges.get(uv_map, self.ranges.get("", ((0, 0), (1, 1))))
        return np.array(found[0], float), np.array(found[1], float)


class Baker:
    """Bakes what functions of an Evaluator give, to rays of the kind `ray`, on what `owner` is. `pixels_of`, `ray`, `owner`: as UvPlace
    has them."""

    def __init__(self, pixels_of):
        self.pixels_of, self.ray, self.owner = pixels_of, None, None

    def bake(self, get, surface, only_unit_square=False, by_angle=True):
        """Bakes `get(evaluator)`, a number or a vector; only_unit_square: for what has no other layout; by_angle: whether it may hang on the
        angle of sight, of which it else is the mean.

        Raises Unsupported of the node that cannot be evaluated.
        """
        if surface.body:
            return bake_body(get, surface.body, self.pixels_of, self.ray, self.owner, by_angle)

        def place_of(uv):
            return UvPlace(np.asarray(uv, np.float32), self.pixels_of, self.ray, self.owner)

        random = np.random.default_rng(0)
        place = place_of(random.random((PROBES, 2)))
        value = evaluated(get, place)
        channels, is_by_angle = channels_of(value), by_angle and place.hangs_on_angle
        is_mean = place.hangs_on_angle and not by_angle
        if place.is_uniform:
            if is_by_angle:
                return of_constants(get, place_of(np.zeros((len(BOTH_SIDES), 2))), channels)
            return Baked(constant=value, is_mean=is_mean)
        low, high = surface.range(place.uv_maps[0])
        probes = low + random.random((PROBES, 2)) * np.maximum(high - low, 1e-3)
        angles = of_places(get, place_of(probes.repeat(len(BOTH_SIDES), axis=0)), channels) if is_by_angle else None

        def values_at(uv):
            if angles:
                return evaluated_at(get, place_of(uv), angles.cosines, len(uv), channels)
            return np.broadcast_to(np.reshape(evaluated(get, place_of(uv)), (-1, channels)), (len(uv), channels))

        period = next((n for n in (1, 2) if _repeats(values_at, probes, n)), None)
        layout = _layout(low, high, period)
        is_cut = only_unit_square and period != 1 and (low.min() < -1e-4 or high.max() > 1 + 1e-4)
        if only_unit_square:
            layout = Layout((0, 0), (1, 1), "repeat")
        count = len(angles.cosines) if angles else 1
        size = _size(values_at, layout, place.images, random, count > 2)
        pixels = self._pixels(values_at, layout, size, count * channels)
        return Baked(images=images_of(pixels, channels), layout=layout, uv_maps=place.uv_maps, is_cut=is_cut, is_mean=is_mean, angles=angles)

    @staticmethod
    def _pixels(values_at, layout, size, channels):
        """(h, w, channels) float32 from the top."""
        width, height = size
        texel = layout.extent / size

        def mean_at(columns, rows, places):
            """Mean over `places` of the texels' squares."""
            middle = layout.low + (np.column_stack((columns, height - 1 - rows)) + 0.5) * texel
            found = np.zeros((len(columns), channels), np.float32)

            def work(first, end):
                uv = middle[first:end, None] + np.array(places) * texel
                found[first:end] = values_at(uv.reshape(-1, 2)).reshape(len(uv), len(places), channels).mean(1)

            by_parts(work, len(columns), max(1, PART // len(places)))
            return found

        rows, columns = (axis.ravel() for axis in np.mgrid[:height, :width])
        values = mean_at(columns, rows, [(0, 0)]).reshape(height, width, channels)
        edges.add_means(values, lambda rows, columns, places: mean_at(columns, rows, places))
        return values


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


def _size(values_at, layout, images, random, are_many):
    """(width, height): whole multiples of the largest image's, and as fine as the nodes need. are_many: whether they share the memory of
    one or two."""
    smallest, largest = (SMALLEST // 2, LARGEST // 2) if are_many else (SMALLEST, LARGEST)
    sizes = []
    for axis in (0, 1):
        base = max([image.size[axis] for image in images if 0 < image.size[axis] <= largest], default=smallest)
        size = base * -(-smallest // base)
        sizes.append([size * 2**k for k in range(3) if size * 2**k <= largest] or [largest])
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
        total = total + weight[:, None] * value
    return total
