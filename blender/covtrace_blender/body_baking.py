"""Trees of nodes as images over the atlas of a body."""

import numpy as np

from . import edges
from .baked import Baked, BakedImage, Layout
from .parts import by_parts
from .shader_nodes.evaluator import evaluated
from .shader_nodes.place import BodyPlace

PROBES = 256


def bake_body(get, body, pixels_of, ray, owner):
    """Bakes `get(evaluator)`, a number or a vector, to the atlas of `body`. The rest as BodyPlace has it."""
    def at(texels, shift=(0.0, 0.0)):
        place = BodyPlace(body, texels, shift, pixels_of, ray, owner)
        found = evaluated(get, place)
        kinds.update(place.kinds())
        means.append(place.hangs_on_angle)
        return found

    kinds, means = set(), []
    texels = body.atlas.texels
    count = len(texels.triangle)
    probe = at(np.random.default_rng(0).integers(0, max(count, 1), PROBES if count else 0))
    if not kinds or not count or probe.shape in ((), (3,)):
        return Baked(constant=probe if count else np.zeros(probe.shape[1:]), kinds=kinds, is_mean=any(means))
    channels = 3 if probe.ndim == 2 else 1

    def values_at(chosen, shift):
        return np.broadcast_to(at(chosen, shift).reshape(-1, channels), (len(chosen), channels))

    def mean_at(chosen, places):
        found = np.empty((len(chosen), channels), np.float32)

        def work(first, end):
            found[first:end] = sum(values_at(chosen[first:end], shift) for shift in places) / len(places)

        by_parts(work, len(chosen))
        return found

    image = scattered(body.atlas, mean_at(np.arange(count), [(0.0, 0.0)]))
    chart = scattered(body.atlas, body.atlas.chart[texels.triangle, None] + 1)[..., 0]
    number = scattered(body.atlas, np.arange(count)[:, None])[..., 0]
    edges.add_means(image, lambda rows, columns, places: mean_at(number[rows, columns], places), chart, chart > 0)
    return Baked(image=body_image(body.atlas, image[texels.rows, texels.columns]), layout=Layout((0, 0), (1, 1), "repeat"), kinds=kinds, is_mean=any(means))


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
