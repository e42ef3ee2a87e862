"""Trees of nodes beside Cycles, each on a tile of its own: matt tiles in a white world show their colour and nothing else."""

import unittest.mock

import bpy
import numpy as np
from addon_support import BlenderTest, render
from covtrace_blender import baking, export_scene
from node_trees import Tree

SIZE = (128, 96)
TILES = 4  # a row and a column of them; each is 32 x 24 pixels, of which 28 x 20 are looked at, in 4 x 4 regions


class NodeTilesTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.scene.render.resolution_x, self.scene.render.resolution_y = SIZE
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.camera.data.type, self.camera.data.ortho_scale = "ORTHO", TILES
        self.scene.covtrace.method = "uniform"
        # Small images: the choice of their size has a test of its own.
        patch = unittest.mock.patch.object(baking, "LARGEST", 512)
        patch.start()
        self.addCleanup(patch.stop)

    def tile(self, number, material):
        """A plane 1 x 3/4 at its place in the picture, the rows from the top."""
        bpy.ops.mesh.primitive_plane_add(size=1)
        plane = bpy.context.object
        for vertex in plane.data.vertices:
            vertex.co.y *= 0.75
        plane.location = (number % TILES + 0.5 - TILES / 2, 0.75 * (TILES / 2 - 0.5 - number // TILES), 0)
        plane.data.materials.append(material)
        return plane

    def pictures(self, samples=16):
        """Ours and Cycles', (rows, columns, 3) from the top."""
        found = []
        for engine, name in (("COVTRACE", "Noisy Image"), ("CYCLES", "Combined")):
            image = render(engine, samples)
            found.append(np.stack([np.reshape(image[f"{name}.{c}"], SIZE[::-1]) for c in "RGB"], axis=-1))
        return found

    def assert_nodes(self, builds, change=lambda plane: None, region_tolerance=0.03, mean_tolerance=0.03, warnings=(),
                     most_of_structure=0.25, samples=16, has_structure=True):
        """builds: {name: function that shows a node of a Tree}. Asserts that no tile's mean colour is off by more than the
        share `mean_tolerance`, and no region's by more than `region_tolerance` and the share `most_of_structure` of the
        regions' standard deviation, so that a tile's mean does not pass for the tile."""
        for number, (name, build) in enumerate(builds.items()):
            tree = Tree(name)
            build(tree)
            change(self.tile(number, tree.material))
        write, told = export_scene.SceneExporter.write, []

        def listening(exporter):
            path = write(exporter)
            told.extend(exporter.warnings)
            return path

        with unittest.mock.patch.object(export_scene.SceneExporter, "write", listening):
            ours, theirs = self.pictures(samples)
        self.assertEqual(told, list(warnings))
        for number, name in enumerate(builds):
            with self.subTest(name):
                y, x = (24 * (number // TILES) + 2, 32 * (number % TILES) + 2)
                a, b = (p[y:y + 20, x:x + 28].reshape(4, 5, 4, 7, 3).mean(axis=(1, 3)) for p in (ours, theirs))
                text = f"means {a.mean(axis=(0, 1))} against {b.mean(axis=(0, 1))}, worst region {np.abs(a - b).max():.4f}"
                structure = b.std(axis=(0, 1)).max() if has_structure else 1
                self.assertGreater(structure, 0.025, "the tile's regions are alike")
                off = np.abs(a.mean(axis=(0, 1)) - b.mean(axis=(0, 1)))
                self.assertTrue((off <= mean_tolerance * b.mean(axis=(0, 1))).all(), text)
                self.assertLess(np.abs(a - b).max(), min(region_tolerance, most_of_structure * structure), text)
