"""A scene of Blender as a pbrt-v4 file with its meshes and textures in one folder."""

import math
import os

import numpy as np
from mathutils import Matrix

from . import export_lights, export_meshes, export_motion, export_strands, ply, surface_coordinates
from .baking import Surface
from .export_materials import MaterialExporter
from .export_shaders import numbers

# Blender's cameras look along -z, pbrt's along +z; both have x to the right and y up.
TURN = Matrix.Diagonal((1, 1, -1, 1))


def matrix_text(matrix):
    """pbrt lists columns first."""
    return numbers(matrix[row][column] for column in range(4) for row in range(4))


SURFACES = ("MESH", "CURVE", "SURFACE", "FONT", "META")


def is_same(a, b):
    return all(abs(x - y) < 1e-7 for r, s in zip(a, b) for x, y in zip(r, s))


def placement(directive, start, end):
    """A transform over the shutter; end None: at rest."""
    if end is None or is_same(start, end):
        return f"{directive} [{matrix_text(start)}]\n"
    return (f"ActiveTransform StartTime\n{directive} [{matrix_text(start)}]\n"
            f"ActiveTransform EndTime\n{directive} [{matrix_text(end)}]\nActiveTransform All\n")


class SceneExporter:
    def __init__(self, engine, depsgraph, folder):
        self.engine, self.depsgraph, self.folder = engine, depsgraph, folder
        self.scene = depsgraph.scene
        self.frame = self.scene.frame_current_final
        self.warnings = []
        render = self.scene.render
        scale = render.resolution_percentage / 100
        self.size = (max(1, int(render.resolution_x * scale)), max(1, int(render.resolution_y * scale)))
        self.region = self._region(render)

    def warn(self, text):
        if text not in self.warnings:
            self.warnings.append(text)

    def _region(self, render):
        """x0, y0, x1, y1 of the pixels that are rendered, rows from the bottom, end exclusive; rounded as Blender does,
        which makes pictures of this size whether they are cropped or put into the frame afterwards."""
        width, height = self.size
        if not render.use_border:
            return 0, 0, width, height
        x0, x1 = int(render.border_min_x * width), int(render.border_max_x * width)
        y0, y1 = int(render.border_min_y * height), int(render.border_max_y * height)
        if x0 >= x1 or y0 >= y1:
            raise RuntimeError("the render region holds no pixel")
        return x0, y0, x1, y1

    def write(self):
        """The scene file's path."""
        moving, self.shutter = self._look_at_close()
        path = os.path.join(self.folder, "scene.pbrt")
        try:
            self._write(path, moving)
        finally:
            if self.shutter:
                self._go_to(self.frame)
        return path

    def _write(self, path, moving):
        with open(path, "w", encoding="utf-8") as out:
            self.out = out
            self._write_camera(moving)
            out.write("WorldBegin\n")
            self.materials = MaterialExporter(out, self.folder, self.warn)
            export_lights.write_world(out, self.scene.world, self.folder, self.warn)
            self.uv_ranges = self._uv_ranges()
            self._write_objects(moving)

    # -- time

    def _look_at_close(self):
        """Where things are when the shutter closes: (matrices by key, (open, close) in frames); then back to open."""
        render = self.scene.render
        if not render.use_motion_blur:
            return {}, None
        frame, half = self.frame, 0.5 * render.motion_blur_shutter
        self._go_to(frame + half)
        matrices = {key: instance.matrix_world.copy() for key, instance in self._instances()}
        matrices["camera"] = self._camera().matrix_world.copy()
        self.closing = {instance.object.name_full: export_meshes.positions(instance.object.data)
                        for _, instance in self._instances() if instance.object.type == "MESH" and self._is_own(instance.object)}
        self._go_to(frame - half)
        return matrices, (-half, half)

    def _is_own(self, obj):
        """Whether its data is that of the object of its name: geometry nodes place other data under their object's name."""
        own = obj.original.evaluated_get(self.depsgraph).data
        return own is not None and own.as_pointer() == obj.data.as_pointer()

    def _go_to(self, time):
        frame = math.floor(time)
        self.engine.frame_set(frame, subframe=time - frame)

    def _instances(self):
        for instance in self.depsgraph.object_instances:
            if instance.show_self or instance.show_particles and instance.object.particle_systems:
                parent = instance.parent.name_full if instance.parent else ""
                yield (instance.object.name_full, parent, tuple(instance.persistent_id)), instance

    # -- camera

    def _camera(self):
        if self.scene.camera is None:
            raise RuntimeError("covtrace: the scene has no camera")
        return self.scene.camera.evaluated_get(self.depsgraph)

    def _write_camera(self, moving):
        camera = self._camera()
        data, out = camera.data, self.out
        if data.type == "PANO":
            raise RuntimeError("covtrace: panoramic cameras are not supported")
        def world_to_camera(matrix):
            return TURN @ matrix.normalized().inverted()
        if self.shutter:
            out.write(f"TransformTimes {self.shutter[0]:.9g} {self.shutter[1]:.9g}\n")
        end = moving.get("camera")
        out.write(placement("Transform", world_to_camera(camera.matrix_world), world_to_camera(end) if end else None))
        corners = data.view_frame(scene=self.scene)
        is_perspective = data.type == "PERSP"
        depth = -corners[0].z if is_perspective else 1.0
        xs, ys = [c.x / depth for c in corners], [c.y / depth for c in corners]
        parameters = [f'"float screenwindow" [{numbers((min(xs), max(xs), min(ys), max(ys)))}]']
        if is_perspective:
            parameters.append('"float fov" 90')
        if self.shutter:
            parameters.append(f'"float shutteropen" {self.shutter[0]:.9g} "float shutterclose" {self.shutter[1]:.9g}')
        if data.dof.use_dof:
            distance = data.dof.focus_distance
            if data.dof.focus_object:
                at = data.dof.focus_object.evaluated_get(self.depsgraph).matrix_world.translation
                distance = -(camera.matrix_world.normalized().inverted() @ at).z
            focal_length = data.lens * 1e-3 if is_perspective else 1.0
            radius = focal_length / (2 * max(data.dof.aperture_fstop, 1e-3))
            parameters.append(f'"float lensradius" {radius:.9g} "float focaldistance" {max(distance, 1e-4):.9g}')
        out.write(f'Camera "{"perspective" if is_perspective else "orthographic"}" {" ".join(parameters)}\n')
        x0, y0, x1, y1 = self.region
        # The exposure's length is no brightness in Blender.
        iso = 100 / (self.shutter[1] - self.shutter[0]) if self.shutter else 100
        out.write(f'Film "rgb" "integer xresolution" {self.size[0]} "integer yresolution" {self.size[1]} '
                  f'"float iso" {iso:.9g} "integer pixelbounds" [{x0} {x1} {self.size[1] - y1} {self.size[1] - y0}]\n')
        out.write(f'Sampler "zsobol" "integer pixelsamples" {max(1, round(self.scene.covtrace.samples))}\n')
        out.write(f'Integrator "path" "integer maxdepth" {self.scene.covtrace.max_depth}\n')

    # -- objects

    def _write_objects(self, moving):
        shared, exported = {}, {}
        for key, instance in self._instances():
            obj = instance.object
            matrix = instance.matrix_world.copy()
            end = moving.get(key)
            if obj.type == "LIGHT" and instance.show_self:
                if end is not None and not is_same(matrix, end):
                    self.warn(f"lamp '{obj.name}' moves while the shutter is open; it stays where it is at the opening")
                self._write_lamp(obj.data, matrix)
            elif obj.type in SURFACES or obj.type == "CURVES":
                # An emitter may be hidden behind its strands, and strands behind their emitter.
                shown = (obj.name_full, obj.data.as_pointer(), instance.show_self, instance.show_particles)
                if shown not in exported:
                    exported[shown] = (self._export_parts(obj) if instance.show_self else []) + (
                        self._export_strands(obj) if instance.show_particles else [])
                parts = exported[shown]
                if not parts:
                    continue
                if abs(matrix.determinant()) < 1e-30:
                    continue
                if instance.is_instance and not any(emission for *_, emission, _ in parts):
                    if shown not in shared:
                        shared[shown] = f"object {len(shared)}"
                        self.out.write(f'ObjectBegin "{shared[shown]}"\n')
                        self._write_parts(parts)
                        self.out.write("ObjectEnd\n")
                    self.out.write("AttributeBegin\n" + placement("ConcatTransform", matrix, end) +
                                   f'ObjectInstance "{shared[shown]}"\nAttributeEnd\n')
                else:
                    self.out.write("AttributeBegin\n" + placement("ConcatTransform", matrix, end))
                    self._write_parts(parts)
                    self.out.write("AttributeEnd\n")
            elif obj.type in ("VOLUME", "POINTCLOUD", "GPENCIL"):
                self.warn(f"object '{obj.name}' is a {obj.type.lower()}, which is not rendered")

    def _write_lamp(self, lamp, matrix):
        scale = export_lights.area_scale(lamp, matrix)
        if lamp.type != "AREA":
            matrix = matrix.normalized()
        class Scaled:
            """The lamp with its energy for an area of unit scale."""
            def __getattr__(self, name):
                return lamp.energy * scale if name == "energy" else getattr(lamp, name)
        export_lights.write_lamp(self.out, Scaled(), placement("ConcatTransform", matrix, None), self.warn)

    def _export_parts(self, obj):
        """[(file, material name, alpha, emission, (transform at the opening, at the closing) or None)] of an evaluated object, its files and
        materials written."""
        if obj.type == "CURVES":
            tubes = export_strands.hair_curves(obj.data)
            return [] if tubes is None else [self._tubes_part(obj, 0, *tubes)]
        mesh = obj.to_mesh()
        if mesh is None:
            return []
        piece, motions = self._motions(obj, mesh)
        parts = []

        def material_of(slot):
            return self._material_of(obj, slot)

        def uv_of_slot(slot):
            chosen, is_all = export_meshes.uv_map(mesh, material_of(slot)[3])
            if not is_all:
                self.warn(f"object '{obj.name}': its textures want UV maps that it has not, or several; '{chosen}' is used for all")
            return chosen

        for slot, number, positions, normals, uvs, triangles in export_meshes.parts(mesh, uv_of_slot, piece):
            if not np.isfinite(positions).all():
                self.warn(f"object '{obj.name}' has vertices that are not finite and is left out")
                break
            motion = None
            if motions:
                # Motions are interpolated as turns about the origin, which goes straight: the middle of the piece or,
                # where joints move it, the point that it turns about.
                origin = 0.5 * (positions.min(0) + positions.max(0)).astype(float)
                if any(m.type == "ARMATURE" for m in obj.modifiers):
                    origin = export_motion.pivot(motions[number], origin)
                positions = positions - origin
                place = np.eye(4)
                place[:3, 3] = origin
                motion = place, motions[number] @ place
            parts.append(self._part(obj, slot, positions, normals, uvs, triangles, motion))
        obj.to_mesh_clear()
        return parts

    def _export_strands(self, obj):
        """The same of its hair."""
        is_render = self.depsgraph.mode == "RENDER"
        return [self._tubes_part(obj, *tubes) for tubes in export_strands.particle_systems(obj, is_render)]

    def _tubes_part(self, obj, slot, positions, normals, triangles):
        if self._material_of(obj, slot)[3]:
            self.warn(f"object '{obj.name}': strands have no texture coordinates; their images are looked up at one place")
        uvs = np.zeros((len(positions), 2)) if self._material_of(obj, slot)[3] else None
        return self._part(obj, slot, positions, normals, uvs, triangles)

    def _materials(self, obj):
        return [s.material for s in obj.material_slots] if self._is_own(obj) else list(obj.data.materials)

    def _material_of(self, obj, slot):
        """The material of a slot, as it is on the object; on strands, which have no UV map, as anywhere."""
        materials = self._materials(obj)

        def surface_of(name):
            # Curves and the like have meshes only while they are exported; their UV maps are unit squares.
            is_mesh = obj.type == "MESH"
            return Surface(self.uv_ranges.of(name), surface_coordinates.object_of_uv(obj, obj.data) if is_mesh else {})

        return self.materials.material(materials[min(slot, len(materials) - 1)] if materials else None, obj.name_full,
                                       surface_of)

    def _uv_ranges(self):
        ranges = surface_coordinates.UvRanges()
        for _, instance in self._instances():
            obj = instance.object
            if obj.type == "MESH":
                ranges.add(obj.data, {m.name_full for m in self._materials(obj) if m})
        return ranges

    def _part(self, obj, slot, positions, normals, uvs, triangles, motion=None):
        file = f"mesh{len(os.listdir(self.folder))}.ply"
        ply.write(os.path.join(self.folder, file), positions, normals, uvs, triangles)
        name, emission, alpha, _ = self._material_of(obj, slot)
        return file, name, alpha, emission, motion

    def _motions(self, obj, mesh):
        """(piece of each triangle, motion of each piece) of what changes its shape; (None, None) of what does not."""
        has_motion = self.shutter and obj.type == "MESH" and self._is_own(obj)
        closing = self.closing.get(obj.name_full) if has_motion else None
        opening = None if closing is None else export_meshes.positions(mesh)
        if closing is None or np.array_equal(closing, opening):
            return None, None
        if len(closing) != len(opening) or not np.isfinite(closing).all() or not np.isfinite(opening).all():
            self.warn(f"object '{obj.name}' has other vertices when the shutter closes; it keeps those of the opening")
            return None, None
        mesh.calc_loop_triangles()
        piece, motions, left = export_motion.motions(opening, closing, export_meshes.triangles(mesh))
        if left > export_motion.MOST_LEFT_SILENTLY:
            self.warn(f"object '{obj.name}' bends more while the shutter is open than {len(motions)} pieces that each "
                      f"move as one can follow: {100 * left:.0f} % of the way are left out")
        return piece, motions

    def _write_parts(self, parts):
        for file, name, alpha, emission, motion in parts:
            self.out.write("AttributeBegin\n" f'NamedMaterial "{name}"\n')
            if motion is not None:
                self.out.write(placement("ConcatTransform", *motion))
            if emission:
                image = f' "string filename" "{emission.texture}"' if emission.texture else ""
                scale = f'"float scale" {emission.radiance[0]:.9g}' if emission.texture else \
                    f'"rgb L" [{numbers(emission.radiance)}]'
                self.out.write(f'AreaLightSource "diffuse" {scale}{image} "bool twosided" true\n')
            self.out.write(f'Shape "plymesh" "string filename" "{file}" {alpha}\nAttributeEnd\n')
