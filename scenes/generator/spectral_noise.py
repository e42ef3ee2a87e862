"""A tileable random texture whose frequency content is known exactly.

It is a Fourier series with random phases and amplitudes exp(-|f|^2 / (2 s^2)) at the integer
frequencies f (cycles per tile), without the constant term. So the covariance of its amplitude
spectrum, sum f f^T A(f) / sum A(f), is isotropic and known, close to s^2 per axis.
"""

from cmath import exp
from math import pi, sqrt
from random import Random

from .files import write_pfm

MEAN, DEVIATION = 0.5, 0.1


def _amplitudes(spread):
    reach = int(3.5 * spread)
    amplitudes = {}
    for fy in range(-reach, reach + 1):
        for fx in range(-reach, reach + 1):
            square = fx * fx + fy * fy
            if 0 < square <= reach * reach:
                amplitudes[fx, fy] = exp(-square / (2 * spread * spread)).real
    return amplitudes


def amplitude_variance(spread):
    """Variance per axis of the amplitude spectrum, in (cycles per tile)^2."""
    amplitudes = _amplitudes(spread)
    total = sum(amplitudes.values())
    return sum(fx * fx * a for (fx, _), a in amplitudes.items()) / total


def _waves(size, reach):
    """exp(2 pi i f k / size) as rows by f, texel centres in k."""
    return {
        f: [exp(2j * pi * f * (k + 0.5) / size) for k in range(size)]
        for f in range(-reach, reach + 1)
    }


def write_noise(path, size, spread, seed):
    """Writes the grey texture as a PFM: mean 0.5, standard deviation 0.1, within [0, 1]."""
    random = Random(seed)
    amplitudes = _amplitudes(spread)
    reach = max(fx for fx, _ in amplitudes)
    # A real image: one of each pair f, -f is enough, and the real part is taken.
    modes = {}
    for (fx, fy), a in amplitudes.items():
        if fx > 0 or (fx == 0 and fy > 0):
            modes.setdefault(fx, []).append((fy, a * exp(2j * pi * random.random())))
    waves = _waves(size, reach)
    rows = []
    for y in range(size):
        row = [0.0] * size
        for fx, column in modes.items():
            weight = sum(c * waves[fy][y] for fy, c in column)
            re, im = weight.real, weight.imag
            row = [v + re * w.real - im * w.imag for v, w in zip(row, waves[fx])]
        rows.append(row)
    scale = DEVIATION / sqrt(sum(v * v for row in rows for v in row) / size**2)
    rows = [[MEAN + scale * v for v in row] for row in rows]
    if min(map(min, rows)) < 0 or max(map(max, rows)) > 1:
        raise ValueError("the noise leaves [0, 1]; choose another seed")
    write_pfm(path, [[v for v in row for _ in range(3)] for row in rows])
