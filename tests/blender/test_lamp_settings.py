"""Settings of lamps beside power, colour and size, against Cycles."""

import math
import unittest

import bpy
from addon_support import CyclesTest


class LampSettingsTest(CyclesTest):
    def setUp(self):
        super().setUp()
        self.thing("plane", self.shader("BsdfDiffuse", "matt", Color=(0.6, 0.5, 0.4, 1)), size=20)

    def assert_as_cycles_with(self, kind, tolerance=0.02, scale=(1, 1, 1), turn=(0, 0, 0), **values):
        lamp = self.lamp(kind, **values)
        lamp.scale, lamp.rotation_euler = scale, turn
        with self.subTest(kind=kind, scale=scale, **values):
            self.assert_parts_as_cycles(tolerance)
            self.export()
            self.assertEqual(self.warnings, [])
        bpy.data.objects.remove(lamp)

    @unittest.skipIf(bpy.app.version < (4, 5), "Blender before 4.5")
    def test_exposure_and_temperature(self):
        self.assert_as_cycles_with("POINT", energy=100, exposure=1.5)
        for kind, energy in (("SUN", 2), ("AREA", 50)):
            self.assert_as_cycles_with(kind, energy=energy, exposure=-0.5, use_temperature=True, temperature=3000, color=(1, 0.8, 0.9))

    @unittest.skipIf(bpy.app.version < (4, 5), "Blender before 4.5")
    def test_light_that_grows_with_the_lamp(self):
        for kind in ("POINT", "SPOT"):
            self.assert_as_cycles_with(kind, energy=100, normalize=False, shadow_soft_size=0.4)
        self.assert_as_cycles_with("SUN", energy=10, normalize=False, angle=0.4)
        for shape in ("SQUARE", "ELLIPSE"):
            self.assert_as_cycles_with("AREA", energy=20, normalize=False, shape=shape, size=1, size_y=2, scale=(1.5, 0.5, 1))

    def test_lamps_of_flat_objects(self):
        self.assert_as_cycles_with("POINT", energy=100, shadow_soft_size=0.2, scale=(1, 1, 0))
        self.assert_as_cycles_with("POINT", energy=100, shadow_soft_size=0, scale=(0, 0, 0))
        self.assert_as_cycles_with("SUN", energy=3, scale=(0, 1, 1), turn=(0.3, 0.2, 0))
        self.assert_as_cycles_with("AREA", energy=30, size=1, scale=(1, 1, 0), turn=(0.3, 0.2, 0))  # dark since 4.0

    def test_spreads_of_area_lamps(self):
        for degrees in (150, 90, 45):
            self.assert_as_cycles_with("AREA", 0.04, energy=30, shape="RECTANGLE", size=1, size_y=2, spread=math.radians(degrees),
                                       location=(0.5, 0, 2))
        self.assert_as_cycles_with("AREA", 0.04, energy=30, shape="DISK", size=1, spread=math.radians(60), scale=(2, 1, 1),
                                   turn=(0.3, 0.2, 0))

    @unittest.skipIf(bpy.app.version < (4, 0), "Blender before 4.0")
    def test_falloff_near_a_lamp(self):
        for soft in (True, False):
            self.assert_as_cycles_with("POINT", 0.03, energy=100, shadow_soft_size=0.5, use_soft_falloff=soft, location=(0.3, 0, 0.8))
            # The edge of a cone is as wide as the lamp, a ball's here and a disc's there.
            self.assert_as_cycles_with("SPOT", 0.04, energy=100, shadow_soft_size=0.4, spot_size=2, use_soft_falloff=soft, location=(0.3, 0, 2))

    @unittest.skipIf(bpy.app.version < (4, 0), "Blender before 4.0")
    def test_links_and_limits_of_lamps_are_told(self):
        lamp = self.lamp("POINT", energy=100)
        self.export()
        self.assertEqual(self.warnings, [])
        lamp.light_linking.receiver_collection = bpy.data.collections.new("lit")
        lamp.light_linking.blocker_collection = bpy.data.collections.new("shading")
        lamp.data.cycles.max_bounces = 2
        lamp.data.update_tag()
        self.export()
        self.assertEqual(len(self.warnings), 3, self.warnings)
