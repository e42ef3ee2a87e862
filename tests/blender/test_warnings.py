"""Warnings of the add-on that many things share are told once for all of them."""

import unittest.mock

import bpy
from addon_support import BlenderTest, material, render
from covtrace_blender import engine
from covtrace_blender.warnings_together import together


class WarningsTest(BlenderTest):
    def test_one_warning_for_many(self):
        toon = ": shader 'Toon BSDF' is not supported; Diffuse of its colour takes its place"
        texts = [f"material 'a'{toon}", "the world is dark", f"material 'b'{toon}", "material 'b': a normal map without a UV map is left out",
                 *(f"object 'x{i}' is grease pencil, which is not rendered" for i in range(5))]
        self.assertEqual(together(texts), [
            f"materials 'a', 'b'{toon}", "the world is dark", "material 'b': a normal map without a UV map is left out",
            "objects 'x0', 'x1', 'x2' and 2 more: grease pencil, which is not rendered"])
        self.assertEqual(together(texts[1:2] + texts[4:5]), texts[1:2] + texts[4:5])

    def test_missing_images_are_told_together(self):
        told = []
        for number in range(5):
            m = material(f"m{number}")
            image = m.node_tree.nodes.new("ShaderNodeTexImage")
            image.image = bpy.data.images.new(f"lost{number}", 4, 4)
            image.image.source, image.image.filepath = "FILE", f"//lost{number}.png"
            m.node_tree.links.new(image.outputs["Color"], m.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
            self.plane(m, size=1, z=0.1 * number)

        def noted(texts):
            told.extend(together(texts))
            return []

        with unittest.mock.patch.object(engine, "together", noted):
            render("COVTRACE", 1)
        self.assertEqual(told, ["5 images have no pixels (are their files missing?), which are magenta, as in Cycles: "
                                "'lost0', 'lost1', 'lost2' and 2 more"])
