"""Table cloth: a tileable twill weave, and the chalk marks that lie on it."""

from math import cos, hypot, pi
from random import Random

from .color import linear_byte, smoothstep, srgb_byte
from .files import write_png
from .noise import fractal_field, noise_field

_YARNS = 32
_SIZE = 512
_GREEN = (0.022, 0.205, 0.085)


def write_weave(path):
    """A 2/2 twill of 32 by 32 yarns, seamless, 512 pixels wide: the cloth's reflectance."""
    random = Random(11)
    texels = _SIZE // _YARNS
    warp = [random.gauss(1.0, 0.12) for _ in range(_YARNS)]
    weft = [random.gauss(1.0, 0.12) for _ in range(_YARNS)]
    # A yarn is brightest along its middle, and where it rides over the others.
    across = [0.46 + 0.54 * cos(pi * ((i + 0.5) / texels - 0.5)) for i in range(texels)]
    float_length = 2 * texels
    along = [0.66 + 0.34 * cos(pi * ((i + 0.5) / float_length - 0.5)) for i in range(float_length)]
    fuzz = fractal_field(_SIZE, _SIZE, 128, 128, 2, 21)
    slubs = fractal_field(_SIZE, _SIZE, 5, 5, 3, 31)
    rows = []
    for y in range(_SIZE):
        j, fy = divmod(y, texels)
        row = bytearray()
        for x in range(_SIZE):
            i, fx = divmod(x, texels)
            phase = (i - j) % 4
            if phase < 2:
                # The warp passes over two wefts: rows with phase 1, then 0.
                shade = across[fx] * along[fy + texels * (1 - phase)] * warp[i]
            else:
                # The weft passes over two warps: columns with phase 2, then 3.
                shade = 0.9 * across[fy] * along[fx + texels * (phase - 2)] * weft[j]
            shade *= 1 + 0.12 * fuzz[y][x] + 0.12 * slubs[y][x]
            row += bytes(srgb_byte(1.5 * shade * channel) for channel in _GREEN)
        rows.append(row)
    write_png(path, rows, 3)


def write_chalk(path, width, height, marks):
    """How much of the cloth chalk covers, 0 to 1, without a transfer curve.

    `marks` are (u, v, direction (du, dv), length, width, strength) strokes in units of the
    image's width, v upwards; faint dust lies everywhere.
    """
    dust = fractal_field(width, height, 24, 12, 4, 41)
    grain = noise_field(width, height, width // 3, height // 3, 51)
    cover = [[max(0.0, 0.05 * d - 0.01) for d in row] for row in dust]
    for u, v, (du, dv), length, breadth, strength in marks:
        reach = length + 3 * breadth
        size = hypot(du, dv)
        du, dv = du / size, dv / size
        columns = range(max(0, int((u - reach) * width)), min(width, int((u + reach) * width) + 1))
        lines = range(
            max(0, int(height - (v + reach) * width)),
            min(height, int(height - (v - reach) * width) + 1),
        )
        for y in lines:
            for x in columns:
                px = (x + 0.5) / width - u
                py = (height - y - 0.5) / width - v
                s, t = px * du + py * dv, abs(py * du - px * dv)
                s = max(0.0, abs(s) - length)
                mark = smoothstep(3 * breadth, 0, hypot(s, t))
                mark *= 0.75 + 0.45 * grain[y][x]
                cover[y][x] += strength * max(0.0, mark) * (0.7 + 0.4 * dust[y][x])
    write_png(path, [bytes(linear_byte(c) for c in row) for row in cover], 1)
