"""The node Voronoi, with the octaves that it has since Blender 4.0."""

import numpy as np

from . import voronoi
from .noise_nodes import points
from .unsupported import Unsupported


class _Octaves:
    """The octaves of a node: (scale, strength, share) of each, the share of the last one being what stands behind the point of `detail`."""

    def __init__(self, node, inputs):
        names = ("Detail", "Roughness", "Lacunarity") if inputs.has("Detail") else ()
        values = [np.unique(inputs.number(name)) for name in names]
        if any(len(v) > 1 for v in values):
            raise Unsupported(node, "its octaves are not the same everywhere")
        detail, self._roughness, self._lacunarity = (float(v[0]) for v in values) if values else (0.0, 0.0, 2.0)
        self._detail, self._roughness = min(max(detail, 0.0), 15.0), min(max(self._roughness, 0.0), 1.0)
        self.is_one = self._detail == 0 or self._roughness == 0

    def __iter__(self):
        scale = strength = 1.0
        for octave in range(1 if self.is_one else int(np.ceil(self._detail)) + 1):
            yield scale, strength, 1.0 if self.is_one else min(self._detail + 1 - octave, 1.0)
            scale, strength = scale * self._lacunarity, strength * self._roughness


def _mixed(a, b, share):
    return a + (b - a) * np.float32(share)


def _edges(p, jitter, octaves, is_normalized):
    largest = 0.5 + 0.5 * jitter
    distance, most = np.float32(8), largest
    for scale, strength, share in octaves:
        found = voronoi.distance_to_edge(p * np.float32(scale), jitter)
        if octaves.is_one:
            distance = found
            break
        distance = _mixed(distance, _mixed(distance, np.minimum(distance, found / scale), strength), share)
        most = _mixed(most, _mixed(most, largest / scale, strength), share)
    return distance / most if is_normalized else distance


def _cells(p, octaves, cells_of, largest):
    """(distance, colour, position); largest: what distances are divided by, or None."""
    total = strengths = None
    for scale, strength, share in octaves:
        distance, colour, position = cells_of(p * np.float32(scale))
        if total is None:
            total, strengths = [distance, colour, position], 1.0
            continue
        added = (total[0] + distance * strength, total[1] + colour * strength, _mixed(total[2], position / scale, strength))
        total = [_mixed(old, new, share) for old, new in zip(total, added)]
        strengths += strength * share
    if largest is not None:
        total[0], total[1] = total[0] / (strengths * largest), total[1] / strengths
    return total


def _voronoi(node, output, inputs):
    dimensions = int(node.voronoi_dimensions[0])
    scale, jitter = inputs.number("Scale")[..., None], np.clip(inputs.number("Randomness"), 0, 1)
    p, is_normalized = np.atleast_2d(points(node, inputs, dimensions) * scale), getattr(node, "normalize", False)
    if node.feature == "N_SPHERE_RADIUS":
        return voronoi.sphere_radius(p, jitter)
    octaves = _Octaves(node, inputs)
    if node.feature == "DISTANCE_TO_EDGE":
        return _edges(p, jitter, octaves, is_normalized)
    exponent = inputs.number("Exponent") if dimensions > 1 and node.distance == "MINKOWSKI" else None
    metric = voronoi.METRICS[node.distance if dimensions > 1 else "MANHATTAN"]
    smoothness = np.clip(inputs.number("Smoothness") / 2, 0, 0.5) if node.feature == "SMOOTH_F1" else np.float32(0)
    if smoothness.ndim and not smoothness.all():
        raise Unsupported(node, "its smoothness is 0 in places")

    def cells_of(places):
        if smoothness.any():
            return voronoi.smooth(places, jitter, lambda d: metric(d, exponent), smoothness)
        return voronoi.nearest(places, jitter, lambda d: metric(d, exponent), node.feature == "F2")

    largest = metric([0.5 + 0.5 * jitter] * dimensions, exponent) * (2 if node.feature == "F2" else 1) if is_normalized else None
    distance, colour, position = _cells(p, octaves, cells_of, largest)
    if output.identifier in ("Distance", "Color"):
        return distance if output.identifier == "Distance" else colour
    position = np.where(scale != 0, position / np.where(scale != 0, scale, 1), 0).astype(np.float32)
    if output.identifier == "W":
        return position[:, -1]
    full = np.zeros((len(position), 3), np.float32)
    full[:, :min(dimensions, 3)] = position[:, :3]
    return full


NODES = {"TEX_VORONOI": _voronoi}
