"""Photometric files of lamps (IES Texture nodes), and lamps of objects that are scaled, against Cycles."""

import math
import os
import tempfile
import unittest
import unittest.mock

import bpy
from addon_support import CyclesTest, mean, render
from covtrace_blender import photometry


def ies(vertical, horizontal, candela, tilt="NONE", kind=1):
    """The text of a photometric file; candela(vertical, horizontal): of degrees."""
    lines = ["IESNA:LM-63-2002", "[MANUFAC] nobody", f"TILT={tilt}", f"1 1000 2 {len(vertical)} {len(horizontal)} {kind} 2 0 0 0", "0.9 1 20",
             " ".join(map(str, vertical)), " ".join(map(str, horizontal))]
    return "\n".join(lines + [" ".join(f"{candela(v, h):.4f}" for v in vertical) for h in horizontal]) + "\n"


def one_sided(v, h):
    return 300 * (1.2 + math.cos(math.radians(v))) * (1 + 0.6 * math.cos(math.radians(h)) + 0.3 * math.sin(math.radians(h)))


def mirrored(v, h):
    return 300 * (1.2 + math.cos(math.radians(v))) * (1 + 0.6 * math.cos(math.radians(2 * h)))


def beam(v, h):
    return 900 * max(0, 1 - v / 70)


