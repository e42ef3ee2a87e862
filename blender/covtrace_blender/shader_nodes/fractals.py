"""Fractals of F. K. Musgrave ("Texturing and Modeling", 3rd edition, chapter 16): sums and products of octaves of noise."""

import numpy as np

from .noise import LEAST_SHARE, signed_noise


class Octaves:
    """The octaves at places p: (noise, strength, share) of each.

    count: how many, the share of the last one being what stands behind the point. fall: the strength of each by that of the one before.
    """

    def __init__(self, p, count, fall, lacunarity):
        self._p, self._lacunarity, self._fall = p, np.asarray(lacunarity, np.float32), np.asarray(fall, np.float32)
        self._count = np.asarray(count, np.float32)

    def __iter__(self):
        return self._first(self._whole())

    def _whole(self):
        return int(np.ceil(self._count.max()))

    def that_count(self):
        """Those of a sum, without the last ones that change less than LEAST_SHARE together."""
        strengths = [float(np.max(self._fall)) ** octave for octave in range(self._whole())]
        return self._first(next((k for k in range(len(strengths)) if sum(strengths[k:]) < LEAST_SHARE), len(strengths)))

    def _first(self, number):
        frequency = strength = np.float32(1)
        for octave in range(number):
            noise = signed_noise(self._p * np.asarray(frequency)[..., None])
            yield noise, strength, np.clip(self._count - octave, 0, 1)
            frequency, strength = frequency * self._lacunarity, strength * self._fall


def _fbm(octaves, offset, gain):
    return sum((share * strength * noise for noise, strength, share in octaves.that_count()), np.float32(0))


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
        weight = 1 if signal is None else np.clip(signal * gain, 0, 1)
        signal = (offset - np.abs(noise)) ** 2 * weight
        value = value + np.where(share < 1, 0, signal * strength)  # Blender leaves out what is no whole octave
    return value


# function(octaves, offset, gain) by the name of Blender's type
KINDS = {"FBM": _fbm, "MULTIFRACTAL": _multifractal, "HETERO_TERRAIN": _hetero_terrain,
         "HYBRID_MULTIFRACTAL": _hybrid_multifractal, "RIDGED_MULTIFRACTAL": _ridged_multifractal}
