"""Atlases of bodies, without Blender: each place of a surface has a texel that shows it."""

import unittest

import numpy as np

import without_blender  # before the package
from covtrace_blender import body_baking, charts
from covtrace_blender.atlas import Atlas


def tube(place, along, around):
    """(vertices, triangles) of a closed ribbon of quads; place(s, t): (..., 3) of s, t in [0, 1]."""
    s, t = np.meshgrid(np.arange(along + 1) / along, np.arange(around) / around, indexing="ij")
    vertices = place(s, t).reshape(-1, 3)
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(along), np.arange(around), indexing="ij"))
    a, b, c, d = ((i + k) * around + (j + m) % around for k, m in ((0, 0), (1, 0), (1, 1), (0, 1)))
    return vertices, np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))


def ball(along=16, around=32):
    def place(s, t):
        polar, azimuth = np.pi * s, 2 * np.pi * t
        return np.stack((np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)), axis=-1)
    return tube(place, along, around)


def spring(turns=4):
    """A wire that goes round above itself: along z its turns lie on each other."""
    def place(s, t):
        turn, section = 2 * np.pi * turns * s, 2 * np.pi * t
        radius = 1 + 0.2 * np.cos(section)
        return np.stack((radius * np.cos(turn), radius * np.sin(turn), 0.2 * np.sin(section) + turns * s), axis=-1)
    return tube(place, 160, 12)


class AtlasTest(unittest.TestCase):
    def atlas(self, vertices, triangles, density, most_texels=1 << 20):
        return Atlas(vertices[triangles], triangles, np.broadcast_to(np.asarray(density, float), len(triangles)), most_texels)

    def assert_shown(self, vertices, triangles, atlas, texel):
        """Asserts that at random places the interpolated texels around show that place, to within a texel's part."""
        corners = vertices[triangles]
        image = np.full((atlas.height, atlas.width, 3), np.nan)
        image[atlas.texels.rows, atlas.texels.columns] = atlas.interpolated(corners, slice(None))
        random = np.random.default_rng(1)
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        chosen = random.choice(len(corners), 5000, p=area / area.sum())
        weights = random.dirichlet((1, 1, 1), 5000)[..., None]
        place = (corners[chosen] * weights).sum(axis=1)
        uv = (atlas.corner_uvs[chosen] * weights).sum(axis=1)
        x, y = uv[:, 0] * atlas.width - 0.5, (1 - uv[:, 1]) * atlas.height - 0.5
        column, row = np.floor(x).astype(int), np.floor(y).astype(int)
        s, t = (x - column)[:, None], (y - row)[:, None]
        shown = ((image[row, column] * (1 - s) + image[row, column + 1] * s) * (1 - t) +
                 (image[row + 1, column] * (1 - s) + image[row + 1, column + 1] * s) * t)
        self.assertLess(np.linalg.norm(shown - place, axis=1).max(), texel)

    def test_each_place_has_its_texel(self):
        for name, (vertices, triangles), density in (("ball", ball(), 128), ("spring", spring(), 64)):
            with self.subTest(name):
                atlas = self.atlas(vertices, triangles, density)
                self.assert_shown(vertices, triangles, atlas, 0.3 / density)
                self.assertLess(atlas.width * atlas.height, 3 * len(atlas.texels.triangle))

    def test_what_has_no_extent_has_one_texel(self):
        atlas = self.atlas(np.zeros((3, 3)), np.array([[0, 1, 2]]), 64)
        self.assertEqual(len(atlas.texels.triangle), 1)
        self.assertTrue(np.isfinite(atlas.interpolated(np.ones((1, 3, 3)), slice(None))).all())
        far = self.atlas(*ball(), 2.0**-99)
        self.assertEqual(len(far.texels.triangle), 1)

    def test_texels_are_nearly_square_and_right_handed(self):
        vertices, triangles = ball(32, 64)
        corners = vertices[triangles]
        kept = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) > 1e-9
        atlas = self.atlas(vertices, triangles, 64)
        corners, uvs = corners[kept], atlas.corner_uvs[kept] * (atlas.width, atlas.height)
        sides = np.stack((corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        u, v = np.moveaxis(np.linalg.solve(np.stack((uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]), axis=1), sides), 1, 0)
        normals = charts.face_normals(corners)
        self.assertGreater(np.einsum("ij,ij->i", np.cross(u, v), normals).min(), 0)
        lengths = np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1)
        self.assertLess(np.abs(np.log(lengths[0] / lengths[1])).max(), np.log(1.2))

    def test_densities_are_those_that_are_asked(self):
        vertices, triangles = ball()
        upper = vertices[triangles].mean(axis=1)[:, 2] > 0
        atlas = self.atlas(vertices, triangles, np.where(upper, 64, 16))
        self.assert_shown(vertices, triangles, atlas, 0.3 / 16)
        side = (atlas.corner_uvs[:, 1] - atlas.corner_uvs[:, 2]) * (atlas.width, atlas.height)
        spread = np.linalg.norm(side, axis=1)
        self.assertAlmostEqual(np.median(spread[upper]) / np.median(spread[~upper]), 4, delta=0.1)
        small = self.atlas(vertices, triangles, 4096, 1 << 16)
        self.assertLessEqual(small.width * small.height, 1 << 16)

    def test_gaps_are_like_what_is_beside_them(self):
        image, known = np.zeros((5, 7, 1)), np.zeros((5, 7), bool)
        image[1, 1], image[3, 6] = 2, 4
        known[1, 1] = known[3, 6] = True
        found = body_baking.filled(image, known)[..., 0]
        self.assertEqual((found[1, 1], found[0, 0], found[3, 6], found[2, 6]), (2, 2, 4, 4))
        self.assertTrue((found >= 2).all() and (found <= 4).all())


if __name__ == "__main__":
    unittest.main()
