"""Image textures of the helicopter scene: livery, blades, landing pad and tiles."""

from math import atan2, cos, hypot, pi

from .color import mix, smoothstep, srgb_byte
from .digits import distance_to, text_segments
from .files import write_png
from .helicopter_body import FRONT, TAIL, section
from .noise import fractal_field

RED, CREAM, NAVY = (0.56, 0.022, 0.014), (0.80, 0.74, 0.60), (0.012, 0.028, 0.10)


def _encode(color):
    return bytes(srgb_byte(channel) for channel in color)


def write_livery(path):
    """Red above, cream below, a navy line between; a number on both sides. uv as in the body."""
    width, height = 256, 768  # u around, v along
    text = text_segments("511", 0.36)
    rows = []
    for y in range(height):
        x = TAIL + (FRONT - TAIL) * (1 - (y + 0.5) / height)
        middle, _, half_height = section(x)
        # The line rises from the chin to the boom.
        line = -0.30 + 0.62 * smoothstep(FRONT, -2.2, x)
        soft = 0.012
        row = bytearray()
        for column in range(width):
            u = (column + 0.5) / width
            z = middle + half_height * cos(2 * pi * u)
            color = mix(CREAM, RED, smoothstep(line - soft, line + soft, z))
            stripe = abs(z - line + 0.07) - 0.035
            color = mix(NAVY, color, smoothstep(-soft, soft, stripe))
            if -1.0 < x < 0.2 and abs(z - 0.10) < 0.3:
                # Read from outside, the text runs towards the tail on the left side.
                right = (-0.38 - x) if u < 0.5 else (x + 0.38)
                gap = distance_to(text, right, z - 0.10) - 0.036
                color = mix(CREAM, color, smoothstep(-soft, soft, gap))
            row += _encode(color)
        rows.append(row)
    write_png(path, rows, 3)


def write_blade(path):
    """Cream, with two red bands towards the tip; v along the span."""
    rows = []
    for y in range(256):
        t = 1 - (y + 0.5) / 256
        bands = max(
            smoothstep(low - 0.004, low + 0.004, t) * smoothstep(high + 0.004, high - 0.004, t)
            for low, high in ((0.74, 0.80), (0.90, 1.2))
        )
        rows.append(_encode(mix(CREAM, RED, bands)) * 4)
    write_png(path, rows, 3)


def write_pad(path):
    """The landing pad from above: rings, dashes and an H on worn blue paint."""
    size = 384
    wear = fractal_field(size, size, 9, 9, 4, 83)
    soft = 2.5 / size
    rows = []
    for y in range(size):
        row = bytearray()
        for x in range(size):
            px, py = 2 * (x + 0.5) / size - 1, 1 - 2 * (y + 0.5) / size
            radius = hypot(px, py)
            paint = 1 - smoothstep(0.035 - soft, 0.035 + soft, abs(radius - 0.84))
            dash = (atan2(py, px) / (2 * pi) * 24) % 1.0
            if dash < 0.5:
                paint = max(paint, 1 - smoothstep(0.012 - soft, 0.012 + soft, abs(radius - 0.70)))
            posts = max(abs(abs(px) - 0.26) - 0.075, abs(py) - 0.44)
            bars = min(posts, max(abs(px) - 0.26, abs(py) - 0.075))
            paint = max(paint, 1 - smoothstep(-soft, soft, bars))
            base = mix((0.035, 0.085, 0.15), (0.065, 0.135, 0.21), 0.5 + 0.5 * wear[y][x])
            worn = smoothstep(0.42, 0.62, wear[y][x])
            row += _encode(mix(base, (0.82, 0.78, 0.66), paint * (1 - 0.6 * worn)))
        rows.append(row)
    write_png(path, rows, 3)


def write_tiles(path):
    """A seamless patterned cement tile: four quarter circles, a star and a border of lozenges."""
    size = 384
    clay = fractal_field(size, size, 12, 12, 4, 97)
    cream, blue = (0.66, 0.60, 0.47), (0.055, 0.13, 0.22)
    ochre, brick = (0.60, 0.32, 0.07), (0.36, 0.085, 0.045)
    soft = 2.0 / size
    rows = []
    for y in range(size):
        row = bytearray()
        for x in range(size):
            px, py = 2 * (x + 0.5) / size - 1, 2 * (y + 0.5) / size - 1
            qx, qy = abs(px), abs(py)
            corner = hypot(1 - qx, 1 - qy)
            angle = atan2(py, px)
            star = hypot(px, py) - (0.40 + 0.13 * cos(8 * angle))
            color = mix(brick, cream, smoothstep(-soft, soft, star))
            heart = hypot(px, py) - 0.17
            color = mix(ochre, color, smoothstep(-soft, soft, heart))
            color = mix(blue, color, smoothstep(-soft, soft, abs(corner - 0.56) - 0.09))
            color = mix(ochre, color, smoothstep(-soft, soft, corner - 0.30))
            color = mix(blue, color, smoothstep(-soft, soft, corner - 0.12))
            lozenge = (1 - max(qx, qy)) / 0.26 + min(qx, qy) / 0.15 - 1
            color = mix(brick, color, smoothstep(-soft * 5, soft * 5, lozenge))
            joint = smoothstep(0.985, 0.992, max(qx, qy))
            tone = 1 + 0.16 * clay[y][x]
            row += _encode(tuple(tone * c for c in mix(color, (0.16, 0.15, 0.13), joint)))
        rows.append(row)
    write_png(path, rows, 3)
