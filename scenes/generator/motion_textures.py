"""Image textures of the motion scene: a target for the box, stone tiles and wear for the floor."""

from math import atan2, hypot, pi
from random import Random

from .color import linear_byte, mix, smoothstep, srgb_byte
from .files import write_png
from .noise import fractal_field

_SIZE = 256


def write_target(path):
    """Rings and sectors with hard edges: shows translation and rotation."""
    paper, ink, accent = (0.78, 0.74, 0.62), (0.03, 0.05, 0.12), (0.62, 0.06, 0.03)
    soft = 1.5 / _SIZE
    rows = []
    for y in range(_SIZE):
        row = bytearray()
        for x in range(_SIZE):
            px, py = 2 * (x + 0.5) / _SIZE - 1, 1 - 2 * (y + 0.5) / _SIZE
            radius = hypot(px, py)
            color = paper
            if radius < 0.86:
                sector = (atan2(py, px) / (2 * pi) * 8) % 1.0
                width = soft * 4 / (pi * max(radius, 0.05))
                dark = smoothstep(0, width, sector) - smoothstep(0.5, 0.5 + width, sector)
                color = mix(paper, ink, dark)
            color = mix(accent, color, smoothstep(0.30 - soft, 0.30 + soft, radius))
            color = mix(paper, color, smoothstep(0.14 - soft, 0.14 + soft, radius))
            border = smoothstep(0.93 - soft, 0.93 + soft, max(abs(px), abs(py)))
            row += bytes(srgb_byte(channel) for channel in mix(color, accent, border))
        rows.append(row)
    write_png(path, rows, 3)


def write_tiles(path):
    """Four by four stone tiles of differing tone with grout between them, seamless."""
    random = Random(23)
    tones = [[random.uniform(0.55, 1.15) for _ in range(4)] for _ in range(4)]
    veins = fractal_field(_SIZE, _SIZE, 4, 4, 5, 61)
    edge = _SIZE // 4
    rows = []
    for y in range(_SIZE):
        row = bytearray()
        for x in range(_SIZE):
            vein = veins[y][x]
            tone = tones[y // edge][x // edge] * (1 + 0.22 * vein)
            if abs(vein) < 0.05:
                tone *= 0.75 + 5 * abs(vein)
            if min(x % edge, y % edge) < 2:
                tone = 0.35
            row += bytes(srgb_byte(tone * channel) for channel in (0.42, 0.36, 0.29))
        rows.append(row)
    write_png(path, rows, 3)


def write_wear(path):
    """A grey map, stored without a transfer curve, that darkens the floor in patches."""
    patches = fractal_field(_SIZE, _SIZE, 3, 3, 5, 71)
    rows = [bytes(linear_byte(0.8 + 0.22 * patch) for patch in row) for row in patches]
    write_png(path, rows, 1)
