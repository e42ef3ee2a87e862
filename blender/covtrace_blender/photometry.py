"""Photometric files of luminaires (IES LM-63, type C) as images over directions.

A file tells candelas at vertical angles from straight down (0 degrees, -z of the lamp) to straight up (180) and at horizontal
ones around that axis. Between them Blender interpolates by cubics, as is done here; beyond the vertical angles is nothing.
"""

import numpy as np

# Radiant per luminous intensity times 4 pi: Blender's lamps have watts, and it takes light of D65 with 177.83 lm / W.
WATTS_PER_CANDELA = 4 * np.pi / 177.83

# Texels along each side of an image: 0.2 degrees each, so that the edge of a beam shows no steps.
SIZE = 1024


class Damaged(ValueError):
    """Says what is wrong with a file."""


class Profile:
    """The intensities of a file, in Blender's watts for a lamp of 1 W, at all its angles: `vertical` and `horizontal` ones,
    radians, and `values` by (horizontal, vertical)."""

    def __init__(self, text):
        numbers = _Numbers(_after_tilt(text))
        numbers.next("number of lamps")
        numbers.next("lumens per lamp")
        factor = numbers.next("candela multiplier")
        counts = [numbers.count(f"number of {kind} angles") for kind in ("vertical", "horizontal")]
        kind = numbers.next("photometric type")
        if kind != 1:
            raise Damaged(f"its photometric type is {kind:g}; expected 1 (type C)")
        for what in ("units", "width", "length", "height"):
            numbers.next(what)
        factor *= numbers.next("ballast factor") * numbers.next("ballast-lamp factor")
        numbers.next("input watts")
        vertical, horizontal = (numbers.list(count, f"{what} angles") for count, what in zip(counts, ("vertical", "horizontal")))
        values = numbers.list(counts[0] * counts[1], "candelas").reshape(counts[1], counts[0])
        for angles, what in ((vertical, "vertical"), (horizontal, "horizontal")):
            if (np.diff(angles) <= 0).any():
                raise Damaged(f"its {what} angles do not rise")
        if vertical[0] not in (0, 90) or vertical[-1] > 180 or len(vertical) < 2:
            raise Damaged(f"its vertical angles go from {vertical[0]:g} to {vertical[-1]:g}; expected 0 or 90 to 180 at most")
        horizontal, values = _whole_turn(horizontal, values)
        self.vertical, self.horizontal = np.radians(vertical), np.radians(horizontal)
        self.values = WATTS_PER_CANDELA * factor * values

    def at(self, directions):
        """The intensity in directions (..., 3) away from the lamp, in its space."""
        d = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
        down = np.arccos(np.clip(-d[..., 2], -1, 1))
        around = np.arctan2(d[..., 0], d[..., 1]) + np.pi
        column, x = _interval(self.horizontal, around)
        row, y = _interval(self.vertical, down)
        last = len(self.vertical) - 1
        turn = len(self.horizontal) - 1  # its last column is the first once more
        found = np.zeros(down.shape)
        for i, of_column in enumerate(_cubic(x)):
            columns = self.values[(column + i - 1) % turn]
            for j, of_row in enumerate(_cubic(y)):
                at = row + j - 1
                # Beyond a pole lies the other side of it, which is taken for the same one; beyond other ends lies nothing.
                value = np.take_along_axis(columns, _mirrored(at, last)[..., None], -1)[..., 0]
                if self.vertical[0] > 1e-6:
                    value = np.where(at < 0, 0, value)
                if self.vertical[-1] < np.pi - 1e-6:
                    value = np.where(at > last, 0, value)
                found += of_column * of_row * value
        inside = (down >= self.vertical[0]) & (down < self.vertical[-1])
        return np.where(inside, np.maximum(found, 0), 0)

    def image(self, matrix):
        """(SIZE, SIZE), as pbrt's goniometric lights have it. matrix (3, 3): takes directions of the light's space to those of
        the lamp's."""
        # In parts, for the memory's sake
        return np.concatenate([self.at(directions_of_rows(rows, SIZE) @ np.asarray(matrix).T) for rows in np.array_split(np.arange(SIZE), 16)])


def directions_of_rows(rows, size):
    """(n, size, 3) unit directions of n rows of a goniometric light's image, of as many texels as rows, in the light's space."""
    u, v = np.meshgrid((np.arange(size) + 0.5) / size, (rows + 0.5) / size)
    # The pole of the image is y of the light's space.
    return equal_area_directions(u, v)[..., [0, 2, 1]]


