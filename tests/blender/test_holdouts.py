"""Holdouts, against Cycles: the camera sees a hole where they are, and all else is as if they were none."""

import bpy
import numpy as np
import test_view_layers
from addon_support import material
from transparent_films import TransparentFilmTest


class HoldoutsTest(TransparentFilmTest):
    collection = test_view_layers.ViewLayersTest.collection

    def setUp(self):
        """A holdout hides a part of a red cube."""
        super().setUp()
        self.scene.cycles.max_bounces = self.scene.cycles.diffuse_bounces = self.scene.covtrace.max_depth
        bpy.ops.mesh.primitive_cube_add(size=0.9, location=(0.7, -1, 0.45))
        self.hole = bpy.context.object
        self.hole.data.materials.append(material(Base_Color=(0.1, 0.7, 0.1, 1), Specular=0.0, Roughness=1.0))
        self.plane(material(**self.MATT), size=4)
        self.floor = bpy.context.object

    def assert_picture(self):
        # Rough surfaces are brighter in Cycles 3.4, as it sends back more light than falls on them.
        ours = self.assert_quarters(channels=slice(3, 4))
        return ours if bpy.app.version < (4, 0, 0) else self.assert_quarters(0.012)

    def assert_hole(self):
        """The picture is Cycles', with a hole in it, into which filters carry little light."""
        ours = self.assert_picture()
        hole = ours[..., 3] == 0
        self.assertGreater(hole[-36:].mean(), 0.1)
        self.assertLess(np.abs(ours[hole]).max(), 0.01)
        self.assertGreater((ours[..., 3] == 1).mean(), 0.4)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_objects(self):
        self.hole.is_holdout = True
        self.assert_hole()

    def test_collections(self):
        self.collection("holes", self.hole)
        self.scene.view_layers[0].layer_collection.children["holes"].holdout = True
        self.assert_hole()

    def test_shaders(self):
        tree = self.hole.data.materials[0].node_tree
        tree.links.new(tree.nodes.new("ShaderNodeHoldout").outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        self.assert_hole()

    def test_shaders_in_mixtures_are_told(self):
        tree = self.hole.data.materials[0].node_tree
        mix = tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(tree.nodes.new("ShaderNodeHoldout").outputs[0], mix.inputs[1])
        tree.links.new(tree.nodes["Principled BSDF"].outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        self.export()
        name = self.hole.data.materials[0].name
        self.assertEqual([text for text in self.warnings if "Holdout" in text],
                         [f"material '{name}': Holdout is not supported in a mixture with others; black takes its place"])
        self.assertNotIn("holdout", self.export())

    def test_what_makes_instances_has_the_mark(self):
        collection = bpy.data.collections.new("things")
        self.hole.users_collection[0].objects.unlink(self.hole)
        collection.objects.link(self.hole)
        for x in (0, -1.1):
            empty = bpy.data.objects.new("empty", None)
            empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", collection, (x, 0, 0)
            self.scene.collection.objects.link(empty)
            empty.is_holdout = x == 0
        self.assert_hole()

    def test_films_that_are_not_transparent(self):
        """Also where the camera does not see the world."""
        self.scene.render.film_transparent = False
        self.hole.is_holdout = True
        self.assert_hole()
        self.scene.world.cycles_visibility.camera = False
        self.assert_hole()

    def test_holdouts_hide_caught_shadows(self):
        self.hole.is_holdout = self.floor.is_shadow_catcher = True
        ours = self.assert_quarters()
        self.assertEqual(ours[-15, 62].tolist(), [0, 0, 0, 0])
        self.scene.render.film_transparent = False
        self.assert_quarters()

    def test_smoke_before_holdouts_keeps_its_opacity(self):
        self.hole.is_holdout, self.hole.scale = True, (3, 1, 1)
        smoke = self.smoke()
        smoke.location = (0, -1, 0.5)
        ours = self.assert_picture()
        self.assertGreater(((ours[..., 3] > 0.1) & (ours[..., 3] < 0.9)).mean(), 0.1)

    def test_smoke_is_no_holdout(self):
        """Nor is it in Cycles."""
        self.smoke().is_holdout = True
        self.assert_picture()
        self.export()
        self.assertEqual(self.warnings, [])
