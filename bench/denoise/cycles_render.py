"""Scenes for Cycles, all our own, and their renders. Run by a Python that has `bpy` (4.2 or newer), or inside Blender:

    python bench/denoise/cycles_render.py -- NAME FILTER SAMPLES SEED IMAGE.exr [+ NAME ...]

FILTER is a pixel filter of Cycles: BLACKMAN_HARRIS (its own choice, 1.5 pixels wide) or BOX. Writes multilayer files with
denoising data. Files that are there are kept. Prints one line for each image that it makes."""
import math
import pathlib
import sys
import time

if "--help" in sys.argv:  # before what only Blender has
    print(__doc__)
    sys.exit()
import bpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from render_jobs import jobs  # noqa: E402

WIDTH, HEIGHT = 128, 96


def material(name, colour, roughness=0.5, metallic=0.0, transmission=0.0):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    inputs = made.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*colour, 1)
    inputs["Roughness"].default_value = roughness
    inputs["Metallic"].default_value = metallic
    inputs["Transmission Weight"].default_value = transmission
    return made


def textured(name, kind, scale, roughness=0.5):
    """A material coloured by one of Blender's textures, in the coordinates of the object."""
    made = material(name, (0.6, 0.6, 0.6), roughness)
    tree = made.node_tree
    texture, place = tree.nodes.new(kind), tree.nodes.new("ShaderNodeTexCoord")
    texture.inputs["Scale"].default_value = scale
    tree.links.new(place.outputs["Object"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return made


def add(shape):
    bpy.context.object.data.materials.append(shape)
    return bpy.context.object


def plane(location, rotation, size, shape):
    bpy.ops.mesh.primitive_plane_add(size=1, location=location, rotation=[math.radians(a) for a in rotation])
    bpy.context.object.scale = (*size, 1)
    add(shape)


def ball(location, radius, shape):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=location, segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    add(shape)


def block(location, size, turned, shape):
    bpy.ops.mesh.primitive_cube_add(size=1, location=location, rotation=(0, 0, math.radians(turned)))
    bpy.context.object.scale = size
    add(shape)


def lamp(kind, location, energy, size, rotation=(0, 0, 0)):
    bpy.ops.object.light_add(type=kind, location=location, rotation=[math.radians(a) for a in rotation])
    data = bpy.context.object.data
    data.energy = energy
    if kind == "AREA":
        data.size = size
    else:
        data.shadow_soft_size = size


def camera(location, tilt, focal=50):
    bpy.ops.object.camera_add(location=location, rotation=(math.radians(tilt), 0, 0))
    bpy.context.scene.camera = bpy.context.object
    bpy.context.object.data.lens = focal


def sky(colour, strength):
    background = bpy.context.scene.world.node_tree.nodes["Background"]
    background.inputs[0].default_value = (*colour, 1)
    background.inputs[1].default_value = strength


def balls():
    """Red, glass, gold and blue balls on checkers: a caustic behind the glass."""
    sky((0.5, 0.6, 0.8), 0.4)
    plane((0, 0, 0), (0, 0, 0), (12, 12), textured("floor", "ShaderNodeTexChecker", 24))
    for location, colour, roughness, metallic, transmission in [
            ((-1.6, 0, 0.7), (0.8, 0.2, 0.1), 0.3, 0, 0), ((0, 0, 0.7), (1, 1, 1), 0.02, 0, 1),
            ((1.6, 0, 0.7), (0.9, 0.7, 0.3), 0.15, 1, 0), ((0.6, 1.8, 0.7), (0.1, 0.3, 0.8), 0.6, 0, 0)]:
        ball(location, 0.7, material("ball", colour, roughness, metallic, transmission))
    lamp("AREA", (2.5, -2, 3.5), 150, 0.6, (40, 25, 0))
    camera((0, -5.5, 2.4), 70)


def closed_room(back):
    plane((0, 0, 0), (0, 0, 0), (4, 6), material("floor", (0.5, 0.45, 0.4)))
    plane((0, 0, 2), (180, 0, 0), (4, 6), material("ceiling", (0.8, 0.8, 0.8)))
    plane((0, 2, 1), (90, 0, 0), (4, 2), back)
    plane((0, -3, 1), (-90, 0, 0), (4, 2), material("front", (0.6, 0.6, 0.6)))
    plane((-2, 0, 1), (0, 90, 0), (2, 6), material("left", (0.7, 0.2, 0.15)))
    plane((2, 0, 1), (0, -90, 0), (2, 6), material("right", (0.2, 0.6, 0.25)))


def attic():
    """A closed room by the light that a lamp throws at its ceiling, with a brick wall."""
    closed_room(textured("bricks", "ShaderNodeTexBrick", 6))
    lamp("AREA", (-1.1, 1.2, 1.2), 20, 0.4, (180, 0, 0))
    block((0.6, 0.8, 0.4), (0.7, 0.7, 0.8), 25, material("block", (0.7, 0.7, 0.7)))
    ball((-0.5, 0.2, 0.35), 0.35, material("ball", (0.3, 0.2, 0.6), 0.2))
    camera((0, -2.9, 1), 90, 40)


def night():
    """Glass and polished metal in a closed room with one small lamp: caustics and fireflies."""
    closed_room(material("back", (0.55, 0.55, 0.6)))
    lamp("POINT", (0.5, 0.6, 1.7), 40, 0.05)
    ball((-0.6, 0.5, 0.45), 0.45, material("glass", (1, 1, 1), 0.0, 0, 1))
    ball((0.6, -0.2, 0.3), 0.3, material("metal", (0.95, 0.6, 0.4), 0.08, 1))
    block((0.6, 1.2, 0.5), (0.6, 0.6, 1), 25, material("copper", (0.9, 0.5, 0.3), 0.2, 1))
    camera((0, -2.9, 1), 88, 40)


def focus():
    """Rows of balls through a wide lens under an even sky and a sun: features have noise, too."""
    sky((0.6, 0.7, 0.9), 0.6)
    plane((0, 0, 0), (0, 0, 0), (30, 30), textured("waves", "ShaderNodeTexVoronoi", 60))
    for row in range(4):
        for column in range(5):
            hue = (row * 5 + column) / 20
            colour = [0.5 + 0.4 * math.cos(math.tau * (hue + k / 3)) for k in range(3)]
            ball((1.3 * (column - 2), 2.0 * row - 2.5, 0.5), 0.5, material("ball", colour, 0.1 + 0.15 * row, float(column == 2)))
    lamp("SUN", (0, 0, 5), 3, 0.02, (50, 20, 0))
    camera((0, -6, 2.2), 74, 45)
    lens = bpy.context.object.data.dof
    lens.use_dof, lens.focus_distance, lens.aperture_fstop = True, 6.0, 0.25


SCENES = {f.__name__: f for f in (balls, attic, night, focus)}


def make(name):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    sky((0, 0, 0), 0)
    SCENES[name]()
    layer = scene.view_layers[0]
    layer.use_pass_z = True
    layer.cycles.denoising_store_passes = True
    image = scene.render.image_settings
    if hasattr(image, "media_type"):  # from 5.0 on
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format, image.color_depth = "OPEN_EXR_MULTILAYER", "32"
    return scene


def main():
    made = None
    for name, pixel_filter, samples, seed, out in jobs(sys.argv[sys.argv.index("--") + 1:]):
        file = pathlib.Path(out)
        if file.exists():
            continue
        if made != name:
            scene, made = make(name), name
        scene.cycles.pixel_filter_type = pixel_filter
        scene.cycles.samples, scene.cycles.seed = int(samples), int(seed)
        partial = file.with_suffix(".partial.exr")
        scene.render.filepath = str(partial)
        start = time.monotonic()
        bpy.ops.render.render(write_still=True)
        partial.replace(file)
        print(f"{file.name}  {time.monotonic() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main()
