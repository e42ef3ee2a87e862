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
