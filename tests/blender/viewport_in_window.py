"""Run by a Blender with a window: a shining ball in a viewport in several views. Prints, as JSON, where it is and where it is
seen, in the image and on the screen, and which programs are left when the viewport shows something else.

    FOLDER for a screenshot, behind --
"""

import json
import os
import sys
import time
import traceback

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../blender"))
import covtrace_blender
from covtrace_blender import preview_session

FOLDER = sys.argv[sys.argv.index("--") + 1]
SAMPLES = 4
found = {"views": {}}


def window():
    return bpy.context.window_manager.windows[0]


def area():
    return next(a for a in window().screen.areas if a.type == "VIEW_3D")


def session():
    return next(iter(preview_session._all), None)


def is_done():
    s = session()
    return s is not None and s.version > 0 and not s.is_busy and not s.is_waiting()


def middle_of(values):
    """(x, y) of the middle of what is green, from the lower left, as shares of the image; None where nothing is."""
    is_green = values[..., 1] - values[..., [0, 2]].max(-1) > 0.5
    rows, columns = np.nonzero(is_green)
    return ((columns.mean() + 0.5) / values.shape[1], (rows.mean() + 0.5) / values.shape[0]) if len(rows) else None


def screen():
    """Colours of the viewport on the screen."""
    path = os.path.join(FOLDER, "screen.png")
    with bpy.context.temp_override(window=window(), screen=window().screen):
        bpy.ops.screen.screenshot(filepath=path)
    image = bpy.data.images.load(path)
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(*tuple(image.size)[::-1], -1)[..., :3]
    bpy.data.images.remove(image)
    region = view_region()
    return values[region.y:region.y + region.height, region.x:region.x + region.width]


def view_region():
    return next(r for r in area().regions if r.type == "WINDOW")


def look(name):
    region, seen = view_region(), area().spaces[0].region_3d
    at = location_3d_to_region_2d(region, seen, bpy.data.objects["ball"].location)
    s = session()
    found["views"][name] = {"expected": (at.x / region.width, at.y / region.height), "image": middle_of(s.image),
                            "screen": middle_of(screen()), "corner": screen()[30, 30].tolist(),
                            "alpha": [float(f(s.image[..., 3])) for f in (np.min, np.max)], "size": s.image.shape, "region": (region.width, region.height),
                            "failure": s.failure}


def edit(mode):
    with bpy.context.temp_override(window=window(), screen=window().screen, area=area()):
        bpy.context.view_layer.objects.active = bpy.data.objects["ball"]
        bpy.ops.object.mode_set(mode=mode)


def build():
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    bpy.ops.object.camera_add(location=(3, -6, 2), rotation=(1.3, 0, 0.5))
    bpy.context.object.data.shift_x = 0.2
    bpy.context.scene.camera = bpy.context.object
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=(0.5, 0.2, 0.4))
    ball = bpy.context.object
    ball.name = "ball"
    material = bpy.data.materials.new("shining")
    material.use_nodes = True
    shader = material.node_tree.nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value, shader.inputs["Strength"].default_value = (0, 1, 0, 1), 5
    material.node_tree.links.new(shader.outputs[0], material.node_tree.nodes["Material Output"].inputs["Surface"])
    ball.data.materials.append(material)
    scene = bpy.context.scene
    scene.render.engine, scene.view_settings.view_transform = "COVTRACE", "Standard"
    scene.covtrace.viewport_samples = SAMPLES
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.01, 0.01, 0.01, 1)
    space = area().spaces[0]
    space.overlay.show_overlays = space.show_gizmo = space.show_region_toolbar = space.show_region_ui = False
    space.show_region_header = space.show_region_tool_header = False
    space.shading.type = "RENDERED"


def steps():
    """Yields what to wait for, or seconds."""
    yield 1.0
    build()
    yield is_done
    yield 0.5
    seen = area().spaces[0].region_3d
    look("perspective")
    seen.view_location = (0.2, 0, 0.5)
    seen.view_distance *= 0.6
    yield 1.0
    yield is_done
    yield 0.5
    look("nearer")
    bpy.data.objects["ball"].location.x -= 0.6
    yield 1.0
    yield is_done
    yield 0.5
    look("moved")
    for kind in ("ORTHO", "CAMERA"):
        seen.view_perspective = kind
        yield 1.0
        yield is_done
        yield 0.5
        look(kind.lower())
    edit("EDIT")
    bpy.data.objects["ball"].location.x += 0.6
    yield 1.0
    yield is_done
    yield 0.5
    look("edited")
    edit("OBJECT")
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.8, 0, 0, 1)
    for is_clear in (False, True):
        bpy.context.scene.render.film_transparent = is_clear
        yield 1.0
        yield is_done
        yield 0.5
        look("clear" if is_clear else "opaque")
    bpy.context.scene.render.film_transparent = False
    bpy.context.scene.covtrace.viewport_samples = 1e6
    bpy.data.objects["ball"].location.x += 0.1
    yield lambda: session()._process is not None and "1000000.0" in session()._process.args
    pid = session()._process.pid
    found["runs"] = os.path.exists(f"/proc/{pid}")
    area().spaces[0].shading.type = "SOLID"
    yield 3.0
    found["left"] = os.path.exists(f"/proc/{pid}")
    found["sessions"] = len(preview_session._all)


work, waits = steps(), None
deadline = time.time() + float(os.environ.get("COVTRACE_WINDOW_SECONDS", "400"))


def step():
    global waits
    try:
        if time.time() > deadline:
            raise RuntimeError(f"too slow: {found}")
        if callable(waits) and not waits():
            return 0.1
        waits = next(work)
        return 0.1 if callable(waits) else waits
    except StopIteration:
        print("FOUND", json.dumps(found), flush=True)
    except Exception:
        traceback.print_exc()
    preview_session.stop_all()
    sys.stdout.flush()
    os._exit(0)


bpy.context.preferences.view.show_splash = False
covtrace_blender.register()
bpy.app.timers.register(step, first_interval=1.0)
