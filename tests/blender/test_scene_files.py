"""Scenes that are written to keep, and rendered by the program alone."""

import os
import pathlib
import shutil
import subprocess
import tempfile

import bpy
from addon_support import BlenderTest, HEIGHT, WIDTH, exr, material, mean, render


class SceneFilesTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="covtrace-files-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def picture(self, file):
        """The channels that the program renders of a scene file."""
        image = file.with_suffix(".exr")
        subprocess.run([os.environ["COVTRACE"], "render", file, "-o", image, "--spp", "16", "--quiet", "--layer-names", "blender"],
                       check=True, cwd=self.folder.parent)
        return {name.split(".", 1)[1]: values for name, values in exr.read(str(image)).pixels.items()}

    def test_written_scenes_are_those_that_are_rendered(self):
        plane = self.plane(material(**self.MATT))
        colours = bpy.data.images.new("colours", 4, 4)
        colours.pixels = [v for k in range(16) for v in (k / 15, 0.5, 1 - k / 15, 1)]
        colours.pack()
        nodes = plane.data.materials[0].node_tree
        image = nodes.nodes.new("ShaderNodeTexImage")
        image.image = colours
        nodes.links.new(image.outputs["Color"], nodes.nodes["Principled BSDF"].inputs["Base Color"])
        self.lamp("SUN", energy=2.0)
        bpy.ops.mesh.primitive_cube_add(size=1, location=(1, 0, 1))
        hidden = bpy.context.object  # in viewports, not in renders
        hidden.hide_render = True
        bpy.ops.mesh.primitive_cube_add(size=1, location=(-1, 0, 1))
        bpy.context.object.hide_viewport = True
        self.scene.render.engine = "CYCLES"
        self.assertEqual(bpy.ops.export_scene.covtrace(filepath=str(self.folder / "room")), {"FINISHED"})
        self.assertEqual((self.scene.render.engine, self.scene.render.use_compositing), ("CYCLES", True))
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["room-files", "room.pbrt"])
        self.assertNotIn(str(self.folder), (self.folder / "room.pbrt").read_text())
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        for part in ("room.pbrt", "room-files"):
            (self.folder / part).rename(elsewhere / part)
        ours, theirs = self.picture(elsewhere / "room.pbrt"), render("COVTRACE", 16)
        for x, y in ((x, y) for x in range(0, WIDTH, 8) for y in range(0, HEIGHT, 8)):
            for a, b in zip(mean(ours, x, y, x + 8, y + 8), mean(theirs, x, y, x + 8, y + 8)):
                self.assertAlmostEqual(a, b, delta=1e-5, msg=f"{x} {y}")

    def test_names_that_text_cannot_hold_as_they_are(self):
        self.plane(material(**self.MATT))
        for name in ('the "room"', "a\\b", "two\nlines", "r\u00e4ume 1.2"):
            with self.subTest(name):
                bpy.ops.export_scene.covtrace(filepath=str(self.folder / f"{name}.pbrt"))
                self.picture(self.folder / f"{name}.pbrt")

    def test_layers_that_are_not_rendered_are_written(self):
        self.plane(material(**self.MATT))
        layer = bpy.context.view_layer
        layer.use = False
        bpy.ops.export_scene.covtrace(filepath=str(self.folder / "room.pbrt"))
        self.assertFalse(layer.use)
        self.assertTrue((self.folder / "room.pbrt").is_file())

    def test_what_cannot_be_written_is_an_error(self):
        self.plane(material(**self.MATT))
        (self.folder / "file").write_text("")
        with self.assertRaisesRegex(RuntimeError, "Not a directory.*file"):
            bpy.ops.export_scene.covtrace(filepath=str(self.folder / "file" / "room.pbrt"))
        for path in ("", f"{self.folder}/", str(self.folder / ".pbrt")):
            with self.subTest(path), self.assertRaisesRegex(RuntimeError, "^Error: covtrace: the path '.*' names no file"):
                bpy.ops.export_scene.covtrace(filepath=path)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["file"])
        (self.folder / "folder.pbrt").mkdir()
        with self.assertRaisesRegex(RuntimeError, "^Error: covtrace: '.*folder.pbrt' is a folder"):
            bpy.ops.export_scene.covtrace(filepath=str(self.folder / "folder.pbrt"))
        self.scene.camera = None
        with self.assertRaisesRegex(RuntimeError, "no camera"):
            bpy.ops.export_scene.covtrace(filepath=str(self.folder / "room.pbrt"))
