"""Texels that an edge crosses are means: lines of any width keep their light."""

import numpy as np
from addon_support import BlenderTest
from covtrace_blender import edges  # after what finds it

SIZE = 256


class EdgesTest(BlenderTest):
    def assert_keeps_light(self, shade, whole, tolerance=0.03):
        """shade: function of x and y in texels, 0 or 1, whose mean is `whole`."""
        rows, columns = (axis.ravel() for axis in np.mgrid[:SIZE, :SIZE])

        def mean_at(rows, columns, places):
            return np.mean([shade(columns + 0.5 + x, rows + 0.5 + y) for x, y in places], axis=0, dtype=np.float32)[:, None]

        values = mean_at(rows, columns, [(0, 0)]).reshape(SIZE, SIZE, 1)
        edges.add_means(values, mean_at)
        self.assertLess(abs(values.mean() / whole - 1), tolerance)

    def test_lines_thinner_than_texels(self):
        for width in (0.2, 0.4, 0.8):
            with self.subTest(width):
                self.assert_keeps_light(lambda x, y: (x + 0.15 * y) % 32 < width, width / 32, 0.05)

    def test_dots_finer_than_texels(self):
        self.assert_keeps_light(lambda x, y: (x % 0.37 < 0.05) & (y % 0.41 < 0.2), 0.05 / 0.37 * 0.2 / 0.41)

    def test_what_has_no_edges_is_left(self):
        asked = []
        values = np.linspace(0, 1, SIZE * SIZE, dtype=np.float32).reshape(SIZE, SIZE, 1)

        def mean_at(rows, columns, places):
            asked.append(len(rows))
            return values[rows, columns]

        edges.add_means(values, mean_at)
        self.assertLessEqual(sum(asked), edges.PROBES)
