"""glTF files as covtrace renders them against what Cycles makes of them in Blender. The table of docs/results/gltf.md.

    COVTRACE=build/release/covtrace blender --background --factory-startup -noaudio --python tests/blender/gltf_against_cycles.py -- \\
        [-o FOLDER] [--samples N] [FILE.glb ...]

Or with a Python that has bpy in the place of Blender. Without files: scenes that Blender makes and exports, four of them, and
two of extensions since Blender 4.0. Each .glb is imported into an empty Blender and rendered by
Cycles, and rendered by covtrace, uniform and with the default method; covtrace compares. Both pictures and a report per
scene stay in FOLDER.
"""

import argparse
import json
import math
import os
import pathlib
import subprocess
import sys

import bpy
import numpy

# Debian 12's importer asks for a name that Debian 12's numpy has no more.
numpy.bool = bool

WIDTH, HEIGHT = 320, 180
COVTRACE = os.environ.get("COVTRACE", "covtrace")


RENAMED = {"Specular": "Specular IOR Level", "Emission": "Emission Color"}  # since Blender 4.0


def material(name, **inputs):
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    for key, value in inputs.items():
        socket = key.replace("_", " ")
        if bpy.app.version >= (4, 0, 0):
            socket = RENAMED.get(socket, socket)
        m.node_tree.nodes["Principled BSDF"].inputs[socket].default_value = value
    return m


def image(name, pixels, size, space="sRGB"):
    """pixels: (r, g, b, a) per texel, from below."""
    made = bpy.data.images.new(name, size, size)
    made.colorspace_settings.name = space
    made.pixels = [v for p in pixels for v in p]
    made.pack()
    return made


def textured(name, pixels, size):
    """A material with a base colour from an image."""
    m = material(name, Roughness=0.5)
    node = m.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image(name, pixels, size)
    m.node_tree.links.new(node.outputs["Color"], m.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    return m


def ball(m, x, y, radius=0.5):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=(x, y, radius), segments=64, ring_count=32)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(m)


def stage(floor):
    bpy.ops.mesh.primitive_plane_add(size=12)
    bpy.context.object.data.materials.append(floor)
    bpy.ops.object.camera_add(location=(0, -6, 2.5), rotation=(math.radians(72), 0, 0))
    bpy.context.scene.camera = bpy.context.object
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = WIDTH, HEIGHT


def lamps():
    bpy.ops.object.light_add(type="SUN", rotation=(0.6, 0.3, 0))
    bpy.context.object.data.energy = 2
    bpy.ops.object.light_add(type="POINT", location=(-2, -2, 3))
    bpy.context.object.data.energy, bpy.context.object.data.color = 250, (1, 0.7, 0.4)
    bpy.ops.object.light_add(type="SPOT", location=(3, -2, 4), rotation=(0.4, 0.6, 0))
    bpy.context.object.data.energy, bpy.context.object.data.spot_size = 400, 1.0
    for lamp in bpy.data.lights:
        if lamp.type != "SUN":
            lamp.shadow_soft_size = 0
        else:
            lamp.angle = 0


def matt():
    """Lamps alone: their units, and where things are."""
    stage(material("floor", Base_Color=(0.5, 0.5, 0.5, 1), Specular=0.0, Roughness=0.3))
    for i, colour in enumerate(((0.8, 0.2, 0.1, 1), (0.2, 0.7, 0.2, 1), (0.2, 0.3, 0.8, 1))):
        ball(material(f"matt{i}", Base_Color=colour, Specular=0.0, Roughness=0.3), 1.4 * (i - 1), 0)
    lamps()


def principled():
    """Metal, dielectric, rough and smooth, in a bright ring of emitters."""
    stage(material("floor", Base_Color=(0.4, 0.4, 0.4, 1), Roughness=0.7))
    kinds = [dict(Base_Color=(0.9, 0.6, 0.3, 1), Metallic=1.0, Roughness=0.25),
             dict(Base_Color=(0.8, 0.8, 0.8, 1), Metallic=1.0, Roughness=0.6),
             dict(Base_Color=(0.7, 0.1, 0.1, 1), Roughness=0.1), dict(Base_Color=(0.1, 0.3, 0.7, 1), Roughness=0.5)]
    for i, kind in enumerate(kinds):
        ball(material(f"kind{i}", **kind), 1.2 * (i - 1.5), 0)
    lamps()