class PhotometryTest(CyclesTest):
    def setUp(self):
        super().setUp()
        matt = self.shader("BsdfDiffuse", "matt", Color=(0.6, 0.5, 0.4, 1))
        self.thing("plane", matt, size=20)
        self.camera.data.lens = 20
        # A picture of the whole plane needs no image of a million texels
        size = unittest.mock.patch.object(photometry, "SIZE", 256)
        size.start()
        self.addCleanup(size.stop)

    def photometric(self, kind, text, rotation=(0.4, 0.2, 0.5), scale=(1, 1, 1), **values):
        lamp = self.lamp(kind, energy=20, location=(0.3, 0, 2.5), **values)
        lamp.rotation_euler, lamp.scale = rotation, scale
        lamp.data.use_nodes = True
        tree = lamp.data.node_tree
        node = tree.nodes.new("ShaderNodeTexIES")
        node.mode, node.ies = "INTERNAL", bpy.data.texts.new("luminaire")
        node.ies.write(text)
        node.inputs["Strength"].default_value = 0.5
        tree.links.new(node.outputs["Fac"], tree.nodes["Emission"].inputs["Strength"])
        return lamp, node

    def assert_lamp_as_cycles(self, *arguments, tolerance=0.03, **values):
        lamp, node = self.photometric(*arguments, **values)
        with self.subTest(kind=arguments[0], **values):
            self.assert_parts_as_cycles(tolerance, 64, samples_of_cycles=128)
            self.export()
            self.assertEqual(self.warnings, [])
        bpy.data.objects.remove(lamp)

    def test_symmetries(self):
        steps = list(range(0, 181, 10))
        for horizontal, candela in ((range(0, 361, 15), beam), (range(0, 91, 15), mirrored), (range(0, 181, 15), mirrored),
                                    (range(0, 361, 15), one_sided), (range(0, 360, 15), one_sided), (range(90, 271, 15), mirrored)):
            self.assert_lamp_as_cycles("POINT", ies(steps, list(horizontal), candela), shadow_soft_size=0)
        self.assert_lamp_as_cycles("POINT", ies(range(0, 91, 5), range(0, 361, 15), beam), shadow_soft_size=0)

    def test_one_horizontal_angle_is_all_of_them(self):
        # Cycles 4.5 takes nothing for the neighbours of the first and the last angle, 8 % more light in the mean.
        pictures = []
        for horizontal in ([0], range(0, 361, 15)):
            lamp, _ = self.photometric("POINT", ies(range(0, 181, 10), horizontal, beam), shadow_soft_size=0)
            pictures.append(mean(render("COVTRACE", 64)))
            bpy.data.objects.remove(lamp)
        for a, b in zip(*pictures):
            self.assertAlmostEqual(a / b, 1, delta=1e-3)

    def test_lamps_with_a_radius_and_scales(self):
        text = ies(range(0, 181, 10), range(0, 361, 15), one_sided)
        self.assert_lamp_as_cycles("POINT", text, shadow_soft_size=0.2)
        self.assert_lamp_as_cycles("POINT", text, shadow_soft_size=0.2, scale=(2, 1, 1))

    @unittest.skipIf(bpy.app.version < (4, 0), "spots before 4.0 have other edges")
    def test_spots_and_scales(self):
        text = ies(range(0, 181, 10), range(0, 361, 15), one_sided)
        for radius in (0, 0.2):
            for scale in ((1, 1, 1), (1.5, 1, 0.8)):
                self.assert_lamp_as_cycles("SPOT", text, tolerance=0.04, shadow_soft_size=radius, spot_size=1.8, spot_blend=0.4, scale=scale)

    def test_suns_have_the_light_straight_down(self):
        text = ies(range(0, 181, 10), range(0, 361, 15), lambda v, h: 600 + v)
        self.assert_lamp_as_cycles("SUN", text)
        self.photometric("AREA", text, size=0.5)
        self.export()
        self.assertEqual(len(self.warnings), 1, self.warnings)

    def test_files_and_what_is_linked(self):
        lamp, node = self.photometric("POINT", "", shadow_soft_size=0)
        tree = lamp.data.node_tree
        with tempfile.TemporaryDirectory() as folder:
            node.mode, node.filepath = "EXTERNAL", os.path.join(folder, "lamp.ies")
            with open(node.filepath, "w", encoding="ascii") as file:
                file.write(ies(range(0, 181, 10), range(0, 361, 15), beam, "INCLUDE\n1\n2\n0 90\n1 1"))
            mapping, place, product = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Mapping", "TexCoord", "Math"))
            mapping.inputs["Rotation"].default_value = (0.5, 0.2, 0)
            product.operation = "MULTIPLY"
            tree.links.new(place.outputs["Normal"], mapping.inputs["Vector"])
            tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
            tree.links.new(node.outputs["Fac"], product.inputs[0])
            tree.links.new(product.outputs["Value"], tree.nodes["Emission"].inputs["Strength"])
            self.assert_parts_as_cycles(0.03, 64, samples_of_cycles=128)
            self.export()
            self.assertEqual(self.warnings, [])

    def test_damaged_files_are_left_out_with_a_warning(self):
        good = ies(range(0, 181, 10), [0], beam)
        lamp, node = self.photometric("POINT", good, shadow_soft_size=0)
        for text, what in ((good[:200], "ends within its candelas"), (good.replace("TILT", "TALT"), "no line TILT="), ("", "no line TILT="),
                           (ies(range(0, 181, 10), [0], beam, kind=3), "type is 3"), (ies([0, 20, 10], [0], beam), "do not rise"),
                           (good.replace("[", "", 1).replace("900.0000", "much"), "no number"), (ies([0, 90], [0, 100], beam), "end at 100")):
            node.ies.clear()
            node.ies.write(text)
            text = self.export()
            self.assertEqual(len(self.warnings), 1, self.warnings)
            self.assertIn(f"lamp '{lamp.name}': its photometric file is left out: ", self.warnings[0].replace(lamp.data.name, lamp.name))
            self.assertIn(what, self.warnings[0])
            self.assertIn('LightSource "point"', text)

    @unittest.skipIf(bpy.app.version < (4, 0), "spots before 4.0 have other edges")
    def test_spots_of_objects_that_are_scaled(self):
        for scale in ((0.5, 1, 1), (2, 1, 1), (1, 1, 2), (0.5, 0.5, 0.5)):
            for radius in (0, 0.2):
                lamp = self.lamp("SPOT", energy=100, spot_size=1.2, spot_blend=0.5, shadow_soft_size=radius, location=(0.3, 0, 2.5))
                lamp.scale, lamp.rotation_euler = scale, (0.3, 0.2, 0.5)
                with self.subTest(scale=scale, radius=radius):
                    self.assert_parts_as_cycles(0.04, 64, samples_of_cycles=128)
                    self.export()
                    self.assertEqual(self.warnings, [])
                bpy.data.objects.remove(lamp)
