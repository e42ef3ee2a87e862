"""How few values tell what hangs on the angle of sight: at which cosines it is evaluated, linear in between."""

import numpy as np

from .baked import Baked
from .shader_nodes.evaluator import Evaluator
from .values import Between, ByAngle, Value

# Cosines at which nodes are looked at. They lie close where surfaces are seen edge-on, where Fresnel's reflectance and low powers are steep,
# and straight on, where high powers are.
GRID = np.sort(np.concatenate((np.linspace(0, 1, 129) ** 2, 1 - 0.5 ** np.arange(7, 14)))).astype(np.float32)
BOTH_SIDES = np.concatenate((-GRID[:0:-1], [-1e-6], GRID)).astype(np.float32)  # with those behind the surface
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


def _at_grid(get, place, channels):
    """(GRID or, where it is another behind the surface, BOTH_SIDES; (angles, places * channels)) of a function of an Evaluator. place: has
    each of its places len(BOTH_SIDES) times, one after the other."""
    count = len(place) // len(BOTH_SIDES)
    place.sight = np.tile(BOTH_SIDES, count)
    values = np.broadcast_to(np.reshape(get(Evaluator(place)), (-1, channels)), (len(place), channels))
    values = values.reshape(count, len(BOTH_SIDES), channels).swapaxes(0, 1).reshape(len(BOTH_SIDES), -1)
    front = values[len(GRID):]
    is_alike = np.abs(values[len(GRID) - 2::-1] - front[1:]).max() <= 1e-4 * np.ptp(values)
    return (GRID, front) if is_alike else (BOTH_SIDES, values)


def of_constants(get, place, channels):
    """Baked of what is the same everywhere. The rest as _at_grid has it, with one place."""
    grid, values = _at_grid(get, place, channels)
    chosen = _chosen(grid, values, MOST_CONSTANTS * len(grid) // len(GRID), TOLERANCE, np.max)
    return Baked(constant=values[chosen] if channels > 1 else values[chosen, 0], angles=AtCosines(grid[chosen]))


def of_places(get, place, channels):
    """AtCosines or BetweenTwo of images. The rest as _at_grid has it."""
    grid, values = _at_grid(get, place, channels)
    spread = np.ptp(values)
    shares, low, high = _common_shares(values)
    if high == low:
        return AtCosines(grid[-1:])
    mixed = values[low] + shares[:, None] * (values[high] - values[low])
    if np.abs(mixed - values).mean(axis=1).max() <= TOLERANCE_OF_IMAGES * spread:
        chosen = _chosen(grid, shares[:, None], MOST_CONSTANTS * len(grid) // len(GRID), TOLERANCE, np.max)
        return BetweenTwo(grid[[low, high]], grid[chosen], shares[chosen])
    return AtCosines(grid[_chosen(grid, values, MOST_IMAGES, TOLERANCE_OF_IMAGES, np.mean)])


def _common_shares(values):
    """((angles,) shares, row of the first, row of the second) by which rows are nearest to a mixture of two of them."""
    off = values - values.mean(axis=0)
    # The matrix of rows is small, and has the same first vector.
    along = np.linalg.eigh((off @ off.T).astype(float))[1][:, -1]
    low, high = int(along.argmin()), int(along.argmax())
    if _is_one(values):
        return np.zeros(len(values)), low, low
    return (along - along[low]) / (along[high] - along[low]), low, high


def _is_one(values):
    """Whether all rows are the same."""
    return np.ptp(values, axis=0).max() <= 1e-5 * max(np.abs(values).max(), 1e-30)


def _chosen(grid, values, most, tolerance, of):
    """Indices of rows of (angles, d) values at `grid`, between which the others are linear; of: makes one error of a row's. Each further
    row is the one that is farthest off."""
    if _is_one(values):
        return [len(grid) - 1]
    spread = np.ptp(values)
    chosen = [0, len(grid) - 1]
    while len(chosen) < most:
        errors = of(np.abs(_between(grid, values, chosen) - values), axis=1)
        if errors.max() <= tolerance * spread:
            break
        chosen = sorted((*chosen, int(errors.argmax())))
    return chosen


def _between(grid, values, chosen):
    """(angles, d) values as they would be, linear between the chosen rows."""
    after = np.clip(np.searchsorted(chosen, np.arange(len(grid)), side="right"), 1, len(chosen) - 1)
    first, second = np.array(chosen)[after - 1], np.array(chosen)[after]
    share = ((grid - grid[first]) / (grid[second] - grid[first]))[:, None]
    return values[first] + share * (values[second] - values[first])
