"""Layouts in which each place of a body has texels of its own: charts side by side in one image."""

import numpy as np

from .charts import Charts

MARGIN = 4  # texels around charts that show the surface as it would go on, for filters that reach beyond
LEAST_MARGIN = 1
LARGEST_SIDE = 8192
TILE = 64  # texels are in the order of squares of this side, so that those of one go at once
CANDIDATES = 1 << 20  # pairs of texel and triangle looked at at once
ROUNDS = 5  # of cuts through charts that lie on themselves; the last one leaves none


class Texels:
    """The k texels that show something: rows and columns (from the top), triangle, and `weights`, (k, 2) of the triangle's second and
    third corner. inside: how many triangles it is well inside of."""

    def __init__(self, rows, columns, triangle, weights, inside):
        self.rows, self.columns, self.triangle, self.weights, self.inside = rows, columns, triangle, weights, inside


class Atlas:
    """Texels of a body. width, height; corner_uvs: (n, 3, 2), the places of its triangles' corners in the unit square, v upwards. chart:
    (n,) that of each triangle. slopes: (n, 2, 2), the change of `weights` per texel to the right and down."""

    def __init__(self, corners, triangles, density, most_texels):
        """corners: (n, 3, 3) of triangles; triangles: (n, 3) vertices. density: (n,) texels per unit of `corners`, in steps of 2,
        of which all are lowered together where there would be more than `most_texels`."""
        cells = np.log2(density / density.min()).round().astype(np.int64)
        for attempt in range(ROUNDS):
            charts = Charts(corners, triangles, cells)
            self.chart, self._is_border = charts.chart, charts.is_border
            self._lay_out(charts, density, most_texels)
            self._draw()
            doubled = np.zeros(len(triangles), bool)
            doubled[self._texels.triangle[self._texels.inside > 1]] = True
            if not doubled.any():
                break
            cells = _cut(charts, doubled, corners, cells, attempt)

    @property
    def texels(self):
        if self._texels is None:
            self._draw()
        return self._texels

    def forget_texels(self):
        """They are found again when they are asked for."""
        self._texels = None

    def bytes_of_layout(self):
        return sum(values.nbytes for values in (self.at, self.corner_uvs, self.slopes, self.chart, self._is_border))

    def bytes_of_texels(self):
        return 0 if self._texels is None else sum(values.nbytes for values in vars(self._texels).values())

    def _lay_out(self, charts, density, most_texels):
        """Places the charts: `at`, (n, 3, 2) texels to the right and down from the top left."""
        count = charts.chart.max() + 1
        flat = (charts.corners * density[:, None, None]).reshape(-1, 2) * (1, -1)
        owner = np.repeat(charts.chart, 3)
        low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
        np.minimum.at(low, owner, flat)
        np.maximum.at(high, owner, flat)
        self.margin = next((m for m in (MARGIN, 2) if count * (2 * m + 1) ** 2 < 0.25 * most_texels), LEAST_MARGIN)
        share = 1.0
        while True:
            sizes = np.ceil((high - low) * share).astype(np.int64) + 1 + 2 * self.margin
            if sizes.max() > LARGEST_SIDE:
                share *= min(0.9, LARGEST_SIDE / float(sizes.max()))
                continue
            corner, self.width, self.height = _packed(sizes)
            # Charts of a texel each are as small as it gets.
            if self.width * self.height <= most_texels or sizes.max() <= 2 + 2 * self.margin:
                break
            share *= min(0.95, (most_texels / (self.width * self.height)) ** 0.5)
        self.at = (flat - low[owner]) * share + self.margin + 0.5 + corner[owner]
        self.at = self.at.reshape(-1, 3, 2)
        self.corner_uvs = self.at / (self.width, self.height)
        self.corner_uvs[..., 1] = 1 - self.corner_uvs[..., 1]

    def _draw(self):
        """Finds what each texel shows: the triangle that it is in, or the nearest one of its chart."""
        a, b, c = np.moveaxis(self.at, 1, 0)
        first, second = b - a, c - a
        area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        is_flat = np.abs(area) < 1e-9
        safe = np.where(is_flat, 1, area)
        self.slopes = np.stack([np.column_stack((second[:, 1], -first[:, 1])), np.column_stack((-second[:, 0], first[:, 0]))],
                               axis=1) / safe[:, None, None]
        # Weights fall to zero over the height over the opposite side.
        heights = np.abs(safe[:, None]) / np.maximum(np.linalg.norm(np.stack((c - b, second, first), axis=1), axis=2), 1e-30)
        reach = np.where(self._is_border, float(self.margin), 0.0)
        rows, columns = -(-self.height // TILE) * TILE, -(-self.width // TILE) * TILE
        nearest, owner = np.full(rows * columns, np.inf, np.float32), np.full(rows * columns, -1, np.int32)
        inside = np.zeros(rows * columns, np.uint8)
        members = np.flatnonzero(~is_flat)
        starts = np.concatenate((self.at[members, 0], self.slopes[members].reshape(-1, 4), heights[members], reach[members, None]), axis=1)
        for triangle, values, row, column in _boxes(self.at, members, reach, starts, self.width, self.height):
            x, y, right_second, right_third, down_second, down_third, *height, reaches = values
            dx, dy = column + (0.5 - x), row + (0.5 - y)
            of_second, of_third = right_second * dx + down_second * dy, right_third * dx + down_third * dy
            inwards = np.minimum((1 - of_second - of_third) * height[0], np.minimum(of_second * height[1], of_third * height[2]))
            kept = np.flatnonzero(inwards >= -np.maximum(reaches, 1e-3))
            outside = -inwards[kept].astype(np.float32)
            texel = _in_tiles(row[kept], column[kept], columns)
            np.add.at(inside, texel[outside < -1e-3], 1)
            order = np.argsort(-outside)  # the last one that is assigned stays
            outside, texel = outside[order], texel[order]
            better = outside < nearest[texel]
            nearest[texel[better]], owner[texel[better]] = outside[better], triangle[kept][order][better]
        if not (owner >= 0).any():
            owner[0] = 0  # nothing has an extent: a place of the first triangle stands for all
        self._texels = self._found(owner, inside, columns)

    def _found(self, owner, inside, columns):
        """The Texels that an image of so many columns shows, of numbers of triangles in tiles."""
        texel = np.flatnonzero(owner >= 0)
        tile, place = np.divmod(texel, TILE * TILE)
        down, right = np.divmod(tile, columns // TILE)
        row, column = down * TILE + place // TILE, right * TILE + place % TILE
        triangle = owner[texel]
        away = np.column_stack((column, row)) + 0.5 - self.at[triangle, 0]
        weights = np.einsum("ki,kij->kj", away, self.slopes[triangle])
        return Texels(row.astype(np.int32), column.astype(np.int32), triangle, weights, inside[texel])

    def interpolated(self, corners, chosen, shift=(0.0, 0.0)):
        """(m, d) float32 of (n, 3, d) values of corners, at the texels that `chosen` indexes, moved by a share of a texel to the right
        and down."""
        triangle = self.texels.triangle[chosen]
        weights = self.texels.weights[chosen]
        if shift[0] or shift[1]:
            slopes = self.slopes[triangle]
            weights = weights + slopes[:, 0] * shift[0] + slopes[:, 1] * shift[1]
        weights = np.clip(weights, -2, 3)[..., None]  # of slivers, by which margins would go far
        a, b, c = (corners[triangle, i] for i in range(3))
        return (a + (b - a) * weights[:, 0] + (c - a) * weights[:, 1]).astype(np.float32)


def _in_tiles(row, column, columns):
    """The numbers of texels, tile by tile, in an image of so many columns."""
    tile = (row // TILE) * (columns // TILE) + column // TILE
    return (tile * TILE + row % TILE) * TILE + column % TILE


def _packed(sizes):
    """(corners (n, 2), width, height) of rectangles (n, 2) side by side: rows of falling height."""
    width = int(max(sizes[:, 0].max(), np.ceil(np.sqrt(1.05 * sizes.prod(axis=1).sum()))))
    corners = np.empty_like(sizes)
    x = y = height = 0
    order = np.lexsort((sizes[:, 0], -sizes[:, 1]))
    for number, w, h in zip(order.tolist(), *sizes[order].T.tolist()):
        if x + w > width:
            x, y, height = 0, y + height, 0
        corners[number] = x, y
        x += w
        height = max(height, h)
    return corners, width, y + height


def _boxes(at, members, reach, values, width, height):
    """Yields (triangles, their `values` by columns, rows, columns) of the texels in the boxes around triangles and what is within reach
    of them, one entry for each pair of a triangle and a texel."""
    reach = reach[members, None]
    low = np.clip(np.ceil(at[members].min(axis=1) - reach - 0.5), 0, None).astype(np.int64)
    high = np.minimum(np.floor(at[members].max(axis=1) + reach - 0.5).astype(np.int64), (width - 1, height - 1))
    spans = np.maximum(high - low + 1, 0)
    # Row by row: each is a run of texels.
    run = np.repeat(np.arange(len(members)), np.where(spans[:, 0] > 0, spans[:, 1], 0))
    starts = np.cumsum(np.where(spans[:, 0] > 0, spans[:, 1], 0)) - np.where(spans[:, 0] > 0, spans[:, 1], 0)
    row = low[run, 1] + np.arange(len(run)) - starts[run]
    length = spans[run, 0]
    ends = np.cumsum(length)
    first = 0
    while first < len(run):
        before = ends[first - 1] if first else 0
        last = max(first + 1, int(np.searchsorted(ends, before + CANDIDATES, side="right")))
        part = slice(first, last)
        counts = length[part]
        number = np.arange(counts.sum()) - np.repeat(ends[part] - counts - before - low[run[part], 0], counts)
        spread = np.repeat(values[run[part]].T, counts, axis=1)
        yield np.repeat(members[run[part]], counts), spread, np.repeat(row[part], counts), number
        first = last


def _cut(charts, doubled, corners, cells, attempt):
    """(n,) cells with which charts that lie on themselves are cut, earlier cuts being kept: two times into pieces an eighth as large, then
    what is on something else into its triangles, in the end all of these charts. doubled: (n,) which triangles are on others."""
    bad = np.zeros(charts.chart.max() + 1, bool)
    bad[charts.chart[doubled]] = True
    bad = bad[charts.chart]
    if attempt >= 2:
        alone = doubled if attempt == 2 else bad
        piece = np.where(alone, np.arange(1, len(alone) + 1), 0)
    else:
        middles = corners.mean(axis=1)
        low, high = np.full((charts.chart.max() + 1, 3), np.inf), np.full((charts.chart.max() + 1, 3), -np.inf)
        np.minimum.at(low, charts.chart, middles)
        np.maximum.at(high, charts.chart, middles)
        step = np.maximum((high - low).max(axis=1) / 8, 1e-30)[charts.chart]
        piece = np.where(bad, np.floor((middles - low[charts.chart]) / step[:, None]).astype(np.int64) @ (1, 9, 81) + 1, 0)
    return np.unique(cells * (piece.max() + 1) + piece, return_inverse=True)[1]
