"""Random values of the cells of a grid, each computed once however many places are near it."""

import numpy as np


class Lattice:
    """Values of the cells about n places.

    cells: (n, d) whole numbers, those that the places are in. least, most: of what is added to them. values_of: from
    (m, d) cells to (m, k).
    """

    def __init__(self, cells, least, most, values_of):
        self._cells, self._values_of, self._table = cells, values_of, None
        by_axis = np.ascontiguousarray(cells.T)  # along which extremes are found many times faster
        first = by_axis.min(axis=1) + least
        spans = by_axis.max(axis=1) + most - first + 1
        if np.prod(spans.astype(float)) > 2 * len(cells):
            return  # places so far apart share no cells
        strides = np.cumprod(np.append(1, spans[:0:-1]))[::-1]
        grid = np.stack(np.meshgrid(*(np.arange(span) for span in spans), indexing="ij"), axis=-1)
        self._table, self._strides = values_of(grid.reshape(-1, len(spans)) + first), strides
        self._index = (cells - first) @ strides

    def at(self, offset):
        """(n, k) of the cells that lie by the whole numbers `offset` beside those of the places."""
        if self._table is None:
            return self._values_of(self._cells + np.asarray(offset))
        return np.take(self._table, self._index + np.dot(offset, self._strides), axis=0)
