"""The ten digits as strokes, and the distance of a point to them: numbers on balls."""

from math import cos, hypot, pi, sin


def _ellipse(cx, cy, rx, ry, start, end, steps=24):
    angles = [(start + (end - start) * i / steps) * pi / 180 for i in range(steps + 1)]
    return [(cx + rx * cos(a), cy + ry * sin(a)) for a in angles]


# Each digit fills x in [-0.3, 0.3], y in [-0.5, 0.5] (y upwards) along the middle of its strokes.
STROKES = {
    "0": [_ellipse(0, 0, 0.29, 0.5, 0, 360, 40)],
    "1": [[(-0.18, 0.28), (0.06, 0.5), (0.06, -0.5)]],
    "2": [_ellipse(0, 0.22, 0.28, 0.28, 165, -35) + [(-0.29, -0.5), (0.3, -0.5)]],
    "3": [
        _ellipse(0, 0.25, 0.25, 0.25, 150, -90),
        _ellipse(0, -0.23, 0.29, 0.27, 90, -155),
    ],
    "4": [[(0.12, -0.5), (0.12, 0.5), (-0.3, -0.2), (0.3, -0.2)]],
    "5": [
        [(0.25, 0.5), (-0.2, 0.5), (-0.24, 0.07)]
        + _ellipse(0, -0.19, 0.3, 0.31, 122, -150)
    ],
    "6": [
        _ellipse(0, -0.2, 0.29, 0.3, 0, 360, 36),
        [(-0.29, -0.2), (-0.24, 0.12), (-0.08, 0.36), (0.16, 0.5)],
    ],
    "7": [[(-0.28, 0.5), (0.28, 0.5), (-0.08, -0.5)]],
    "8": [
        _ellipse(0, 0.26, 0.23, 0.24, 0, 360, 32),
        _ellipse(0, -0.23, 0.29, 0.27, 0, 360, 36),
    ],
    "9": [
        _ellipse(0, 0.2, 0.29, 0.3, 0, 360, 36),
        [(0.29, 0.2), (0.24, -0.12), (0.08, -0.36), (-0.16, -0.5)],
    ],
}


def _segment_distance(x, y, a, b):
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)
    t = 0.0 if t < 0.0 else 1.0 if t > 1.0 else t
    return hypot(x - a[0] - t * dx, y - a[1] - t * dy)


def text_segments(text, height):
    """Segments ((x0, y0), (x1, y1)) of a short number centred on the origin."""
    advance = 0.78
    segments = []
    for index, digit in enumerate(text):
        shift = (index - (len(text) - 1) / 2) * advance
        for stroke in STROKES[digit]:
            points = [(height * (x + shift), height * y) for x, y in stroke]
            segments += list(zip(points, points[1:]))
    return segments


def distance_to(segments, x, y):
    """Distance of (x, y) to the nearest segment."""
    return min(_segment_distance(x, y, a, b) for a, b in segments)
