"""Run by a Python that has bpy: writes one .blend file as a scene that bench/quality/gain takes.

    python bench/blender/export_file.py FILE.blend OUT.pbrt WIDTH

The frame's longer side gets WIDTH pixels. Scripts in the file are not run.
"""

import os
import sys

import render_file


def main(file, out, width):
    render_file.open_file(file, int(width))
    render_file.bpy.ops.export_scene.covtrace(filepath=os.path.abspath(out))


main(*sys.argv[1:])
sys.stdout.flush()
os._exit(0)  # the module's own end may take minutes
