"""Parts of Principled that Blender has since 4.0, against Cycles."""

import math
import unittest

import bpy
from addon_support import BlenderTest, material, mean, render

GREY, METAL, TINT = (0.5, 0.5, 0.5, 1), (0.9, 0.9, 0.9, 1), (0.9, 0.5, 0.2, 1)


@unittest.skipIf(bpy.app.version < (4, 0), "Blender before 4.0")
class PrincipledTest(BlenderTest):
    def assert_brightness(self, tolerance, **inputs):
        """Asserts that a plane in a white surrounding is as bright as in Cycles, seen from above and at 0.8 radian, and that
        nothing is left out."""
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.camera.data.lens = 200
        plane = self.plane(material(**inputs))
        for tilt in (0, 0.8):
            self.camera.location = (0, -5 * math.sin(tilt), 5 * math.cos(tilt))
            self.camera.rotation_euler = (tilt, 0, 0)
            ours, theirs = mean(render("COVTRACE", 64)), mean(render("CYCLES", 64))
            for a, b in zip(ours, theirs):
                self.assertAlmostEqual(a, b, delta=tolerance, msg=f"{inputs} at {tilt}: {ours} against {theirs}")
        self.export()
        self.assertEqual(self.warnings, [])
        bpy.data.objects.remove(plane)

    def test_coats_are_tinted(self):
        coat = dict(Base_Color=GREY, Roughness=0.5, Coat_Tint=TINT)
        self.assert_brightness(0.035, Coat_Weight=1.0, **coat)
        self.assert_brightness(0.02, Coat_Weight=0.5, **coat)
        # Coated metals come out darker whatever the tint.
        self.assert_brightness(0.1, Base_Color=METAL, Metallic=1.0, Roughness=0.3, Coat_Weight=1.0, Coat_Tint=TINT)

    def test_sheens(self):
        # Cycles' fibres are another model: rougher ones are brighter there.
        for roughness in (0.5, 0.6):
            sheen = dict(Roughness=1.0, Specular_IOR_Level=0.0, Sheen_Weight=1.0, Sheen_Roughness=roughness, Sheen_Tint=TINT)
            self.assert_brightness(0.04, Base_Color=(0, 0, 0, 1), **sheen)
            self.assert_brightness(0.06, Base_Color=GREY, **sheen)
