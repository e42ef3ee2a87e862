"""Texels that an edge crosses: the value of their middle stands badly for them, and they get the mean of several places."""

import numpy as np

# Second difference along a row or a column, as a share of the image's range, from which a texel is a mean: the middle alone would
# round the width of mortar and the like to whole texels. What is smooth differs from its mean by 1/24 of it.
EDGE = 1 / 8
# Places in such a texel, from its middle, as shares of its width: Hammersley's points, no two of which are in line along an axis.
MANY = [((k + 0.5) / 16 - 0.5, (int(f"{k:04b}"[::-1], 2) + 0.5) / 16 - 0.5) for k in range(16)]
FEW = [((k + 0.5) / 4 - 0.5, (int(f"{k:02b}"[::-1], 2) + 0.5) / 4 - 0.5) for k in range(4)]


def places(edges, texels):
    """The places for so many edges among so many texels: few where the image is nothing but edges."""
    return MANY if len(MANY) * edges <= 2 * texels else FEW


PROBES = 2048  # texels whose means tell whether middles miss something, at most 1 of 64
MISSED = 1 / 50  # of what the image has beyond its median
DEVIATIONS = 3  # of the probes' mean beyond which it is not by chance


def add_means(values, mean_at, group=None, shows=None):
    """Sets texels that an edge crosses in (h, w, n) values of their middles to means; group: as edges has it; shows: (h, w), which texels
    count, or all. mean_at(rows, columns, places): (k, n) means of texels.

    A line thinner than a texel is met by some middles alone: if these were means, and those that miss it were not, it would be darker
    than it is. Where so much is missed that the image as a whole is off, all texels are means.
    """
    found = edges(values, group)
    if shows is None:
        shows = np.ones(found.shape, bool)
    rows, columns = np.nonzero(found & shows)
    if len(rows):
        values[rows, columns] = mean_at(rows, columns, places(len(rows), int(shows.sum())))
    rows, columns = np.nonzero(shows & ~found)
    if _misses(values, mean_at, shows, rows, columns):
        values[rows, columns] = mean_at(rows, columns, FEW)


def _misses(values, mean_at, shows, rows, columns):
    """Whether the middles of texels miss, or show too often, a part of what is in the image."""
    count = min(PROBES, int(shows.sum()) // 64)
    if not len(rows) or not count:
        return False
    probe = np.random.default_rng(0).integers(0, len(rows), count)
    off = mean_at(rows[probe], columns[probe], MANY) - values[rows[probe], columns[probe]]
    shown = values[shows]
    content = np.abs(shown - np.median(shown, axis=0)).mean(axis=0)
    missed = np.abs(off.mean(axis=0, dtype=float))
    is_much = missed * len(rows) > MISSED * content * len(shown)
    return bool((is_much & (missed > DEVIATIONS * off.std(axis=0, dtype=float) / count**0.5)).any())


def edges(values, group=None):
    """(h, w) bool of (h, w, n) values. group: (h, w); only texels of one group are compared."""
    least = EDGE * max(float(np.ptp(values)), 1e-30)
    found = np.zeros(values.shape[:2], bool)
    for axis in (0, 1):
        before, here, after = (tuple(part if i == axis else slice(None) for i in (0, 1))
                               for part in (slice(None, -2), slice(1, -1), slice(2, None)))
        bends = np.abs(values[before] + values[after] - 2 * values[here]).max(-1) > least
        if group is not None:
            bends &= (group[before] == group[here]) & (group[after] == group[here])
        found[here] |= bends
    return found
