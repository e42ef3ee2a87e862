"""Polished hardwood: growth rings cut lengthways, fibres and pores; tiles without a seam."""

from math import pi, sin

from .color import mix, srgb_byte
from .files import write_png
from .noise import fractal_field, noise_field


def write_wood(path, width, height, dark, light, rings, seed):
    """Writes reflectance between the colours `dark` and `light`; the grain runs along u."""
    bend = fractal_field(width, height, 3, 2, 3, seed)
    fibre = fractal_field(width, height, 12, height // 8, 3, seed + 10)
    pores = noise_field(width, height, width // 24, height // 2, seed + 20)
    palette = []
    for i in range(512):
        palette.append(bytes(srgb_byte(channel) for channel in mix(dark, light, i / 511)))
    rows = []
    for y in range(height):
        across = rings * y / height
        row = bytearray()
        for b, f, p in zip(bend[y], fibre[y], pores[y]):
            # Sawtooth of early into late wood, softened where it falls back.
            phase = (across + 1.5 * b) % 1.0
            ring = phase * phase if phase < 0.86 else 0.7396 * (1 - phase) / 0.14
            tone = 0.85 - 0.75 * ring + 0.16 * f + 0.08 * sin(2 * pi * (across / 3 + b))
            if p > 0.45:
                tone -= 0.9 * (p - 0.45)
            row += palette[int(511 * min(max(tone, 0.0), 1.0))]
        rows.append(row)
    write_png(path, rows, 3)
