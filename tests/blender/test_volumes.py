"""Even volumes of materials, against Cycles."""

from unittest import mock

import bpy
from addon_support import BlenderTest, material, mean, render, volume_material
from covtrace_blender.solid import Solid

VISIBLE = ("visible_camera", "visible_diffuse", "visible_glossy", "visible_transmission", "visible_shadow",
           "visible_volume_scatter")


class VolumesTest(BlenderTest):
    def body(self, place, size, kind, surface=None, **inputs):
        """A box whose material has a volume shader."""
        bpy.ops.mesh.primitive_cube_add(size=1, location=place)
        box = bpy.context.object
        box.scale = size
        m = volume_material(kind, **inputs)
        if surface:
            tree = m.node_tree
            output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
            tree.links.new(tree.nodes.new(surface).outputs[0], output.inputs["Surface"])
        box.data.materials.append(m)
        return m

    def glass(self, place, size):
        return self.body(place, size, "ShaderNodeVolumeAbsorption", "ShaderNodeBsdfGlass", Color=(0.2, 0.5, 0.9, 1), Density=1.0)

    def instances(self, obj, *places):
        """Puts copies of a collection that holds an object at places, and takes the object itself away."""
        whole = bpy.data.collections.new(obj.name)
        for collection in obj.users_collection:
            collection.objects.unlink(obj)
        whole.objects.link(obj)
        for place in places:
            copy = bpy.data.objects.new("copy", None)
            copy.instance_type, copy.instance_collection, copy.location = "COLLECTION", whole, place
            self.scene.collection.objects.link(copy)

    def borders(self):
        """(medium of the camera, (inner, outer) medium of each distinct border) of the exported scene."""
        head, content = self.export().split("WorldBegin")
        lines = {line for line in content.splitlines() if line.startswith("MediumInterface")} - {'MediumInterface "" ""'}
        camera = head.split("MediumInterface")[1].split('"')[3] if "MediumInterface" in head else ""
        return camera, sorted(tuple(line.split('"')[1::2]) for line in lines)

    def point(self, place, watts):
        """A lamp without size: of one with it, Cycles has less light in the fog that is near."""
        self.lamp("POINT", location=place, energy=watts, shadow_soft_size=0)

    def assert_as_cycles(self, share, samples=256):
        cycles, depth = self.scene.cycles, self.scene.covtrace.max_depth
        cycles.max_bounces = cycles.volume_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = depth
        cycles.transmission_bounces, cycles.sample_clamp_indirect, cycles.blur_glossy = depth, 0, 0
        ours, theirs = mean(render("COVTRACE", samples)), mean(render("CYCLES", samples))
        for a, b in zip(ours, theirs):
            self.assertAlmostEqual(a, b, delta=share * max(theirs), msg=f"{ours}, {theirs}")
        self.assertGreater(max(theirs), 0.02)

    def test_fog_before_the_camera(self):
        self.body((0, 0, 0), (4, 4, 2), "ShaderNodeVolumeScatter", Color=(1, 0.5, 0.2, 1), Density=0.5, Anisotropy=0.4)
        self.point((1, 0, 0), 200)
        self.assert_as_cycles(0.05)

    def test_volumes_shine_as_in_cycles(self):
        """Thin ones, and those that absorb and scatter their light."""
        self.plane(material(**self.MATT), size=6, z=-1)
        principled = dict(Emission_Strength=0.6, Emission_Color=(1, 0.4, 0.1, 1), Blackbody_Intensity=1.0, Temperature=1600.0)
        self.body((-1, 0, 0), (1, 2, 1), "ShaderNodeEmission", Color=(0.2, 0.5, 1, 1), Strength=0.8)
        self.body((0.2, 0, 0), (1, 1, 1), "ShaderNodeVolumePrincipled", Density=2.0, Color=(0.5, 0.2, 0.2, 1), **principled)
        self.body((1.4, 0, 0), (1, 1, 1), "ShaderNodeVolumePrincipled", Density=0.0, **principled)
        self.assert_as_cycles(0.03)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_fog_around_the_camera_and_what_stands_in_it(self):
        self.body((0, 0, 2), (8, 8, 10), "ShaderNodeVolumePrincipled", Color=(0.5, 0.5, 0.8, 1), Density=0.15)
        self.plane(material(**self.MATT), size=3)
        self.point((0.5, 0, 1.5), 100)
        self.assert_as_cycles(0.05)

    def test_a_clear_body_takes_light_by_its_depth(self):
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.body((0, 0, 0), (20, 20, 2), "ShaderNodeVolumeAbsorption", "ShaderNodeBsdfTransparent", Color=(0.2, 0.5, 0.9, 1),
                  Density=0.6)
        self.assert_as_cycles(0.02, 32)

    def test_glass_that_absorbs_in_fog(self):
        self.body((0, 0, 2), (8, 8, 10), "ShaderNodeVolumeScatter", Density=0.1)
        self.glass((0, 0, 0), (2, 2, 1))
        self.plane(material(**self.MATT), size=6).location.z = -1
        self.point((0, 1, 3), 200)
        text = self.export()
        self.assertIn('MediumInterface "" "medium ', text.split("Camera")[0])
        self.assertEqual(len({line for line in text.splitlines() if line.startswith("MediumInterface")}), 4)
        self.assert_as_cycles(0.05)

    def test_instances_stand_in_media_of_their_own(self):
        self.body((1, 1, 0), (1.8, 4, 2), "ShaderNodeVolumeScatter", Density=0.3)
        self.glass((0, 0, 0), (0.8, 1, 1))
        self.instances(bpy.context.object, (-1, 0, 0), (1, 0, 0), (-1, 1.2, 0))
        self.plane(material(**self.MATT), size=6).location.z = -1.2
        self.point((0, 1, 3), 200)
        camera, borders = self.borders()
        fog = next(outer for _, outer in borders if outer)
        glass = next(name for name in ("medium 0", "medium 1") if name != fog)
        self.assertEqual((camera, borders), ("", sorted([(fog, ""), (glass, ""), ("medium 2", fog)])))
        self.assertEqual(self.export().count("ObjectBegin"), 2)
        self.assert_as_cycles(0.05)

    def test_instances_of_fog_hold_what_stands_in_them(self):
        self.glass((0, 0, 0), (20, 20, 10))
        for vertex in bpy.context.object.data.vertices:
            vertex.co *= 0.1
        self.instances(bpy.context.object, (0, 0, 0))
        self.body((0, 0, 0), (8, 8, 10), "ShaderNodeVolumeScatter", Density=0.1)
        self.instances(bpy.context.object, (30, 0, 2), (0, 0, 2), (-30, 0, 2))
        fog, borders = self.borders()
        self.assertIn(fog, ("medium 0", "medium 1"))
        self.assertEqual(borders, sorted([(fog, ""), ("medium 2", fog)]))

    def test_fog_that_is_not_rendered_fills_nothing(self):
        self.body((0, 0, 2), (8, 8, 10), "ShaderNodeVolumeScatter", Density=0.1)
        fog = bpy.context.object
        self.glass((0, 0, 0), (2, 2, 1))
        fog.visible_camera = False
        self.assertEqual(self.borders(), ("", [("medium 0", ""), ("medium 2", "medium 0")]))
        for name in VISIBLE:
            setattr(fog, name, False)
        self.assertEqual(self.borders(), ("", [("medium 0", "")]))
        fog.visible_camera = True
        self.scene.view_layers[0].use_solid = False
        self.assertEqual(self.borders(), ("", []))

    def test_the_size_of_a_mesh_counts_before_its_scale(self):
        self.body((0, 0, 2), (8e-4, 8e-4, 10e-4), "ShaderNodeVolumeScatter", Density=0.1)
        fog = bpy.context.object
        for vertex in fog.data.vertices:
            vertex.co *= 1e4
        depsgraph = bpy.context.evaluated_depsgraph_get()
        solid = Solid(fog.evaluated_get(depsgraph).data)
        places = [(10 * x - 4000, 7 * x - 3000, 3 * x - 1000) for x in range(400)]
        self.assertTrue(all(solid.holds(place) for place in places))
        self.assertFalse(any(solid.holds((place[0], place[1], 6000)) for place in places))
        self.assertEqual(self.borders(), ("medium 0", [("medium 0", "")]))

    def test_the_same_media_at_once_are_one_medium(self):
        self.body((0, 0, 2), (8, 8, 10), "ShaderNodeVolumeScatter", Density=0.1)
        self.body((0, 0, 5), (2, 2, 2), "ShaderNodeVolumeScatter", Density=0.2)
        self.assertEqual(self.borders(), ("medium 2", [("medium 0", ""), ("medium 2", "medium 0")]))
        self.assertEqual(self.export().count("MakeNamedMedium"), 3)

    def test_only_bodies_whose_boxes_hold_a_place_are_searched(self):
        for x in range(6):
            self.glass((2 * x, 0, 0), (1, 1, 1))
            self.plane(material(**self.MATT), size=0.1).location = (2 * x, 0, 0)
        with mock.patch.object(Solid, "holds", autospec=True, side_effect=Solid.holds) as holds:
            self.export()
        # Each bottle asks where it stands and finds its own box alone; planes have no volume and do not ask.
        self.assertEqual(holds.call_count, 0)

    def test_the_colour_of_a_transparent_around_a_volume_is_told(self):
        m = self.body((0, 0, 0), (4, 4, 2), "ShaderNodeVolumeAbsorption", "ShaderNodeBsdfTransparent", Density=0.5)
        self.export()
        self.assertEqual(self.warnings, [])
        m.node_tree.nodes["Transparent BSDF"].inputs["Color"].default_value = (1, 0.5, 0.5, 1)
        self.export()
        self.assertEqual(self.warnings, ["material 'filled': the colour of 'Transparent BSDF' around a volume is not supported and "
                                         "left out"])

    def test_smoke_of_simulations_is_told(self):
        self.body((0, 0, 0), (4, 4, 2), "ShaderNodeVolumePrincipled")
        fluid = bpy.context.object.modifiers.new("smoke", "FLUID")
        fluid.fluid_type = "DOMAIN"
        self.export()
        self.assertEqual(self.warnings, ["object 'Cube': the grids of its fluid simulation are not read; its cache of OpenVDB can be a volume object"])
        fluid.fluid_type = "NONE"
        self.export()
        self.assertEqual(self.warnings, [])

    def test_colours_and_numbers_shine_in_volumes(self):
        m = self.body((0, 0, 0), (4, 4, 2), "ShaderNodeVolumeScatter", Density=0.5)
        tree = m.node_tree
        for kind, value in (("ShaderNodeRGB", (0.1, 0.2, 0.3, 1)), ("ShaderNodeValue", 0.2)):
            node = tree.nodes.new(kind)
            node.outputs[0].default_value = value
            tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
            with self.subTest(kind):
                self.assert_as_cycles(0.02)
                self.export()
                self.assertEqual(self.warnings, [])

    def test_volumes_that_are_none_are_told_and_hide_nothing(self):
        m = self.body((0, 0, 0), (4, 4, 2), "ShaderNodeVolumeScatter", Density=0.5)
        tree = m.node_tree
        surface = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        for value in mean(render("COVTRACE", 4)):
            self.assertAlmostEqual(value, 1, delta=0.01)
        self.export()
        self.assertIn("volume is not supported", self.warnings[0])
