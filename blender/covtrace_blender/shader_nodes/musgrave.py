"""The nodes Musgrave and Magic.

Fractals of F. K. Musgrave ("Texturing and Modeling", 3rd edition, chapter 16), of which each octave is lacunarity^-dimension times as
strong as the one before it; the share of the last one is what the detail has behind the point.
"""

import numpy as np

from .noise import signed_noise
from .noise_nodes import points
from .unsupported import Unsupported


class _Octaves:
    """The octaves at places p: (noise, strength, share) of each."""

    def __init__(self, p, detail, dimension, lacunarity):
        self._p, self._lacunarity = p, np.maximum(lacunarity, 1e-5)
        self._fall = self._lacunarity ** -np.maximum(dimension, 1e-5)
        self.detail = float(np.clip(detail, 0, 15))

    def __iter__(self):
        frequency = strength = np.float32(1)
        for octave in range(int(np.ceil(self.detail))):
            noise = signed_noise(self._p * np.asarray(frequency)[..., None])
            yield noise, strength, min(self.detail - octave, 1.0)
            frequency, strength = frequency * self._lacunarity, strength * self._fall


def _fbm(octaves, offset, gain):
    return sum((share * strength * noise for noise, strength, share in octaves), np.float32(0))


def _multifractal(octaves, offset, gain):
    value = np.float32(1)
    for noise, strength, share in octaves:
        value = value * (share * strength * noise + 1)
    return value


def _hetero_terrain(octaves, offset, gain):
    value = None
    for noise, strength, share in octaves:
        value = offset + noise if value is None else value + share * (noise + offset) * strength * value
    return value


def _hybrid_multifractal(octaves, offset, gain):
    value, weight = np.float32(0), np.float32(1)
    for noise, strength, share in octaves:
        weight = np.minimum(weight, 1)
        signal = (noise + offset) * strength
        # Beyond a faint octave there are no further ones.
        value = value + np.where(weight > 0.001, share * weight * signal, 0)
        weight = np.where(weight > 0.001, weight * gain * signal, 0)
    return value


def _ridged_multifractal(octaves, offset, gain):
    value, signal = np.float32(0), None
    for noise, strength, share in octaves:
        if share < 1:  # Blender leaves out what is no whole octave
            break
        weight = 1 if signal is None else np.clip(signal * gain, 0, 1)
        signal = (offset - np.abs(noise)) ** 2 * weight
        value = value + signal * strength
    return value


_KINDS = {"FBM": _fbm, "MULTIFRACTAL": _multifractal, "HETERO_TERRAIN": _hetero_terrain,
          "HYBRID_MULTIFRACTAL": _hybrid_multifractal, "RIDGED_MULTIFRACTAL": _ridged_multifractal}


def _musgrave(node, output, inputs):
    detail = inputs.number("Detail")
    if detail.ndim:
        raise Unsupported(node, "its detail is not the same everywhere")
    dimensions = int(node.musgrave_dimensions[0])
    p = points(node, inputs, dimensions) * inputs.number("Scale")[..., None]
    # All kinds but these have their first octave whole.
    least = 0 if node.musgrave_type in ("FBM", "MULTIFRACTAL") else 1
    octaves = _Octaves(p, max(float(detail), least), inputs.number("Dimension"), inputs.number("Lacunarity"))
    return _KINDS[node.musgrave_type](octaves, inputs.number("Offset"), inputs.number("Gain"))


# Steps of Magic beyond the first: which of x, y, z is set, by which function with which sign, of x, y, z with which signs.
_STEPS = ((1, np.cos, -1, (1, -1, 1)), (0, np.cos, 1, (1, -1, -1)), (2, np.sin, 1, (-1, -1, -1)), (0, np.cos, -1, (-1, 1, -1)),
          (1, np.sin, -1, (-1, 1, 1)), (1, np.cos, -1, (-1, 1, 1)), (0, np.cos, 1, (1, 1, 1)), (2, np.sin, 1, (1, 1, -1)),
          (0, np.cos, -1, (-1, -1, 1)), (1, np.sin, -1, (1, -1, 1)))


def _magic(node, output, inputs):
    x, y, z = np.moveaxis(np.atleast_2d(inputs.coordinates() * inputs.number("Scale")[..., None]) % (2 * np.pi), -1, 0)
    distortion = inputs.number("Distortion")
    waves = [np.sin(5 * (x + y + z)), np.cos(5 * (-x + y - z)), -np.cos(5 * (-x - y + z))]
    if node.turbulence_depth > 0:
        waves = [wave * distortion for wave in waves]
        for axis, function, sign, signs in _STEPS[:node.turbulence_depth]:
            waves[axis] = sign * function(sum(s * wave for s, wave in zip(signs, waves))) * distortion
    half = np.where(distortion != 0, 2 * distortion, 1)
    colour = np.stack([0.5 - wave / half for wave in waves], axis=-1)
    return colour.mean(axis=-1) if output.type == "VALUE" else colour


NODES = {"TEX_MUSGRAVE": _musgrave, "TEX_MAGIC": _magic}