def textures():
    """Base colours and normals from images."""
    size = 256  # so fine that it hardly counts that Cycles interpolates bytes before it decodes them
    checks = [((0.8, 0.7, 0.2, 1) if (i % size // 32 + i // size // 32) % 2 else (0.1, 0.2, 0.4, 1)) for i in range(size * size)]
    stage(textured("floor", checks, size))
    waves = [(0.5 + 0.35 * math.sin(8 * math.pi * (i % size) / size), 0.5, 0.93, 1) for i in range(size * size)]
    bumpy = material("bumpy", Base_Color=(0.6, 0.6, 0.6, 1), Roughness=0.4)
    tree = bumpy.node_tree
    node, normal = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeNormalMap")
    node.image = image("waves", waves, size, "Non-Color")
    tree.links.new(node.outputs["Color"], normal.inputs["Color"])
    tree.links.new(normal.outputs["Normal"], tree.nodes["Principled BSDF"].inputs["Normal"])
    ball(bumpy, -1, 0, 0.7)
    ball(textured("shown", checks, size), 1, 0, 0.7)
    lamps()


def emitters():
    """No lamps: meshes that shine."""
    stage(material("floor", Base_Color=(0.5, 0.5, 0.5, 1), Specular=0.0, Roughness=0.3))
    ball(material("matt", Base_Color=(0.7, 0.7, 0.7, 1), Specular=0.0, Roughness=0.3), 0, 0, 0.8)
    for x, colour in ((-2, (1, 0.4, 0.1, 1)), (2, (0.2, 0.5, 1, 1))):
        bpy.ops.mesh.primitive_plane_add(size=1.5, location=(x, 0, 3))
        bpy.context.object.data.materials.append(
            material(f"lamp{x}", Base_Color=(0, 0, 0, 1), Specular=0.0, Emission=colour, Emission_Strength=12.0))


def layers():
    """Clear coats, sheen, tinted borders, and a coated metal."""
    stage(material("floor", Base_Color=(0.4, 0.4, 0.4, 1), Roughness=0.7))
    kinds = [dict(Base_Color=(0.6, 0.05, 0.05, 1), Roughness=0.6, Coat_Weight=1.0, Coat_Roughness=0.1),
             dict(Base_Color=(0.1, 0.1, 0.3, 1), Roughness=0.8, Sheen_Weight=1.0, Sheen_Roughness=0.4, Specular=0.0),
             dict(Base_Color=(0.05, 0.05, 0.05, 1), Roughness=0.4, Specular_Tint=(1.0, 0.6, 0.2, 1), IOR=1.9),
             dict(Base_Color=(0.9, 0.9, 0.9, 1), Metallic=1.0, Roughness=0.5, Coat_Weight=1.0, Coat_Roughness=0.05)]
    for i, kind in enumerate(kinds):
        ball(material(f"kind{i}", **kind), 1.2 * (i - 1.5), 0)
    lamps()


def glass():
    """Bodies that refract and absorb, clear and rough."""
    stage(material("floor", Base_Color=(0.5, 0.5, 0.5, 1), Specular=0.0, Roughness=0.3))
    group = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
    group.interface.new_socket("Thickness", in_out="INPUT", socket_type="NodeSocketFloat")
    for i, (ior, roughness) in enumerate(((1.33, 0.0), (1.5, 0.0), (1.5, 0.4), (1.8, 0.2))):
        m = material(f"glass{i}", Base_Color=(1, 1, 1, 1), Roughness=roughness, Transmission_Weight=1.0, IOR=ior)
        nodes, links = m.node_tree.nodes, m.node_tree.links
        thickness, absorption = nodes.new("ShaderNodeGroup"), nodes.new("ShaderNodeVolumeAbsorption")
        thickness.node_tree = group
        thickness.inputs["Thickness"].default_value = 1
        absorption.inputs["Color"].default_value = (0.8, 0.5, 0.3, 1)
        absorption.inputs["Density"].default_value = 0.5
        links.new(absorption.outputs["Volume"], nodes["Material Output"].inputs["Volume"])
        ball(m, 1.2 * (i - 1.5), 0)
    for x, colour in ((-2, (1, 0.8, 0.6, 1)), (2, (0.6, 0.8, 1, 1))):
        bpy.ops.mesh.primitive_plane_add(size=3, location=(x, 0, 4))
        bpy.context.object.data.materials.append(
            material(f"lamp{x}", Base_Color=(0, 0, 0, 1), Specular=0.0, Emission=colour, Emission_Strength=6.0))


def made(folder):
    files = []
    scenes = [matt, principled, textures, emitters]
    if bpy.app.version >= (4, 0, 0):
        scenes += [layers, glass]
    for scene in scenes:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene()
        file = folder / f"{scene.__name__}.glb"
        bpy.ops.export_scene.gltf(filepath=str(file), export_cameras=True, export_lights=True)
        files.append(file)
    return files


def absorb_as_said():
    """Gives volumes the coefficients of KHR_materials_volume, -log(colour) / distance: importer and exporter have 1 - colour there."""
    for m in bpy.data.materials:
        for node in m.node_tree.nodes if m.use_nodes else ():
            if node.type == "VOLUME_ABSORPTION":
                colour, density = node.inputs["Color"], node.inputs["Density"]
                sigma = [-math.log(c) * density.default_value for c in colour.default_value[:3]]
                density.default_value = max(sigma)
                colour.default_value = [1 - s / max(sigma) for s in sigma] + [1]


def by_cycles(file, out, samples):
    """Renders the file as Blender imports it; its own camera, where it has one, must be the scene's."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(file))
    scene = bpy.context.scene
    absorb_as_said()
    scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.cycles.sample_clamp_indirect, scene.cycles.blur_glossy = 0, 0  # which take light from caustics
    for bounces in ("diffuse", "glossy", "transmission", "max"):
        setattr(scene.cycles, f"{bounces}_bounces", 12)
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = samples, False, False
    scene.render.film_transparent = False
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "ZIP"
    scene.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)


def by_covtrace(file, out, *options):
    subprocess.run([COVTRACE, "render", str(file), "-o", str(out), "--resolution", f"{WIDTH}x{HEIGHT}", "--png",
                    str(out.with_suffix(".png")), "--quiet", *options], check=True)


def compared(image, reference, *options):
    done = subprocess.run([COVTRACE, "compare", str(image), str(reference), "--json", *options], check=True, capture_output=True,
                          text=True)
    return json.loads(done.stdout)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("out/gltf"))
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    arguments.output.mkdir(parents=True, exist_ok=True)
    rows = []
    for file in arguments.files or made(arguments.output):
        cycles, uniform, hybrid = (arguments.output / f"{file.stem}-{kind}.exr" for kind in ("cycles", "uniform", "hybrid"))
        by_cycles(file, cycles, arguments.samples)
        by_covtrace(file, uniform, "--method", "uniform", "--spp", str(arguments.samples))
        by_covtrace(file, hybrid, "--spp", "32")
        many = compared(uniform, cycles)
        few = compared(hybrid, cycles, "--report", str(arguments.output / f"{file.stem}.html"))
        ratios = ", ".join(f"{r:.3f}" for r in many["mean_ratio"])
        rows.append(f"| `{file.stem}` | {ratios} | {many['relmse_trimmed']:.4f} | {many['flip']:.3f} | "
                    f"{few['relmse_trimmed']:.4f} | {few['flip']:.3f} |")
    print("| scene | brightness R, G, B | relMSE (trimmed) | FLIP | default method, 32 samples: relMSE | FLIP |")
    print("| --- | --- | --- | --- | --- | --- |")
    print("\n".join(rows))


main()
