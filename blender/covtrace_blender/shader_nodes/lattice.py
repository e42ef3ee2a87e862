"""Random values of the cells of a grid, each computed once however many places are near it."""

import numpy as np


class Lattice:
    """Values of the cells about n places.

    cells: d arrays (n,) of whole numbers, int32: the cells that the places are in. least, most: of what is added to them.
    values_of: from d arrays (m,) of cells to k arrays (m,).
    """

    def __init__(self, cells, least, most, values_of):
        self._cells, self._values_of, self._tables = cells, values_of, None
        first = [int(axis.min()) + least for axis in cells]
        spans = [int(axis.max()) + most - low + 1 for axis, low in zip(cells, first)]
        if np.prod(np.array(spans, float)) > 2 * len(cells[0]):
            return  # places so far apart share no cells
        self._strides = [int(np.prod(spans[axis + 1:])) for axis in range(len(spans))]
        grid = np.meshgrid(*(np.arange(low, low + span, dtype=np.int32) for low, span in zip(first, spans)), indexing="ij")
        self._tables = values_of([axis.ravel() for axis in grid])
        self._index = sum((axis - np.int32(low)).astype(np.intp) * stride for axis, low, stride in zip(cells, first, self._strides))

    def at(self, offset):
        """k arrays (n,) of the cells that lie by the whole numbers `offset` beside those of the places."""
        if self._tables is None:
            return self._values_of([axis + np.int32(k) if k else axis for axis, k in zip(self._cells, offset)])
        index = self._index + sum(k * stride for k, stride in zip(offset, self._strides))
        return [table.take(index, mode="clip") for table in self._tables]
