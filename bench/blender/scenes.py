"""Ten small scenes, made inside Blender (3.4, 4.5): SCENES maps their names to functions that build them into an empty file."""

import math
import random

import bpy


def shader(name, kind="BsdfDiffuse", **inputs):
    """A material of one shader node."""
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    tree = m.node_tree
    node = tree.nodes.new("ShaderNode" + kind)
    for key, value in inputs.items():
        node.inputs[key].default_value = (*value, 1) if isinstance(value, tuple) else value
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return m


def matt(*colour):
    return shader("matt", Color=colour)


def shining(strength, *colour):
    return shader("shining", "Emission", Color=colour, Strength=strength)


def placed(material, location=(0, 0, 0), scale=(1, 1, 1), rotation=(0, 0, 0), smooth=False):
    """The object that was added last, at its place."""
    thing = bpy.context.object
    thing.location, thing.scale, thing.rotation_euler = location, scale, rotation
    thing.data.materials.append(material)
    if smooth:
        thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))
    return thing


def plane(material, **place):
    bpy.ops.mesh.primitive_plane_add(size=1)
    return placed(material, **place)


def box(material, **place):
    bpy.ops.mesh.primitive_cube_add(size=1)
    return placed(material, **place)


def ball(material, radius, **place):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, segments=48, ring_count=24)
    return placed(material, smooth=True, **place)


def lamp(kind, energy, location, rotation=(0, 0, 0), **values):
    data = bpy.data.lights.new(kind, kind)
    data.energy = energy
    for key, value in values.items():
        setattr(data, key, value)
    thing = bpy.data.objects.new(kind, data)
    thing.location, thing.rotation_euler = location, rotation
    bpy.context.scene.collection.objects.link(thing)
    return thing


def camera(location, rotation, lens=35):
    thing = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    thing.location, thing.rotation_euler, thing.data.lens = location, rotation, lens
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing
    return thing


def world(strength, *colour):
    w = bpy.data.worlds.new("world")
    w.use_nodes = True
    bpy.context.scene.world = w
    background = w.node_tree.nodes["Background"]
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = (*colour, 1), strength
    return w.node_tree


def moves(thing, path, before, after):
    """From `before` at frame 0 to `after` at frame 2, evenly."""
    for frame, value in ((0, before), (2, after)):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)
    action = thing.animation_data.action
    curves = action.fcurves if hasattr(action, "fcurves") else action.layers[0].strips[0].channelbags[0].fcurves
    for curve in curves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def room(*colours):
    """Five walls, 4 x 4 x 3, open towards -y."""
    floor, wall, side = (matt(*c) for c in colours)
    plane(floor, scale=(4, 4, 1))
    plane(wall, location=(0, 0, 3), scale=(4, 4, 1))
    plane(wall, location=(0, 2, 1.5), scale=(4, 3, 1), rotation=(math.pi / 2, 0, 0))
    plane(side, location=(2, 0, 1.5), scale=(3, 4, 1), rotation=(0, math.pi / 2, 0))


def window():
    world(4, 0.7, 0.85, 1)
    room((0.5, 0.35, 0.2), (0.8, 0.8, 0.8), (0.7, 0.3, 0.2))
    wall = matt(0.8, 0.8, 0.8)
    for y, z, height, depth in ((0, 0.5, 1, 4), (0, 2.75, 0.5, 4), (-1.4, 1.75, 1.5, 1.2), (1.4, 1.75, 1.5, 1.2)):
        box(wall, location=(-2.05, y, z), scale=(0.1, depth, height))
    box(wall, location=(0, -2.05, 1.5), scale=(4, 0.1, 3))
    box(matt(0.2, 0.4, 0.6), location=(0.8, 0.8, 0.4), scale=(0.8, 0.8, 0.8), rotation=(0, 0, 0.4))
    ball(matt(0.8, 0.7, 0.3), 0.4, location=(-0.4, 1, 0.4))
    lamp("SUN", 6, (0, 0, 5), (0, -1.0, 0.3), angle=0.0)
    camera((0.6, -1.9, 1.5), (1.45, 0, 0.05), 22)


