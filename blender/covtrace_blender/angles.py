"""How few values tell what hangs on the angle of sight: at which cosines it is evaluated, linear in between."""

import numpy as np

from .baked import Baked
from .shader_nodes.evaluator import Evaluator
from .values import Between, ByAngle, Value

# Cosines at which nodes are looked at. They lie close where surfaces are seen edge-on, where Fresnel's reflectance and low powers are steep,
# and straight on, where high powers are.
GRID = np.sort(np.concatenate((np.linspace(0, 1, 129) ** 2, 1 - 0.5 ** np.arange(7, 14)))).astype(np.float32)
MOST_CONSTANTS, MOST_IMAGES = 24, 6
# Errors that another cosine is not worth, as shares of the range of values: the greatest one of constants; for images, which have
# steps of such size in 8 bits, the mean over places at the worst cosine.
TOLERANCE, TOLERANCE_OF_IMAGES = 0.004, 1 / 255


class AtCosines:
    """Values at each of `cosines`."""

    def __init__(self, cosines):
        self.cosines = cosines

    def value(self, parts):
        """The Value of those at the cosines."""
        return parts[0] if len(parts) == 1 else ByAngle([float(c) for c in self.cosines], parts)


class BetweenTwo:
    """Values at two `cosines`, which all places mix alike: by `shares` of the second at `cosines_of_shares`."""

    def __init__(self, cosines, cosines_of_shares, shares):
        self.cosines, self.cosines_of_shares, self.shares = cosines, cosines_of_shares, shares

    def value(self, parts):
        """The Value of those at the two cosines."""
        shares = [Value(float(share)) for share in self.shares]
        return Between(*parts, ByAngle([float(c) for c in self.cosines_of_shares], shares))


def at_grid(get, place, channels):
    """(angles, places, channels) of a function of an Evaluator at GRID; place: has each of its places len(GRID) times, one after the other."""
    count = len(place) // len(GRID)
    place.sight = np.tile(GRID, count)
    values = np.reshape(get(Evaluator(place)), (-1, channels))
    return np.broadcast_to(values, (len(place), channels)).reshape(count, len(GRID), channels).swapaxes(0, 1)


def of_constants(get, place, channels):
    """Baked of what is the same everywhere. The rest as at_grid has it, with one place."""
    values = at_grid(get, place, channels)[:, 0]
    chosen = _chosen(values, MOST_CONSTANTS, TOLERANCE, np.max)
    return Baked(constant=values[chosen] if channels > 1 else values[chosen, 0], angles=AtCosines(GRID[chosen]))


def of_places(get, place, channels):
    """AtCosines or BetweenTwo of images. The rest as at_grid has it."""
    values = at_grid(get, place, channels).reshape(len(GRID), -1)
    spread = np.ptp(values)
    shares, low, high = _common_shares(values)
    if high == low:
        return AtCosines(GRID[-1:])
    mixed = values[low] + shares[:, None] * (values[high] - values[low])
    if np.abs(mixed - values).mean(axis=1).max() <= TOLERANCE_OF_IMAGES * spread:
        chosen = _chosen(shares[:, None], MOST_CONSTANTS, TOLERANCE, np.max)
        return BetweenTwo(GRID[[low, high]], GRID[chosen], shares[chosen])
    return AtCosines(GRID[_chosen(values, MOST_IMAGES, TOLERANCE_OF_IMAGES, np.mean)])


def _common_shares(values):
    """((angles,) shares, row of the first, row of the second) by which rows are nearest to a mixture of two of them."""
    off = values - values.mean(axis=0)
    # The matrix of rows is small, and has the same first vector.
    along = np.linalg.eigh((off @ off.T).astype(float))[1][:, -1]
    low, high = int(along.argmin()), int(along.argmax())
    if np.abs(values[high] - values[low]).max() <= 1e-5 * max(np.abs(values).max(), 1e-30):
        return np.zeros(len(values)), low, low
    return (along - along[low]) / (along[high] - along[low]), low, high


def _chosen(values, most, tolerance, of):
    """Indices of rows of (angles, d) values at GRID, between which the others are linear; of: makes one error of a row's. Each further
    row is the one that is farthest off."""
    spread = np.ptp(values)
    if np.ptp(values, axis=0).max() <= 1e-5 * max(np.abs(values).max(), 1e-30):
        return [len(GRID) - 1]
    chosen = [0, len(GRID) - 1]
    while len(chosen) < most:
        errors = of(np.abs(_between(values, chosen) - values), axis=1)
        if errors.max() <= tolerance * spread:
            break
        chosen = sorted((*chosen, int(errors.argmax())))
    return chosen


def _between(values, chosen):
    """(angles, d) values as they would be, linear between the chosen rows."""
    after = np.clip(np.searchsorted(chosen, np.arange(len(GRID)), side="right"), 1, len(chosen) - 1)
    first, second = np.array(chosen)[after - 1], np.array(chosen)[after]
    share = ((GRID - GRID[first]) / (GRID[second] - GRID[first]))[:, None]
    return values[first] + share * (values[second] - values[first])
