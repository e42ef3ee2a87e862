"""Two balls on checks below a lamp, as in mitsuba.xml, by Cycles. Our own. Run by a Python that has `bpy`:

    python cycles_scene.py OUT.exr SAMPLES SEED KIND

KIND: `plain` is a multilayer file with denoising data, of half floats; `denoised` one that Blender has denoised itself, with
DWAA compression, adaptive sampling and the counts of samples; `reference` is the image alone. The background is transparent."""
import math
import sys

import bpy

WIDTH, HEIGHT = 48, 32


def material(name, colour, roughness=0.5, metallic=0.0):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    inputs = made.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*colour, 1)
    inputs["Roughness"].default_value = roughness
    inputs["Metallic"].default_value = metallic
    return made


def checks():
    made = material("checks", (1, 1, 1))
    tree = made.node_tree
    texture, place = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeTexCoord")
    texture.inputs["Color1"].default_value = (0.15, 0.2, 0.3, 1)
    texture.inputs["Color2"].default_value = (0.8, 0.75, 0.6, 1)
    texture.inputs["Scale"].default_value = 16
    tree.links.new(place.outputs["UV"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return made


def ball(location, shape):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.7, location=location, segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(shape)


def make(kind):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.15, 0.2, 0.3, 1)
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.context.object.data.materials.append(checks())
    ball((-0.9, 0, 0.7), material("plastic", (0.7, 0.15, 0.1), 0.1))
    ball((0.9, -0.3, 0.7), material("copper", (0.95, 0.6, 0.45), 0.45, 1))
    bpy.ops.object.light_add(type="AREA", location=(1, -1.5, 3.5))
    bpy.context.object.data.energy, bpy.context.object.data.size = 70, 1.6
    bpy.ops.object.camera_add(location=(0, -5, 1.6), rotation=(math.radians(80), 0, 0))
    scene.camera = bpy.context.object
    scene.camera.data.angle = math.radians(45)
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.cycles.use_adaptive_sampling = kind == "denoised"
    scene.cycles.use_denoising = kind == "denoised"
    scene.render.film_transparent = True
    layer = scene.view_layers[0]
    layer.use_pass_z = True
    layer.cycles.denoising_store_passes = True
    layer.cycles.pass_debug_sample_count = kind == "denoised"
    image = scene.render.image_settings
    image.file_format = "OPEN_EXR" if kind == "reference" else "OPEN_EXR_MULTILAYER"
    image.color_mode, image.color_depth = "RGBA", "16"
    image.exr_codec = "DWAA" if kind == "denoised" else "ZIP"
    return scene


def main():
    out, samples, seed, kind = sys.argv[1:]
    scene = make(kind)
    scene.cycles.samples, scene.cycles.seed = int(samples), int(seed)
    scene.render.filepath = out
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()
