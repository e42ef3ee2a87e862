"""Scenes that are made in Blender for both sides of bench/speed/peers. Run by a Python that has `bpy`, or inside Blender
(`blender --background --factory-startup -noaudio --python` instead of `python`):

    python bench/speed/blender_scene.py -- make SCENE FOLDER WxH
    python bench/speed/blender_scene.py -- render FOLDER/scene.blend SPP SEED THREADS IMAGE.exr [THRESHOLD [guided]]

`make` writes FOLDER/scene.blend and, by the add-on's exporter, FOLDER/scene.pbrt with the same meshes, materials, lights,
camera, motion and most bounces; it prints Blender's version. `render` is Cycles' render of the .blend: with a noise THRESHOLD
by adaptive sampling and Open Image Denoise at high quality with prefiltered albedo and normal, else without both; `guided`,
with path guiding as Cycles sets it. It prints the CPU seconds of Blender's operator, which are without Blender's own start.

`moving-box`, `many-lamps` and `wide-lens` are one room with other things, lamps and lens: motion blur, shadows and depth of
field. `window`, `door-ajar` and `lampshade` are interiors, a closed room that sun and sky light through a window, a lamp through
the slit of a door, and a lamp in a shade. All is matt or metal, smooth or rough: what both engines compute alike."""
import math
import pathlib
import sys
import time

if "--help" in sys.argv:  # before what only Blender has
    print(__doc__)
    sys.exit()
import bpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST_BOUNCES = 5
SHUTTER = 1.0  # in frames, half of it before the frame


def matt(name, colour):
    return shader(name, "ShaderNodeBsdfDiffuse", Color=(*colour, 1))


def metal(name, colour, roughness):
    return shader(name, "ShaderNodeBsdfGlossy", Color=(*colour, 1), Roughness=roughness)


def shining(name, colour, strength):
    return shader(name, "ShaderNodeEmission", Color=(*colour, 1), Strength=strength)


def shader(name, kind, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    node = tree.nodes.new(kind)
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return made


def block(material, location, size):
    bpy.ops.mesh.primitive_cube_add(size=1, location=location, scale=size)
    return with_material(material)


def ball(material, location, radius):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=location, segments=64, ring_count=32)
    bpy.ops.object.shade_smooth()
    return with_material(material)


def with_material(material):
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


def move(moved, path, by):
    """Moves along `by` between opening and closing of the shutter, evenly; starts where it is."""
    at = getattr(moved, path).copy()
    for frame, share in ((0, -0.5), (2, 1.5)):  # the shutter is from frame 0.5 to 1.5
        setattr(moved, path, [a + share * b for a, b in zip(at, by)])
        moved.keyframe_insert(path, frame=frame)


def room():
    """A room that is open to the camera and to the sky, whose colour and strength are returned."""
    grey, red, blue = (matt("grey", (0.7, 0.7, 0.7)), matt("red", (0.6, 0.1, 0.1)), matt("blue", (0.1, 0.2, 0.6)))
    for name, material, location, size in (
            ("floor", grey, (0, 0, -0.05), (6, 6, 0.1)), ("back", grey, (0, 3, 2), (6, 0.1, 4)),
            ("left", red, (-3, 0, 2), (0.1, 6, 4)), ("right", blue, (3, 0, 2), (0.1, 6, 4))):
        block(material, location, size).name = name
    bpy.ops.object.camera_add(location=(0, -9, 2), rotation=(math.radians(88.5), 0, 0))
    bpy.context.scene.camera = bpy.context.object
    world = bpy.context.scene.world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"].inputs
    background["Color"].default_value = (0.3, 0.35, 0.4, 1)
    return background


def closed_room(right_wall):
    """A room around the camera, 6 wide, 6 deep and 3 high. The parts of its right wall are (location, size) along y and z."""
    plaster, wood, green = matt("plaster", (0.75, 0.72, 0.68)), matt("wood", (0.35, 0.2, 0.1)), matt("green", (0.2, 0.4, 0.25))
    for material, location, size in (
            (wood, (0, 0, -0.05), (6.2, 6.2, 0.1)), (plaster, (0, 0, 3.05), (6.2, 6.2, 0.1)), (green, (0, 3.05, 1.5), (6.2, 0.1, 3)),
            (plaster, (0, -3.05, 1.5), (6.2, 0.1, 3)), (plaster, (-3.05, 0, 1.5), (0.1, 6.2, 3)), (wood, (-0.6, 1, 0.75), (1.8, 0.9, 0.06)),
            *((wood, (-0.6 + x, 1 + y, 0.36), (0.08, 0.08, 0.72)) for x in (-0.8, 0.8) for y in (-0.38, 0.38))):
        block(material, location, size)
    for (y, z), (depth, height) in right_wall:
        block(plaster, (3.05, y, z), (0.1, depth, height))
    ball(metal("mirror", (0.9, 0.9, 0.9), 0.05), (-0.9, 1, 0.98), 0.2)
    ball(metal("rough", (0.9, 0.6, 0.3), 0.4), (-0.3, 0.9, 0.98), 0.2)
    ball(matt("yellow", (0.8, 0.6, 0.1)), (1.2, 0.6, 0.4), 0.4)
    bpy.ops.object.camera_add(location=(-0.8, -2.8, 1.6), rotation=(math.radians(84), 0, math.radians(-12)))
    bpy.context.scene.camera = bpy.context.object
    bpy.context.object.data.lens = 24
    world = bpy.context.scene.world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"].inputs
    background["Color"].default_value, background["Strength"].default_value = (0.4, 0.55, 0.8, 1), 0
    return background