def glossy():
    world(0.3, 0.5, 0.6, 0.8)
    plane(shader("floor", "BsdfGlossy", Color=(0.6, 0.6, 0.6), Roughness=0.15), scale=(12, 12, 1))
    for i, roughness in enumerate((0.05, 0.15, 0.3, 0.5)):
        ball(shader("metal", "BsdfGlossy", Color=(1, 1, 1), Roughness=roughness), 0.5, location=(-1.8 + 1.2 * i, 0, 0.5))
    plane(shining(8, 1, 0.7, 0.4), location=(-2, 2.5, 1.5), scale=(1, 2, 1), rotation=(math.pi / 2, 0, 0))
    plane(shining(5, 0.4, 0.7, 1), location=(2, 2.5, 1.5), scale=(0.5, 2, 1), rotation=(math.pi / 2, 0, 0))
    camera((0, -5, 2), (1.3, 0, 0), 35)


def depth_of_field():
    world(0.6, 0.8, 0.9, 1)
    floor = matt(0.8, 0.8, 0.8)
    tree = floor.node_tree
    checker, place = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeTexCoord")
    checker.inputs["Scale"].default_value = 40
    tree.links.new(place.outputs["UV"], checker.inputs["Vector"])
    tree.links.new(checker.outputs["Color"], next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
    plane(floor, scale=(20, 20, 1))
    numbers = random.Random(1)
    for i in range(14):
        ball(matt(*(0.2 + 0.7 * numbers.random() for _ in range(3))), 0.25, location=(-2 + 1.4 * (i % 4), -2 + 0.7 * i, 0.25))
    ball(shining(60, 1, 0.9, 0.6), 0.04, location=(0.6, 5, 1.0))
    seen = camera((0, -5, 1.2), (1.4, 0, 0), 50)
    seen.data.dof.use_dof, seen.data.dof.focus_distance, seen.data.dof.aperture_fstop = True, 5.0, 0.2


def motion():
    world(0.8, 0.8, 0.9, 1)
    plane(matt(0.5, 0.5, 0.5), scale=(12, 12, 1))
    moves(ball(matt(0.9, 0.2, 0.1), 0.5), "location", (-1.6, 0, 0.5), (-0.4, 0, 0.5))
    moves(box(matt(0.1, 0.5, 0.9), location=(1.2, 0, 0.6), scale=(1, 0.2, 1)), "rotation_euler", (0, -0.4, 0.5), (0, 0.4, 0.5))
    moves(ball(shining(30, 1, 0.8, 0.5), 0.08), "location", (-0.5, -1, 1.4), (0.8, -1, 1.9))
    bpy.context.scene.frame_set(1)
    bpy.context.scene.render.use_motion_blur, bpy.context.scene.render.motion_blur_shutter = True, 1.0
    camera((0, -5, 1.6), (1.35, 0, 0), 38)


def glass():
    world(0.4, 0.7, 0.8, 1)
    plane(matt(0.7, 0.6, 0.5), scale=(12, 12, 1))
    for i, (roughness, eta) in enumerate(((0.0, 1.5), (0.2, 1.5), (0.0, 1.2))):
        ball(shader("glass", "BsdfGlass", Color=(1, 1, 1), Roughness=roughness, IOR=eta), 0.5, location=(-1.3 + 1.3 * i, 0, 0.51))
    box(matt(0.2, 0.6, 0.3), location=(0, 1.8, 0.5), scale=(4, 0.4, 1))
    plane(shining(6, 1, 0.95, 0.9), location=(-1, 0, 3), scale=(2, 2, 1), rotation=(0, 0.3, 0))
    camera((0, -5, 1.8), (1.3, 0, 0), 40)


def textures():
    world(1, 1, 1, 1)
    for i, (kind, output, values) in enumerate((("TexBrick", 0, {"Scale": 4}), ("TexNoise", 1, {"Scale": 5}), ("TexVoronoi", 1, {"Scale": 6}),
                                                ("TexWave", 0, {"Scale": 2, "Distortion": 3}), ("TexChecker", 0, {"Scale": 8}), ("TexGradient", 0, {}))):
        material = matt(0.5, 0.5, 0.5)
        tree = material.node_tree
        node, place = tree.nodes.new("ShaderNode" + kind), tree.nodes.new("ShaderNodeTexCoord")
        for key, value in values.items():
            node.inputs[key].default_value = value
        tree.links.new(place.outputs["UV"], node.inputs["Vector"])
        tree.links.new(node.outputs[output], next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
        plane(material, location=(-1.1 + 1.1 * (i % 3), 0, 0.55 + 1.1 * (i // 3)), rotation=(math.pi / 2, 0, 0))
    plane(matt(0.4, 0.4, 0.4), scale=(12, 12, 1))
    camera((0, -4, 1.4), (1.5, 0, 0), 35)


def hair():
    world(0.7, 0.8, 0.9, 1)
    plane(matt(0.4, 0.4, 0.45), scale=(12, 12, 1))
    head = ball(matt(0.5, 0.25, 0.1), 0.7, location=(0, 0, 0.9))
    head.modifiers.new("hair", "PARTICLE_SYSTEM")
    settings = head.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length = "HAIR", 2500, 0.5
    settings.root_radius, settings.tip_radius, settings.radius_scale = 1, 0.5, 0.012
    settings.brownian_factor = 0.08
    lamp("SUN", 3, (0, 0, 5), (0.5, 0.5, 0), angle=0.0)
    camera((0, -4, 1.4), (1.45, 0, 0), 40)


def sky():
    tree = world(0.15, 1, 1, 1)
    node = tree.nodes.new("ShaderNodeTexSky")
    node.sun_elevation, node.sun_rotation = 0.4, 2.2
    tree.links.new(node.outputs[0], tree.nodes["Background"].inputs["Color"])
    plane(matt(0.5, 0.45, 0.4), scale=(40, 40, 1))
    for x, height in ((-1.2, 1.5), (0.2, 0.8), (1.4, 2.0)):
        box(matt(0.7, 0.7, 0.7), location=(x, 0, height / 2), scale=(0.8, 0.8, height), rotation=(0, 0, 0.5))
    camera((0, -6, 1.6), (1.5, 0, 0), 35)


def many_lamps():
    world(0.02, 1, 1, 1)
    plane(matt(0.6, 0.6, 0.6), scale=(14, 14, 1))
    numbers = random.Random(2)
    for _ in range(60):
        lamp("POINT", 12, (numbers.uniform(-3, 3), numbers.uniform(-2, 6), numbers.uniform(0.3, 1.5)),
             color=tuple(0.2 + 0.8 * numbers.random() for _ in range(3)), shadow_soft_size=0.05)
    for _ in range(25):
        size = numbers.uniform(0.2, 0.7)
        box(matt(0.7, 0.7, 0.7), location=(numbers.uniform(-3, 3), numbers.uniform(-1, 6), size / 2), scale=(size,) * 3,
            rotation=(0, 0, numbers.uniform(0, 3)))
    camera((0, -5, 3), (1.15, 0, 0), 32)


def emissive():
    world(0, 1, 1, 1)
    room((0.6, 0.6, 0.6), (0.8, 0.8, 0.8), (0.2, 0.6, 0.3))
    plane(matt(0.7, 0.2, 0.2), location=(-2, 0, 1.5), scale=(3, 4, 1), rotation=(0, math.pi / 2, 0))
    for i in range(5):
        box(shining(8, *((1, 0.8, 0.5) if i % 2 else (0.5, 0.7, 1))), location=(-1.4 + 0.7 * i, 1.5, 2.2), scale=(0.1, 0.1, 0.8))
    ball(shining(3, 1, 0.4, 0.2), 0.25, location=(-1, 0.5, 0.25))
    box(matt(0.8, 0.8, 0.8), location=(0.7, 0.5, 0.5), scale=(0.8, 0.8, 1), rotation=(0, 0, 0.5))
    camera((0, -4.6, 1.5), (1.54, 0, 0), 30)


SCENES = {f.__name__: f for f in (window, glossy, depth_of_field, motion, glass, textures, hair, sky, many_lamps, emissive)}


def build(name, width, height):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    SCENES[name]()
