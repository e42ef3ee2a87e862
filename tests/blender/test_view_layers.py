"""View layers, collections, ray visibility and passes, against Cycles."""

import os
import tempfile

import bpy
import numpy as np
from addon_support import HEIGHT, WIDTH, BlenderTest, exr, material, write_layers


def render_layers(engine, samples=64):
    """{view layer: {channel: (rows, columns)}} of one render."""
    scene = bpy.context.scene
    scene.render.engine, scene.covtrace.samples = engine, samples
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = samples, False, False
    write_layers(scene)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "image.exr")
        bpy.ops.render.render(write_still=True)
        pixels = exr.read(scene.render.filepath).pixels
    found = {}
    for name, values in pixels.items():
        layer, channel = name.split(".", 1)
        found.setdefault(layer, {})[channel] = np.reshape(values, (HEIGHT, WIDTH))
    return found


def matt(*colour):
    """As bright here as in Cycles, which Principled is not."""
    m = bpy.data.materials.new("matt")
    m.use_nodes = True
    node = m.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (*colour, 1)
    m.node_tree.links.new(node.outputs[0], m.node_tree.nodes["Material Output"].inputs["Surface"])
    return m


class ViewLayersTest(BlenderTest):
    def setUp(self):
        super().setUp()
        self.background.inputs["Color"].default_value = (0.6, 0.8, 1, 1)

    def collection(self, name, *objects):
        collection = bpy.data.collections.new(name)
        self.scene.collection.children.link(collection)
        for o in objects:
            for old in o.users_collection:
                old.objects.unlink(o)
            collection.objects.link(o)
        return collection

    def cube(self, x, colour):
        bpy.ops.mesh.primitive_cube_add(size=0.8, location=(x, 0, 0.4))
        bpy.context.object.data.materials.append(matt(*colour))
        return bpy.context.object

    def assert_layers_as_cycles(self, names, tolerance=0.03):
        ours, theirs = render_layers("COVTRACE"), render_layers("CYCLES", 256)
        for name in names:
            for channel in "RGB":
                for part in (slice(0, WIDTH // 2), slice(WIDTH // 2, WIDTH)):
                    a, b = (image[name][f"Combined.{channel}"][:, part].mean() for image in (ours, theirs))
                    self.assertAlmostEqual(a, b, delta=tolerance * max(b, 0.05), msg=f"{name} {channel} {part}")
        return ours

    def test_each_view_layer_has_its_objects(self):
        self.collection("left", self.cube(-0.9, (0.9, 0.1, 0.1)))
        self.collection("right", self.cube(0.9, (0.1, 0.8, 0.1)))
        self.collection("hidden", self.cube(0, (1, 1, 1))).hide_render = True
        second = self.scene.view_layers.new("second")
        second.layer_collection.children["left"].exclude = True
        second.samples = 128
        unused = self.scene.view_layers.new("unused")
        unused.use = False
        first = self.scene.view_layers[0].name
        found = self.assert_layers_as_cycles((first, "second"))
        self.assertNotIn("unused", found)
        self.assertGreater(found[first]["Combined.R"].std(), 0.1)
        self.assertAlmostEqual(found["second"]["Debug Sample Count.X"].mean(), 128, delta=8)
        self.assertAlmostEqual(found[first]["Debug Sample Count.X"].mean(), 64, delta=4)

    def test_overrides_and_switches_of_view_layers(self):
        cube = self.cube(-0.9, (0.9, 0.1, 0.1))
        cube.modifiers.new("hair", "PARTICLE_SYSTEM")
        settings = cube.particle_systems[0].settings
        settings.type, settings.count, settings.hair_length, settings.root_radius = "HAIR", 50, 1.5, 4
        names = {}
        for name, value in (("use_solid", False), ("use_strand", False), ("use_sky", False),
                            ("material_override", matt(0.1, 0.2, 0.9))):
            layer = names[name] = self.scene.view_layers.new(name)
            setattr(layer, name, value)
        self.scene.view_layers.remove(self.scene.view_layers[0])
        # Without sky only this lights.
        self.lamp("POINT", energy=100, shadow_soft_size=0)
        found = self.assert_layers_as_cycles(names, 0.04)
        means = [found[name]["Combined.R"].mean() for name in names]
        self.assertEqual(len({round(float(m), 3) for m in means}), 4, means)

    def test_lamps_that_the_camera_does_not_see(self):
        self.background.inputs["Color"].default_value = (0, 0, 0, 1)
        self.plane(matt(0.5, 0.5, 0.5))
        bpy.ops.mesh.primitive_plane_add(size=1, location=(0.5, 0, 2))
        softbox = bpy.context.object
        softbox.data.materials.append(material("shines", Emission=(1, 0.8, 0.5, 1), Emission_Strength=5.0, Base_Color=(0, 0, 0, 1),
                                               Specular=0.0))
        softbox.visible_camera = False
        self.assert_layers_as_cycles([self.scene.view_layers[0].name], 0.04)
        self.export()
        self.assertEqual(self.warnings, [])

    def test_portals_do_not_shine(self):
        self.plane(matt(0.5, 0.5, 0.5))
        portal = self.lamp("AREA", energy=500)
        portal.data.cycles.is_portal = True
        self.assert_as_cycles(0.03)

    def test_what_no_ray_meets_is_left_out(self):
        self.plane(matt(0.5, 0.5, 0.5))
        cube = self.cube(0, (1, 0, 0))
        for ray in ("camera", "diffuse", "glossy", "transmission", "shadow"):
            setattr(cube, "visible_" + ray, False)
        self.assert_as_cycles(0.03)

    def test_visibility_without_counterpart_is_told_once(self):
        for x in (-1, 1):
            sun = self.lamp("SUN", angle=0, location=(x, 0, 3))
            sun.visible_glossy, sun.data.use_shadow = False, False
            if hasattr(sun.data.cycles, "cast_shadow"):  # to Blender 4.5
                sun.data.cycles.cast_shadow = False
        catcher = self.plane(matt(0.5, 0.5, 0.5))
        catcher.is_shadow_catcher = True
        self.export()
        for text in ("'Sun', 'Sun.001': casting shadows", "'Sun', 'Sun.001': lighting diffuse", "'Plane': rendered as surfaces"):
            self.assertEqual(sum(text in w for w in self.warnings), 1, f"{text}: {self.warnings}")

    def test_passes_are_those_of_cycles(self):
        self.plane(matt(0.5, 0.5, 0.5)).rotation_euler = (0.4, 0.2, 0)
        layer = self.scene.view_layers[0]
        layer.use_pass_normal = layer.use_pass_position = layer.use_pass_z = True
        ours, theirs = (render_layers(engine)[layer.name] for engine in ("COVTRACE", "CYCLES"))
        for channel in ("Normal.X", "Normal.Y", "Normal.Z", "Position.X", "Position.Y", "Position.Z"):
            # Cycles' places are those of the first sample.
            self.assertLess(np.abs(ours[channel] - theirs[channel]).mean(), 0.01 if channel[0] == "N" else 0.1, channel)
        self.assertGreater(theirs["Position.X"].std(), 0.5)
