"""Colours that hang on the angle of sight: here their mean over all angles, as the disc of a ball shows it in Cycles."""

import bpy
import numpy as np
from addon_support import HEIGHT, WIDTH, BlenderTest, mean, render
from node_trees import Tree


class SightTest(BlenderTest):
    def test_colours_by_the_angle_are_their_mean(self):
        self.camera.data.type, self.camera.data.ortho_scale = "ORTHO", 2.0 * WIDTH / HEIGHT
        self.scene.covtrace.method = "uniform"
        for kind, output, inputs in (("LayerWeight", "Facing", {"Blend": 0.35}), ("LayerWeight", "Fresnel", {"Blend": 0.6}),
                                     ("Fresnel", "Fac", {"IOR": 2.0})):
            tree = Tree("by angle")
            ramp = tree.node("ValToRGB", None, {"Fac": (tree.node(kind, None, inputs), output)})
            ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.05, 0.8, 0.1, 1), (0.9, 0.1, 0.6, 1)
            shader = tree.node("Emission", None, {"Color": (ramp, "Color")})
            tree.link(shader, 0, tree.tree.nodes["Material Output"].inputs["Surface"])
            bpy.ops.mesh.primitive_uv_sphere_add(radius=1, segments=64, ring_count=32)
            bpy.ops.object.shade_smooth()
            ball = bpy.context.object
            ball.data.materials.append(tree.material)
            with self.subTest(kind, output=output):
                ours, theirs = (np.array(mean(render(engine, 16))) for engine in ("COVTRACE", "CYCLES"))
                np.testing.assert_allclose(ours, theirs, rtol=0.04)
                self.export()
                self.assertEqual(len([w for w in self.warnings if "hangs on the angle of sight" in w]), 1, self.warnings)
            bpy.data.objects.remove(ball)
