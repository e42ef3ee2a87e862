"""Volumes of worlds, which fill all space, against Cycles."""

import os
import pathlib
import subprocess
import tempfile

import bpy
import numpy as np
import test_varying_volumes
import test_volumes
from addon_support import HEIGHT, WIDTH, BlenderTest, material, mean, render
from covtrace_blender import layers
from covtrace_blender.export_camera import viewport_text
from covtrace_blender.export_scene import SceneExporter


class WorldVolumesTest(BlenderTest):
    body, point, glass, borders = (getattr(test_volumes.VolumesTest, name) for name in ("body", "point", "glass", "borders"))
    fine_steps, assert_parts = (getattr(test_varying_volumes.VaryingVolumesTest, name) for name in ("fine_steps", "assert_parts"))

    def fog(self, kind, **inputs):
        """Fills the world by a node of this kind, which is returned."""
        tree = self.scene.world.node_tree
        node = tree.nodes.new(kind)
        for name, value in inputs.items():
            node.inputs[name.replace("_", " ")].default_value = value
        tree.links.new(node.outputs[0], tree.nodes["World Output"].inputs["Volume"])
        return node

    def test_a_lamp_in_fog_that_scatters(self):
        self.fog("ShaderNodeVolumeScatter", Color=(0.9, 0.7, 0.5, 1), Density=0.1, Anisotropy=0.3)
        self.plane(material(**self.MATT), size=4)
        self.point((0.5, 1, 2), 200)
        self.assert_parts(0.05, 256)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_haze_that_absorbs(self):
        self.fog("ShaderNodeVolumeAbsorption", Color=(0.2, 0.5, 0.9, 1), Density=0.15)
        self.plane(material(**self.MATT), size=4)
        self.lamp("AREA", location=(0.5, 1, 2), energy=100, size=0.5)
        self.assert_parts(0.03)

    def test_haze_that_shines(self):
        self.fog("ShaderNodeVolumePrincipled", Density=0.2, Color=(0.3, 0.3, 0.3, 1), Emission_Strength=0.1, Emission_Color=(1, 0.5, 0.2, 1))
        self.plane(material(**self.MATT), size=4)
        self.assert_parts(0.05)

    def test_bodies_in_fog(self):
        """The media in them come to the one that is everywhere."""
        self.fog("ShaderNodeVolumeScatter", Density=0.05)
        self.body((-1, 0, 0), (1, 2, 1), "ShaderNodeVolumeScatter", Density=1.0, Color=(0.9, 0.5, 0.2, 1))
        self.glass((1, 0, 0), (1.2, 1.2, 1))
        self.plane(material(**self.MATT), size=6).location.z = -1
        self.point((0, 1, 3), 200)
        cycles, depth = self.scene.cycles, self.scene.covtrace.max_depth
        cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = depth
        cycles.sample_clamp_indirect, cycles.blur_glossy = 0, 0
        camera, borders = self.borders()
        self.assertEqual(camera, "medium 0")
        self.assertEqual([inner for inner, outer in borders if not outer], ["medium 0"])  # the world's end
        self.assert_parts(0.05, 256)

    def test_no_light_comes_from_infinitely_far(self):
        self.plane(material(**self.MATT), size=4)
        self.lamp("SUN", energy=3)
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.fog("ShaderNodeVolumeScatter", Density=0.01)
        for engine in ("COVTRACE", "CYCLES"):
            self.assertEqual(mean(render(engine, 16)), [0, 0, 0])

    def test_light_comes_in_channels_that_are_clear(self):
        self.plane(material(**self.MATT), size=4)
        self.lamp("SUN", energy=3, color=(1, 0.5, 0.5))
        self.background.inputs["Color"].default_value = (0.5, 0.6, 0.7, 1)
        self.fog("ShaderNodeVolumeAbsorption", Color=(0.5, 1, 1, 1), Density=0.1)
        self.assert_parts(0.03)

    def test_what_cannot_be_is_told(self):
        node = self.fog("ShaderNodeEmission", Strength=0.1)
        self.assertNotIn("MakeNamedMedium", self.export())
        self.assertEqual(self.warnings, ["the world: its volume shines without end, as nothing in it absorbs or scatters; its light is left out"])
        tree = self.scene.world.node_tree
        noise, scatter = tree.nodes.new("ShaderNodeTexNoise"), self.fog("ShaderNodeVolumeScatter", Density=0.2)
        tree.links.new(noise.outputs[0], scatter.inputs["Density"])
        tree.nodes.remove(node)
        self.assertIn('"rgb sigma_s" [0.160000011 0.160000011 0.160000011]', self.export())
        self.assertEqual(len(self.warnings), 1, self.warnings)
        self.assertIn("its place is not known", self.warnings[0])

    def test_viewports_show_it(self):
        self.fog("ShaderNodeVolumeScatter", Density=0.2)
        self.plane(material(**self.MATT), size=4)
        self.point((0.5, 1, 2), 200)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        with tempfile.TemporaryDirectory() as folder:
            exporter = SceneExporter(None, depsgraph, folder)
            content, file = exporter.write_content(), pathlib.Path(folder, "view.pbrt")
            window = self.camera.calc_matrix_camera(depsgraph, x=WIDTH, y=HEIGHT)
            view = viewport_text(self.scene, (WIDTH, HEIGHT), self.camera.matrix_world.inverted(), window)
            file.write_text(f'{exporter.medium_everywhere()}{view}Include "{content}"\n')
            subprocess.run([os.environ["COVTRACE"], "render", file, "-o", f"{file}.exr", "--layers", "none", "--quiet", "--spp", "256"], check=True)
            seen = layers.pixels(layers.read(f"{file}.exr"), "RGB").mean((0, 1))
        self.assertLess(np.abs(seen / mean(render("COVTRACE", 256)) - 1).max(), 0.03)
