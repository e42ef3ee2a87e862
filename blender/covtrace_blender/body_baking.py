"""Trees of nodes as images over the atlas of a body."""

import numpy as np

from . import edges
from .angles import BOTH_SIDES, of_constants, of_places
from .baked import Baked, BakedImage, Layout, channels_of
from .parts import by_parts
from .shader_nodes.evaluator import evaluated, evaluated_at
from .shader_nodes.place import BodyPlace

PROBES = 256


def bake_body(get, body, pixels_of, ray, owner, by_angle=True):
    """Bakes `get(evaluator)`, a number or a vector, to the atlas of `body`. by_angle: as Baker has it; the rest as BodyPlace has it."""
    def place_of(chosen, shift=(0.0, 0.0)):
        return BodyPlace(body, chosen, shift, pixels_of, ray, owner)

    texels = body.atlas.texels
    count = len(texels.triangle)
    probes = np.random.default_rng(0).integers(0, max(count, 1), PROBES if count else 0)
    place = place_of(probes)
    probe = evaluated(get, place)
    kinds, channels, is_by_angle = place.kinds(), channels_of(probe), by_angle and place.hangs_on_angle
    is_mean = place.hangs_on_angle and not by_angle
    if not count:
        return Baked(constant=np.zeros(probe.shape[1:]), kinds=kinds, is_mean=is_mean)
    if is_by_angle and not kinds:
        return of_constants(get, place_of(probes[:1].repeat(len(BOTH_SIDES))), channels)
    if not kinds or not is_by_angle and probe.shape in ((), (3,)):
        return Baked(constant=probe, kinds=kinds, is_mean=is_mean)
    angles = of_places(get, place_of(probes.repeat(len(BOTH_SIDES))), channels) if is_by_angle else None
    width = channels * (len(angles.cosines) if angles else 1)

    def values_at(chosen, shift):
        if angles:
            return evaluated_at(get, place_of(chosen, shift), angles.cosines, len(chosen), channels)
        return np.broadcast_to(np.reshape(evaluated(get, place_of(chosen, shift)), (-1, channels)), (len(chosen), channels))

    def mean_at(chosen, places):
        found = np.empty((len(chosen), width), np.float32)

        def work(first, end):
            found[first:end] = sum(values_at(chosen[first:end], shift) for shift in places) / len(places)

        by_parts(work, len(chosen))
        return found

    image = scattered(body.atlas, mean_at(np.arange(count), [(0.0, 0.0)]))
    chart = scattered(body.atlas, body.atlas.chart[texels.triangle, None] + 1)[..., 0]
    number = scattered(body.atlas, np.arange(count)[:, None])[..., 0]
    edges.add_means(image, lambda rows, columns, places: mean_at(number[rows, columns], places), chart, chart > 0)
    values = image[texels.rows, texels.columns]
    images = [body_image(body.atlas, values[:, first:first + channels]) for first in range(0, width, channels)]
    return Baked(images=images, layout=Layout((0, 0), (1, 1), "repeat"), kinds=kinds, is_mean=is_mean, angles=angles)


def scattered(atlas, values):
    """(h, w, d) of (k, d) values of texels, zero elsewhere."""
    image = np.zeros((atlas.height, atlas.width, values.shape[1]), values.dtype)
    image[atlas.texels.rows, atlas.texels.columns] = values
    return image


def body_image(atlas, values):
    """A BakedImage of (k, 1 or 3) values of texels, with what is near in between."""
    return BakedImage(filled(scattered(atlas, values.astype(np.float32)), scattered(atlas, np.ones((len(values), 1), bool))[..., 0]))


def filled(image, known):
    """(h, w, d) with the mean of what is known nearby where nothing is: coarse levels of filters look there, too."""
    if known.all() or not known.any():
        return image
    height, width = known.shape
    if height == width == 1:
        return image
    padded = np.pad(image * known[..., None], ((0, height % 2), (0, width % 2), (0, 0)))
    weight = np.pad(known.astype(np.float32), ((0, height % 2), (0, width % 2)))
    rows, columns = weight.shape[0] // 2, weight.shape[1] // 2
    count = weight.reshape(rows, 2, columns, 2).sum(axis=(1, 3))
    total = padded.reshape(rows, 2, columns, 2, -1).sum(axis=(1, 3))
    coarse = filled(total / np.maximum(count, 1)[..., None], count > 0)
    return np.where(known[..., None], image, coarse.repeat(2, axis=0).repeat(2, axis=1)[:height, :width])
