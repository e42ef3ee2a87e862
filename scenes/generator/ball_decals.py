"""Latitude-longitude images for numbered, striped and spotted balls, in pbrt's sphere uv.

u grows with the angle about +z from +x, v from the pole -z to +z; so image columns are angles
and the top row is +z. Numbers stand upright at +y and -y.
"""

from math import cos, pi, sin, sqrt

from .color import mix, smoothstep, srgb_byte
from .digits import distance_to, text_segments
from .files import write_png

_WIDTH, _HEIGHT = 768, 384
_SOFT = 0.007  # half width of an edge on the unit sphere
_INK = (0.012, 0.012, 0.014)
IVORY = (0.80, 0.76, 0.66)


def _write(path, rows):
    encoded = []
    for row in rows:
        line = bytearray()
        for color in row:
            line += bytes(srgb_byte(channel) for channel in color)
        encoded.append(line)
    write_png(path, encoded, 3)


def _sines_and_heights():
    for y in range(_HEIGHT):
        theta = pi * (y + 0.5) / _HEIGHT
        yield y, sin(theta), cos(theta)


def write_numbered(path, text, color, striped):
    """A ball of one colour, or ivory with a belt of it, with a number in two white discs."""
    disc = 0.46
    segments = text_segments(text, 0.52 if len(text) == 1 else 0.42)
    thickness = 0.060 if len(text) == 1 else 0.048
    directions = [2 * pi * (x + 0.5) / _WIDTH for x in range(_WIDTH)]
    rows = []
    for _, ring, height in _sines_and_heights():
        base = color
        if striped:
            base = mix(color, IVORY, smoothstep(0.5 - _SOFT, 0.5 + _SOFT, abs(height)))
        row = [base] * _WIDTH
        if abs(height) < disc + _SOFT:
            for x, phi in enumerate(directions):
                # Seen from outside, the columns run to the right on both sides.
                side = 1 if phi < pi else -1
                right = -side * ring * cos(phi)
                distance = sqrt(right * right + height * height)
                if distance > disc + _SOFT:
                    continue
                paint = IVORY
                if distance < disc * 0.85:
                    gap = distance_to(segments, right, height) - thickness
                    paint = mix(_INK, IVORY, smoothstep(-_SOFT, _SOFT, gap))
                row[x] = mix(paint, base, smoothstep(disc - _SOFT, disc + _SOFT, distance))
        rows.append(row)
    _write(path, rows)


def write_spotted(path, color, spot_color):
    """A practice cue ball: the twelve corners of an icosahedron as spots show its spin."""
    golden = (1 + sqrt(5)) / 2
    scale = 1 / sqrt(1 + golden * golden)
    corners = []
    for a in (-scale, scale):
        for b in (-golden * scale, golden * scale):
            corners += [(0, a, b), (a, b, 0), (b, 0, a)]
    edge = cos(0.19)
    slope = _SOFT * sin(0.19)
    columns = [2 * pi * (x + 0.5) / _WIDTH for x in range(_WIDTH)]
    columns = [(cos(phi), sin(phi)) for phi in columns]
    rows = []
    for _, ring, height in _sines_and_heights():
        row = []
        for c, s in columns:
            px, py = ring * c, ring * s
            nearest = max(px * x + py * y + height * z for x, y, z in corners)
            row.append(mix(color, spot_color, smoothstep(edge - slope, edge + slope, nearest)))
        rows.append(row)
    _write(path, rows)
