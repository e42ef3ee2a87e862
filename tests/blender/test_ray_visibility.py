"""Lamps, objects, materials and worlds that only some rays see, against Cycles."""

import math
import unittest.mock

import bpy
from addon_support import CyclesTest, mean, render
from covtrace_blender import world_baking

class RayVisibilityTest(CyclesTest):
    def mixed(self, m, output, second):
        """Mixes the shader of a material, or of the world, with another node where an output of Light Path is 1."""
        tree = m.node_tree
        end = next(n for n in tree.nodes if n.type in ("OUTPUT_MATERIAL", "OUTPUT_WORLD")).inputs["Surface"]
        first, mix, path = end.links[0].from_socket, self.node(tree, "MixShader"), self.node(tree, "LightPath")
        tree.links.new(path.outputs[output], mix.inputs[0])
        tree.links.new(first, mix.inputs[1])
        tree.links.new(second.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], end)

    def room(self):
        """A floor, a mirror behind it, and a pane of glass before its left half; the camera looks along y and a little
        down."""
        self.matt = self.shader("BsdfDiffuse", "matt", Color=(0.6, 0.5, 0.4, 1))
        self.thing("plane", self.matt, size=12)
        self.mirror = self.thing("plane", self.shader("BsdfGlossy", "mirror", Color=(0.9, 0.9, 0.9, 1), Roughness=0.0),
                                 (0, 2.5, 1), (math.pi / 2, 0, 0), size=5)
        pane = self.pane = self.thing("cube", self.shader("BsdfGlass", "glass", IOR=1.45), (-1.2, -1.5, 1.2), size=1)
        pane.scale = (2, 0.1, 2)
        self.camera.location, self.camera.rotation_euler = (0, -5, 1.8), (1.4, 0, 0)
        self.camera.data.lens = 30

    def light_sky(self, is_lit):
        """Lights the sky, or darkens it: what casts no shadow still takes a share of the light of skies in Cycles."""
        self.background.inputs["Color"].default_value = (0.5, 0.6, 0.8, 1) if is_lit else (0, 0, 0, 1)

    # -- lamps

    def test_area_lamps_are_seen_in_mirrors_and_through_glass(self):
        self.room()
        lamp = self.lamp("AREA", energy=40, size=1.2, location=(0, 0, 2.6))
        lamp.rotation_euler = (0.5, 0, 0)  # its front turned to the mirror
        behind = self.lamp("AREA", energy=20, size=0.6, location=(-1.2, 0.5, 1), color=(1, 0.4, 0.3))
        behind.rotation_euler = (math.pi / 2, 0, math.pi)  # behind the pane, its front turned to the camera
        seen = self.assert_parts_as_cycles(samples_of_cycles=1500)
        self.assertGreater(max(seen["Combined.R"]), 2)
        # The camera sees them only where it is told to.
        without = mean(seen)[0]
        lamp.visible_glossy = False
        darker = mean(self.assert_parts_as_cycles(samples_of_cycles=1500))[0]
        self.assertLess(darker, 0.98 * without)
        behind.visible_camera = True
        self.assert_parts_as_cycles(samples_of_cycles=1500)

    def test_lamps_with_a_radius_are_seen_in_mirrors_and_let_light_pass(self):
        self.room()
        bpy.data.objects.remove(self.pane)
        self.lamp("POINT", energy=40, shadow_soft_size=0.2, location=(1.4, 0.5, 1.8))
        self.lamp("POINT", energy=20, shadow_soft_size=0.1, location=(1.4, 0.7, 2.5), color=(0.2, 0.4, 1))
        self.assert_parts_as_cycles(samples_of_cycles=3000)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_lamps_that_no_ray_finds_are_not_seen_through_glass(self):
        """Multiple Importance is off in files of before Blender 2.8."""
        self.room()
        bpy.data.objects.remove(self.mirror)
        self.thing("uv_sphere", self.shader("BsdfGlossy", "rough", Roughness=0.5), (1.3, 0.5, 0.6), radius=0.6)
        lamp = self.lamp("POINT", energy=40, shadow_soft_size=0.3, location=(-1.2, 0.5, 1.4))
        seen = max(self.assert_parts_as_cycles(samples_of_cycles=1500)["Combined.R"])
        lamp.data.cycles.use_multiple_importance_sampling = False
        lamp.data.update_tag()
        self.assertLess(max(self.assert_parts_as_cycles(samples_of_cycles=1500)["Combined.R"]), seen / 4)

    def test_lamps_that_no_ray_finds_shine_through_what_scatters(self):
        """Leaves, and glass that is frosted, in Cycles as light is sampled for them."""
        leaf = self.thing("plane", self.shader("BsdfTranslucent", "leaf"), (0, 0, 1), (1.4, 0, 0), size=6)
        lamps = [self.lamp(kind, location=(0, 3, 3), **values) for kind, values in
                 (("POINT", {"energy": 300, "shadow_soft_size": 0.3}), ("SUN", {"energy": 2, "angle": 0.3}))]
        for lamp in lamps:
            lamp.rotation_euler = (-1, 0, 0)
            lamp.data.cycles.use_multiple_importance_sampling = False
        self.camera.location, self.camera.rotation_euler = (0, -5, 1.8), (1.4, 0, 0)
        self.assertGreater(mean(self.assert_parts_as_cycles())[0], 0.1)
        leaf.data.materials[0] = self.shader("BsdfGlass", "frosted", Roughness=0.5)
        for lamp in lamps:
            lamp.data.update_tag()
        self.assertGreater(mean(render("COVTRACE", 64))[0], 0.01)  # a sheet with a front alone differs from Cycles

    # -- objects

    def test_objects_are_seen_by_their_rays(self):
        self.room()
        ball = self.thing("uv_sphere", self.shader("BsdfDiffuse", "red", Color=(0.9, 0.1, 0.1, 1)), (1.3, 0.5, 0.6), radius=0.6)
        self.lamp("POINT", energy=80, shadow_soft_size=0, location=(2, -2, 3))
        means = set()
        for hidden in ((), ("camera",), ("glossy",), ("shadow",), ("camera", "shadow"), ("camera", "glossy", "transmission")):
            with self.subTest(hidden):
                self.light_sky("shadow" not in hidden)
                for ray in ("camera", "diffuse", "glossy", "transmission", "shadow"):
                    setattr(ball, "visible_" + ray, ray not in hidden)
                means.add(round(mean(self.assert_parts_as_cycles())[1], 3))
                self.export()
                self.assertEqual(self.warnings, [])
        self.assertGreater(len(means), 3, means)

    def test_instances_are_seen_by_the_rays_of_their_parents_and_themselves(self):
        self.room()
        self.background.inputs["Color"].default_value = (0.5, 0.6, 0.8, 1)
        ball = self.thing("uv_sphere", self.matt, radius=0.4)
        collection = bpy.data.collections.new("things")
        collection.objects.link(ball)
        self.scene.collection.objects.unlink(ball)
        for x, ray in ((-0.6, "camera"), (0.8, "glossy")):
            empty = bpy.data.objects.new("empty", None)
            empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", collection, (x, 0.8, 0.6)
            setattr(empty, "visible_" + ray, False)
            self.scene.collection.objects.link(empty)
        self.assertEqual(self.export().count("ObjectBegin"), 2)
        self.assert_parts_as_cycles()

    # -- Light Path

    def test_mixtures_by_light_path_are_what_each_ray_sees(self):
        self.room()
        self.lamp("POINT", energy=80, shadow_soft_size=0, location=(2, -2, 3))
        for output, kind, inputs in (("Is Camera Ray", "BsdfTransparent", {}), ("Is Shadow Ray", "BsdfTransparent", {}),
                                     ("Is Glossy Ray", "BsdfDiffuse", {"Color": (0.1, 0.8, 0.1, 1)}),
                                     ("Is Camera Ray", "Emission", {"Color": (0.2, 0.4, 1, 1), "Strength": 0.8})):
            with self.subTest(f"{output} {kind}"):
                self.light_sky(output != "Is Shadow Ray")
                m = self.shader("BsdfDiffuse", "red", Color=(0.9, 0.1, 0.1, 1))
                ball = self.thing("uv_sphere", m, (1.3, 0.5, 0.6), radius=0.6)
                self.mixed(m, output, self.node(m.node_tree, kind, **inputs))
                self.assert_parts_as_cycles()
                self.export()
                self.assertEqual(self.warnings, [])
                bpy.data.objects.remove(ball)

    def test_lamps_shine_more_than_the_camera_sees(self):
        self.room()
        m = self.shader("Emission", "shines", Color=(1, 0.8, 0.6, 1))
        tree = m.node_tree
        path, times = self.node(tree, "LightPath"), self.node(tree, "Math")
        times.operation = "MULTIPLY_ADD"
        times.inputs[1].default_value, times.inputs[2].default_value = -9.5, 10
        tree.links.new(path.outputs["Is Camera Ray"], times.inputs[0])
        tree.links.new(times.outputs[0], next(n for n in tree.nodes if n.type == "EMISSION").inputs["Strength"])
        self.thing("plane", m, (1.5, 0.8, 1.6), (0.3, 0, 0), size=0.7)
        self.assert_parts_as_cycles(samples_of_cycles=3000)

    # -- worlds

    def world_of_two(self):
        self.room()
        self.background.inputs["Color"].default_value = (0.4, 0.5, 0.7, 1)
        tree = self.scene.world.node_tree
        return self.node(tree, "Background", Color=(0.9, 0.2, 0.1, 1))

    def test_worlds_that_the_camera_sees_otherwise(self):
        second = self.world_of_two()
        self.mixed(self.scene.world, "Is Camera Ray", second)
        self.assert_parts_as_cycles()
        self.assertEqual(self.export().count('LightSource "infinite"'), 2)
        self.assertEqual(self.warnings, [])

    def test_baked_worlds_that_rays_see_otherwise(self):
        second = self.world_of_two()
        tree = self.scene.world.node_tree
        gradient = self.node(tree, "TexNoise", Scale=2.0)
        tree.links.new(gradient.outputs["Color"], second.inputs["Color"])
        self.mixed(self.scene.world, "Is Glossy Ray", second)
        with unittest.mock.patch.object(world_baking, "ROWS", 128):
            self.assert_parts_as_cycles()
            self.assertEqual(self.export().count("string filename"), 1 + 3)  # the sky of glossy rays, and meshes
        self.assertEqual(self.warnings, [])

    def test_worlds_are_hidden_from_rays(self):
        self.world_of_two()
        self.lamp("POINT", energy=80, shadow_soft_size=0, location=(2, -2, 3))
        for ray in ("camera", "glossy", "diffuse"):
            with self.subTest(ray):
                setattr(self.scene.world.cycles_visibility, ray, False)
                self.assert_parts_as_cycles()
                setattr(self.scene.world.cycles_visibility, ray, True)
