"""Suns with an angle and spots with a radius, against Cycles."""

import math

import bpy
from addon_support import CyclesTest, mean, render


class SoftLampsTest(CyclesTest):
    def sun(self, degrees, rotation, **values):
        sun = self.lamp("SUN", angle=math.radians(degrees), **values)
        sun.rotation_euler = rotation
        return sun

    def floor_and_board(self):
        """A board over a floor, whose shadow the camera sees from above."""
        self.thing("plane", self.shader("BsdfDiffuse", "matt", Color=(0.6, 0.5, 0.4, 1)), size=12)
        board = self.thing("plane", self.shader("BsdfDiffuse", "dark", Color=(0, 0, 0, 1)), (2, 0, 1.5), size=4)
        board.visible_camera = False
        return board

    def shadow(self):
        """Light of the columns of the picture, over the brightest of them."""
        image = render("COVTRACE", 256)
        columns = [mean(image, x, 8, x + 1, 16)[0] for x in range(32)]
        return [c / max(columns) for c in columns]

    def test_suns_cast_soft_shadows(self):
        self.floor_and_board()
        self.sun(25, (0, 0.3, 0), energy=3)
        self.assert_parts_as_cycles(0.03)
        soft = self.shadow()
        self.assertGreater(sum(0.1 < c < 0.9 for c in soft), 3)
        bpy.data.objects["Sun"].data.angle = 0
        self.assertLess(sum(0.1 < c < 0.9 for c in self.shadow()), 3)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_spots_with_a_radius_cast_soft_shadows(self):
        board = self.floor_and_board()
        spot = self.lamp("SPOT", energy=800, spot_size=0.7, spot_blend=0.4, shadow_soft_size=0.4, location=(-1, 0.5, 5))
        spot.rotation_euler = (0, -0.3, 0)
        self.assert_parts_as_cycles(0.05)
        self.assertGreater(sum(0.1 < c < 0.9 for c in self.shadow()), 3)
        # The cone's own edge, without the board
        bpy.data.objects.remove(board)
        self.assert_parts_as_cycles(0.05)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_suns_are_seen_in_mirrors_and_not_by_the_camera(self):
        self.thing("plane", self.shader("BsdfGlossy", "mirror", Color=(0.9, 0.9, 0.9, 1), Roughness=0.0), size=12)
        self.camera.location, self.camera.rotation_euler = (0, -5, 1.8), (1.2, 0, 0)
        self.camera.data.lens = 20
        sun = self.sun(12, (-1.2, 0, -0.3), energy=0.1)  # before the camera on the right, above the horizon
        seen = self.assert_parts_as_cycles()
        self.assertGreater(max(seen["Combined.R"]), 1)
        self.assertLess(mean(seen, 0, 0, 32, 6)[0], 1e-6)
        sun.visible_glossy = False
        self.assertLess(mean(render("COVTRACE", 16))[0], 1e-6)
        sun.visible_camera = True
        self.camera.rotation_euler.x = 1.7
        self.assertGreater(max(self.assert_parts_as_cycles()["Combined.R"]), 1)

    def test_suns_shine_through_panes(self):
        """A room behind a window of a whole pane, lit by the sun alone. Cycles finds it by chance."""
        matt = self.shader("BsdfDiffuse", "matt", Color=(0.7, 0.7, 0.7, 1))
        self.thing("plane", matt, size=8)
        self.thing("plane", matt, (0, 2, 2), (math.pi / 2, 0, 0), size=8)
        for x, size in ((-2.5, 3), (2.5, 3)):  # walls beside the window
            wall = self.thing("cube", matt, (x, -1, 2.5), size=1)
            wall.scale = (size, 0.1, 5)
        pane = self.thing("cube", self.shader("BsdfGlass", "glass", IOR=1.45, Roughness=0.0), (0, -1, 2.5), size=1)
        pane.scale = (2, 0.06, 5)
        self.camera.location, self.camera.rotation_euler = (0, -0.9, 3), (1.0, 0, 0)
        self.camera.data.lens = 18
        self.sun(20, (0.7, 0.2, 0), energy=3)  # from behind the camera, through the pane
        self.assert_parts_as_cycles(samples_of_cycles=4000)
