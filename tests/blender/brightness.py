"""How much light surfaces send back, by covtrace and by Cycles: a plane in a white surrounding, seen from above and at 1.2
radian from its normal, and the middle of a ball of glass. The tables of docs/decisions/0051 and, from Blender 4.0 on, of
docs/results/blender.md.

    COVTRACE=build/release/covtrace blender --background --factory-startup -noaudio --python tests/blender/brightness.py
"""

import math
import os
import pathlib
import sys

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import addon_support
import test_subsurface

SAMPLES = 64
WHITE, GREY, BLACK, GOLD = (1, 1, 1, 1), (0.5, 0.5, 0.5, 1), (0, 0, 0, 1), (1, 0.6, 0.2, 1)
MOST_BOUNCES = 64


def white_surrounding(lens):
    test = addon_support.BlenderTest()
    test.setUp()
    test.camera.data.lens = lens
    test.background.inputs["Color"].default_value = WHITE
    return test


def cells(channel=0):
    ours, theirs = (addon_support.mean(addon_support.render(engine, SAMPLES))[channel] for engine in ("COVTRACE", "CYCLES"))
    return f"{ours:.3f} | {theirs:.3f} | {ours / theirs:.3f}"


def row(name, channel=0, make=addon_support.material, **inputs):
    found = []
    for tilt in (0, 1.2):
        test = white_surrounding(200)
        test.plane(make(**inputs))
        test.camera.location = (0, -5 * math.sin(tilt), 5 * math.cos(tilt))
        test.camera.rotation_euler = (tilt, 0, 0)
        found.append(cells(channel))
    return f"| {name} | {' | '.join(found)} |"


def glass_row(roughness):
    test = white_surrounding(100)
    scene = test.scene
    scene.covtrace.max_depth = scene.cycles.max_bounces = MOST_BOUNCES
    scene.cycles.transmission_bounces = scene.cycles.glossy_bounces = MOST_BOUNCES
    scene.cycles.blur_glossy = 0  # which loses light in glass
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1, segments=64, ring_count=32)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(addon_support.material(Base_Color=WHITE, Transmission=1.0, Roughness=roughness, IOR=1.5))
    return f"| glass, roughness {roughness} | {cells()} |"


def multiscatter_rows():
    """Rows of Multiscatter GGX, Principled's default since 4.0: metals, of gold the blue, and glass."""
    for name, colour, channel in (("white", WHITE, 0), ("grey", GREY, 0), ("gold, blue", GOLD, 2)):
        for roughness in (0.2, 0.5, 0.9):
            yield row(f"{name}, roughness {roughness}", channel, Base_Color=colour, Metallic=1.0, Roughness=roughness)
    for roughness in (0.2, 0.5, 0.9):
        yield glass_row(roughness)


def body_rows():
    """Rows of wide bodies, and of plates, whose red comes through."""
    for method in ("RANDOM_WALK", "RANDOM_WALK_SKIN"):
        for name, colour in (("0.5", GREY), ("0.95", (0.95, 0.95, 0.95, 1))):
            yield row(f"body {name}, {method}", make=test_subsurface.body, colour=colour, scale=0.02, method=method, Roughness=0.4)
        test = test_subsurface.SubsurfaceTest()
        test.setUp()
        test.slab(test_subsurface.body(scale=0.5, method=method, Specular=0.0))
        ours, theirs = test.centres()
        yield f"| plate, {method} | {ours[0]:.3f} | {theirs[0]:.3f} | {ours[0] / theirs[0]:.3f} |"


def main():
    rows = [row("base 0.5, no specular, roughness 1", Base_Color=GREY, Specular=0.0, Roughness=1.0),
            row("base 0.5, no specular, roughness 0.3", Base_Color=GREY, Specular=0.0, Roughness=0.3),
            row("base 0.5, specular 0.5, roughness 0.5", Base_Color=GREY, Specular=0.5, Roughness=0.5),
            row("base 1, specular 0.5, roughness 0.5", Base_Color=WHITE, Specular=0.5, Roughness=0.5),
            row("base 0, specular 0.5, roughness 0.1", Base_Color=BLACK, Specular=0.5, Roughness=0.1),
            row("base 0, specular 0.5, roughness 0.9", Base_Color=BLACK, Specular=0.5, Roughness=0.9),
            row("metal 1, roughness 0.1", Base_Color=WHITE, Metallic=1.0, Roughness=0.1),
            row("metal 1, roughness 0.5", Base_Color=WHITE, Metallic=1.0, Roughness=0.5),
            row("metal 1, roughness 0.9", Base_Color=WHITE, Metallic=1.0, Roughness=0.9),
            row("metal 0.5, roughness 0.1", Base_Color=GREY, Metallic=1.0, Roughness=0.1)]
    print("| Principled | above: ours | Cycles | ratio | 1.2 radian: ours | Cycles | ratio |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    print("\n".join(rows))
    if bpy.app.version >= (4, 0, 0):
        print("\n".join(multiscatter_rows()))
    print("\n".join(body_rows()))


main()
sys.stdout.flush()
os._exit(0)