def metal_balls():
    ball(metal("mirror", (0.9, 0.9, 0.9), 0.05), (1.4, -1.2, 0.5), 0.5)
    ball(metal("rough", (0.9, 0.6, 0.3), 0.4), (0.2, -1.4, 0.4), 0.4)


def ceiling_lamp():
    bpy.ops.object.light_add(type="AREA", location=(0, 0, 3.9))
    lamp = bpy.context.object.data
    lamp.energy, lamp.size = 150, 1


def moving_box():
    """A ball and a block that cross the room, a block that turns."""
    room()
    move(ball(matt("yellow", (0.8, 0.6, 0.1)), (-1.6, -0.5, 0.6), 0.6), "location", (1.2, 0, 0))
    move(block(matt("green", (0.2, 0.6, 0.2)), (1.2, 0.5, 1.6), (0.8, 0.8, 0.8)), "location", (0, 0, 0.6))
    move(block(matt("white", (0.8, 0.8, 0.8)), (-0.3, 1.2, 0.5), (1, 1, 1)), "rotation_euler", (0, 0, math.radians(30)))
    metal_balls()
    ceiling_lamp()


def many_lamps():
    """A night with small lamps in view, some of them behind pillars."""
    room()["Strength"].default_value = 0.02
    for k in range(5):
        block(matt(f"pillar {k}", (0.7, 0.7 - 0.1 * k, 0.3 + 0.1 * k)), (-2.4 + 1.2 * k, 0.6, 1), (0.25, 0.25, 2))
    metal_balls()
    for k in range(24):
        colour = [(1, 0.8, 0.5), (0.5, 0.7, 1), (1, 0.4, 0.4)][k % 3]
        place = (-2.5 + k % 6, -2 + 1.3 * (k // 6), 1.2 + 0.35 * (k * 5 % 7))
        block(shining(f"lamp {k}", colour, 60 + 30 * (k % 5)), place, (0.06, 0.06, 0.06))


def wide_lens():
    """A patterned floor and balls in depth, the nearest in focus."""
    room()
    cells = 8  # an image of squares, each of its own brightness
    image = bpy.data.images.new("squares", cells, cells, float_buffer=True)
    image.pixels = [v for k in range(cells * cells) for v in (*[0.1 + 0.7 * (k * 29 % 64) / 63] * 3, 1)]
    image.pack()
    pattern = matt("pattern", (1, 1, 1))
    nodes = pattern.node_tree.nodes
    texture = nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    pattern.node_tree.links.new(texture.outputs["Color"], next(n for n in nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
    bpy.ops.mesh.primitive_plane_add(size=5.8, location=(0, 0, 0.01))
    with_material(pattern)
    for k in range(5):
        ball(matt(f"ball {k}", (0.8 - 0.15 * k, 0.4, 0.1 + 0.15 * k)), (-2.2 + 0.9 * k, -1.8 + 0.9 * k, 0.4), 0.4)
    metal_balls()
    ceiling_lamp()
    lens = bpy.context.scene.camera.data.dof
    lens.use_dof, lens.focus_distance, lens.aperture_fstop = True, 7.4, 0.2


def window():
    """Sun and sky through one window; the sun lights a patch of the floor, and that the room."""
    sky = closed_room([((-2.05, 1.5), (2.1, 3)), ((2.05, 1.5), (2.1, 3)), ((0, 0.4), (2, 0.8)), ((0, 2.6), (2, 0.8))])
    sky["Strength"].default_value = 1
    bpy.ops.object.light_add(type="SUN", location=(8, 0, 6), rotation=(math.radians(12), math.radians(55), 0))
    bpy.context.object.data.energy, bpy.context.object.data.angle = 8, math.radians(0.53)


def door_ajar():
    """A dark room beside a lit one, whose door stands ajar."""
    closed_room([((-1.7, 1.5), (2.8, 3)), ((2.05, 1.5), (2.1, 3)), ((0.35, 2.55), (1.3, 0.9))])
    block(matt("door", (0.6, 0.55, 0.5)), (3.05, 0.22, 1.05), (0.06, 1.04, 2.1))
    plaster = matt("other room", (0.75, 0.72, 0.68))
    for location, size in (((5.1, 0, -0.05), (4, 6.2, 0.1)), ((5.1, 0, 3.05), (4, 6.2, 0.1)), ((7.05, 0, 1.5), (0.1, 6.2, 3)),
                           ((5.1, 3.05, 1.5), (4, 0.1, 3)), ((5.1, -3.05, 1.5), (4, 0.1, 3))):
        block(plaster, location, size)
    bpy.ops.object.light_add(type="AREA", location=(5.1, 0, 2.95))
    bpy.context.object.data.energy, bpy.context.object.data.size = 300, 0.8


def lampshade():
    """A bulb in a shade that is open above and below, and nothing else that shines."""
    closed_room([((0, 1.5), (6.2, 3))])
    ball(shining("bulb", (1, 0.8, 0.5), 300), (0.8, 1.6, 1.35), 0.05)
    bpy.ops.mesh.primitive_cone_add(vertices=48, radius1=0.35, radius2=0.2, depth=0.5, end_fill_type="NOTHING", location=(0.8, 1.6, 1.4))
    with_material(matt("shade", (0.8, 0.7, 0.5)))


SCENES = {"moving-box": moving_box, "many-lamps": many_lamps, "wide-lens": wide_lens,
          "window": window, "door-ajar": door_ajar, "lampshade": lampshade}


def make(name, folder, resolution):
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(ROOT / "blender"))
    import covtrace_blender
    from covtrace_blender import export_scene
    bpy.ops.wm.read_factory_settings(use_empty=True)
    covtrace_blender.register()
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"
    SCENES[name]()
    scene = bpy.context.scene
    scene.frame_set(1)
    render = scene.render
    render.resolution_x, render.resolution_y = map(int, resolution.split("x"))
    render.use_motion_blur, render.motion_blur_shutter = True, SHUTTER
    scene.covtrace.max_depth = MOST_BOUNCES + 1  # of scatterings, the first of which Cycles does not count
    settings = scene.cycles
    render.engine = "CYCLES"
    settings.max_bounces = MOST_BOUNCES
    for kind in ("diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces"):
        setattr(settings, kind, MOST_BOUNCES)
    settings.sample_clamp_direct = settings.sample_clamp_indirect = settings.blur_glossy = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))

    class Engine:
        """The part of a render engine that the exporter asks for."""
        frame_set = staticmethod(lambda frame, subframe: scene.frame_set(frame, subframe=subframe))

    exporter = export_scene.SceneExporter(Engine, bpy.context.evaluated_depsgraph_get(), str(folder))
    exporter.write()
    if exporter.warnings:
        sys.exit("\n".join(exporter.warnings))


def denoise(settings):
    import _cycles  # of the add-on cycles
    if not _cycles.with_openimagedenoise:
        sys.exit("this Blender is built without Open Image Denoise")
    settings.use_denoising, settings.denoiser = True, "OPENIMAGEDENOISE"
    settings.denoising_input_passes, settings.denoising_prefilter = "RGB_ALBEDO_NORMAL", "ACCURATE"
    if bpy.app.version >= (4, 2, 0):  # before, it is always high
        settings.denoising_quality = "HIGH"


def guide_paths(settings):
    import _cycles  # of the add-on cycles
    if not _cycles.with_path_guiding:
        sys.exit("this Blender is built without path guiding")
    settings.use_guiding = True


def render(blend, samples, seed, threads, image, threshold=None, guided=False):
    bpy.ops.wm.open_mainfile(filepath=blend)
    scene = bpy.context.scene
    settings = scene.cycles
    settings.samples, settings.seed = samples, seed
    if bpy.app.version >= (4, 2, 0):  # what new files have
        settings.sampling_pattern = "AUTOMATIC"
    settings.use_adaptive_sampling = settings.use_denoising = False
    if threshold is not None:
        settings.use_adaptive_sampling, settings.adaptive_threshold = True, threshold
        denoise(settings)
    settings.use_guiding = False
    if guided:
        guide_paths(settings)
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    written = scene.render.image_settings
    written.file_format, written.color_depth, written.color_mode = "OPEN_EXR", "32", "RGB"
    scene.render.filepath = image
    start = time.process_time()
    bpy.ops.render.render(write_still=True)
    print(f"CPU seconds: {time.process_time() - start:.6f}")


def main():
    command, *arguments = sys.argv[sys.argv.index("--") + 1:]
    if command == "make":
        name, folder, resolution = arguments
        make(name, pathlib.Path(folder), resolution)
        print(f"Blender: {bpy.app.version_string}")
    else:
        blend, samples, seed, threads, image, *denoised = arguments
        render(blend, int(samples), int(seed), int(threads), image, *([float(denoised[0]), "guided" in denoised] if denoised else []))


main()