def equal_area_directions(u, v):
    """Unit directions (..., 3) of places in [0, 1]^2 by the map of Clarberg ("Fast equal-area mapping of the (hemi)sphere using
    SIMD", 2008), as pbrt-v4 has it."""
    u, v = 2 * u - 1, 2 * v - 1
    x, y = abs(u), abs(v)
    signed = 1 - (x + y)
    r = 1 - abs(signed)
    turn = np.where(r == 0, 1, (y - x) / np.where(r == 0, 1, r) + 1) * np.pi / 4
    z = np.copysign(1 - r * r, signed)
    length = r * np.sqrt(np.maximum(2 - r * r, 0))
    return np.stack((np.copysign(np.cos(turn), u) * length, np.copysign(np.sin(turn), v) * length, z), -1)


def _after_tilt(text):
    """The words of a file after its labels; commas part them, too."""
    lines = text.replace(",", " ").splitlines()
    tilt = next((number for number, line in enumerate(lines) if line.strip().upper().startswith("TILT=")), None)
    if tilt is None:
        raise Damaged("it has no line TILT=")
    words = " ".join(lines[tilt + 1 :]).split()
    if lines[tilt].strip().upper() != "TILT=INCLUDE":
        return words
    numbers = _Numbers(words)
    numbers.next("lamp to luminaire geometry")
    numbers.list(2 * numbers.count("number of tilt angles"), "tilt factors")
    return words[numbers.place :]


class _Numbers:
    """Words that are read as numbers one after the other."""

    MOST = 1_000_000  # of angles, far above any file

    def __init__(self, words):
        self.words, self.place = words, 0

    def list(self, count, what):
        words = self.words[self.place : self.place + count]
        if len(words) < count:
            raise Damaged(f"it ends within its {what}")
        self.place += count
        try:
            numbers = np.array([float(word) for word in words])
        except ValueError as problem:
            raise Damaged(f"among its {what} is what is no number") from problem
        if not np.isfinite(numbers).all():
            raise Damaged(f"its {what} are not all finite")
        return numbers

    def next(self, what):
        return float(self.list(1, what)[0])

    def count(self, what):
        count = self.next(what)
        if not (1 <= count <= self.MOST and count == int(count)):
            raise Damaged(f"its {what} is {count:g}")
        return int(count)


def _whole_turn(angles, values):
    """Horizontal angles from 0 to 360 and the values there, by the symmetry that the range of the angles stands for."""
    if angles[0] == 90 and angles[-1] == 270:
        angles = angles - 90
    if angles[0] != 0:
        raise Damaged(f"its horizontal angles begin at {angles[0]:g}; expected 0")
    if len(angles) == 1:
        return np.array([0.0, 360.0]), np.concatenate((values, values))
    for end in (90, 180):
        if angles[-1] == end:
            angles = np.concatenate((angles, 2 * end - angles[-2::-1]))
            values = np.concatenate((values, values[-2::-1]))
    if angles[-1] == 360:
        return angles, values
    # Files of a regular step leave out the last angle, which is the first.
    if 360 - angles[-1] not in (angles[-1] - angles[-2], angles[1] - angles[0]):
        raise Damaged(f"its horizontal angles end at {angles[-1]:g}; expected 0, 90, 180 or 360")
    return np.append(angles, 360), np.concatenate((values, values[:1]))


def _interval(knots, x):
    """The interval of rising knots that x lies in, and how far, from 0 to 1."""
    index = np.clip(np.searchsorted(knots, x, side="left") - 1, 0, len(knots) - 2)
    return index, np.clip((x - knots[index]) / (knots[index + 1] - knots[index]), 0, 1)


def _mirrored(index, last):
    index = abs(index)
    return np.clip(np.where(index > last, 2 * last - index, index), 0, last)


def _cubic(t):
    """The weights of four neighbours at the place t between the middle ones (Catmull and Rom, "A class of local interpolating
    splines", 1974)."""
    return (0.5 * t * (t * (2 - t) - 1), 0.5 * (t * t * (3 * t - 5) + 2), 0.5 * t * (t * (4 - 3 * t) + 1), 0.5 * t * t * (t - 1))
