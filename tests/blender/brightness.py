"""How much light surfaces send back, by covtrace and by Cycles: a plane in a white surrounding, seen from above and at 1.2
radian from its normal. The table of docs/decisions/0051.

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

SAMPLES = 64
WHITE, GREY, BLACK = (1, 1, 1, 1), (0.5, 0.5, 0.5, 1), (0, 0, 0, 1)


def share(engine, tilt, test):
    test.camera.location = (0, -5 * math.sin(tilt), 5 * math.cos(tilt))
    test.camera.rotation_euler = (tilt, 0, 0)
    return addon_support.mean(addon_support.render(engine, SAMPLES))[0]


def row(name, **inputs):
    cells = []
    for tilt in (0, 1.2):
        test = addon_support.BlenderTest()
        test.setUp()
        test.camera.data.lens = 200
        test.background.inputs["Color"].default_value = WHITE
        test.plane(addon_support.material(**inputs))
        ours, theirs = (share(engine, tilt, test) for engine in ("COVTRACE", "CYCLES"))
        cells.append(f"{ours:.3f} | {theirs:.3f} | {ours / theirs:.3f}")
    return f"| {name} | {' | '.join(cells)} |"


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


main()
sys.stdout.flush()
os._exit(0)
