"""A scene of Blender as a pbrt-v4 file with its meshes and textures in one folder."""

import io
import os

import numpy as np

from . import attributes, export_lights, export_meshes, export_motion, export_strands, export_world, mesh_numbers, ply
from .atlases import Atlases
from .baking import Surface
from .body import Body, texture_space
from .body_demand import MOST_TEXELS, MOST_TEXELS_OF_PREVIEWS, BodyDemand
from .clipping import Clipping
from .displacement import Displacer, method_of
from .export_camera import SceneCamera
from .export_materials import MaterialExporter
from .export_points import Spheres, spheres
from .export_volumes import Varying, has_volume, is_smoke_domain
from .instances import Instances
from .media import Volumes
from .node_signature import hangs_on_world, scatters_through, tree_of
from .owner import Owner, asks_for_random, random_of
from .part import Part, write_parts
from .photometric_images import PhotometricImages
from .placement import is_same, placement, with_extent
from .shader_nodes.place import STRANDS
from .shadow_catchers import BARE, BEHIND, CAUGHT
from .solid import Box, Solid
from .texel_density import Placements
from .uv_ranges import UvRanges
from .visibility import Visibility
from .volume_lattice import VolumeSpace
from .volume_objects import VolumeObjects
from .world_volume import border, reach_of_distant_light, world_volume

CONTENT = "content.pbrt"

SURFACES = ("MESH", "CURVE", "SURFACE", "FONT", "META")
WRITTEN = (*SURFACES, "CURVES", "POINTCLOUD", "VOLUME")


class SceneExporter(Instances):
    """engine: moves the frame; tell(text): is told what takes time; picture: one of shadow_catchers, or None."""

    def __init__(self, engine, depsgraph, folder, tell=lambda text: None, picture=None):
        super().__init__(engine, depsgraph, SceneCamera(depsgraph.scene, depsgraph))
        self.folder, self.tell, self.layer = folder, tell, depsgraph.view_layer_eval
        self.warnings, self.picture, self.volume_objects = [], picture, VolumeObjects(folder, self.warn)

    def warn(self, text):
        if text not in self.warnings:
            self.warnings.append(text)

    def write(self):
        """The path of a file that holds the scene as its camera sees it."""
        self.warnings += self.camera.left_out()
        moving, self.shutter = self.look_at_close()
        path = os.path.join(self.folder, "scene.pbrt")
        try:
            content = io.StringIO()
            self._write_content(content, moving)
            around = self.media.sum(self.volumes.media_at(self.camera.matrix().translation, rays=("camera",)))
            with open(path, "w", encoding="utf-8") as out:
                out.write(f'MediumInterface "" "{around}"\n' if around else "")
                out.write(self.camera.text(self.shutter, moving.get("camera")))
                out.write(content.getvalue())
        finally:
            if self.shutter:
                self.go_to(self.frame)
        return path

    def write_content(self):
        """The name of a file beside which another one that begins with a camera can stand: the scene, at rest."""
        self.is_preview = True
        with open(os.path.join(self.folder, CONTENT), "w", encoding="utf-8") as out:
            self._write_content(out, {})
        return CONTENT

    def medium_everywhere(self):
        """Text before the camera of a viewport, once the content is written."""
        return "".join(f'MediumInterface "" "{name}"\n' for name in self.everywhere)

    def _write_content(self, out, moving):
        self.out = out
        out.write('WorldBegin\nMediumInterface "" ""\n')
        self.materials, self.atlases, self.bodies = MaterialExporter(out, self.folder, self.warn), Atlases(), {}
        self.materials.media.is_seen = self.picture not in (CAUGHT, BARE)  # what media hide is opacity of the matte
        self.random_materials, self.random = {}, None
        self.lamp_images = PhotometricImages(self.folder, self.materials.files.source)
        self._write_world()
        self._look_at_instances()
        self._look_at_bodies()
        self.visibility = Visibility(self.depsgraph.view_layer, Clipping(None if self.is_preview else self.camera), self.picture,
                                     any(scatters_through(tree) for tree in self._trees()))
        self.volumes = self._find_volumes()
        self._write_objects(moving)
        self.materials.baked.keep()
        self.atlases.keep()
        self.media = self.materials.media
        del self.materials, self.atlases, self.bodies, self.lamp_images  # their images are no use while what is written is rendered

    def _write_world(self):
        time = self.frame if self.shutter is None else self.frame + self.shutter[0]
        # A layer without sky has no light of it, either, as in Cycles.
        world = (getattr(self.layer, "world_override", None) or self.scene.world) if self.layer.use_sky else None
        found = world_volume(world, self.materials.files.source, self.warn)
        self.reach, self.everywhere = reach_of_distant_light(found), ()
        if found:
            self.everywhere = (self.materials.media.add(found),)
            self.out.write(border(found, *self.everywhere, self.corners()))
        export_world.write_world(self.out, world, self.folder, self.warn, self.tell, time, self.is_preview, self.reach,
                                 self._is_sky_seen())

    def _is_sky_seen(self):
        return self.picture == BEHIND or self.picture is None and not self.scene.render.film_transparent

    # -- objects

    def _find_volumes(self):
        """The Volumes of all instances that are written."""
        found = Volumes(self.everywhere)
        for _, instance in self.instances():
            obj = instance.object
            slots = [slot for slot, material in enumerate(self._materials(obj)) if has_volume(material)] \
                if obj.type == "MESH" and instance.show_self and self.layer.use_solid and Body.is_of(obj.data) else []
            hidden = self.visibility.hidden(instance) if slots or obj.type == "VOLUME" else None
            if hidden is None:
                continue
            self.random = self._random_of(instance)
            if obj.type == "VOLUME":
                variants, box = self._volume_variants(obj)
                self._add_volume(found, instance, variants, hidden, lambda: box)
                continue
            if is_smoke_domain(obj):
                self.warn(f"object '{obj.name}': the grids of its fluid simulation are not read; its cache of OpenVDB can be a volume object")
            mesh = obj.to_mesh()
            self._displace(obj, mesh)
            for slot in slots:
                if self._add_volume(found, instance, self._variants(obj, slot, mesh), hidden, lambda: Solid(mesh)):
                    break
            obj.to_mesh_clear()
        return found

    def _add_volume(self, found, instance, variants, hidden, make_solid):
        """Adds an instance to Volumes, where one of these Variants has a medium; tells whether."""
        filled = [variant for variant in variants if variant.medium and set(variant.rays) - hidden]
        if filled:
            rays = {ray for variant in filled for ray in variant.rays} - hidden
            found.add(instance.object, make_solid, instance.matrix_world, self.materials.media.placed(filled[0].medium, instance.matrix_world), rays)
            self.visibility.note_volume(instance, filled)
        return bool(filled)

    def _volume_variants(self, obj):
        """(the Variants of the material of a volume object, the Box around it); none where nothing of it is seen."""
        material = self.volume_objects.material(self._materials(obj)) if self.layer.use_volumes else None
        space = material and self.volume_objects.space(obj, material)
        if not space:
            return [], None
        owner = Owner(obj, material, self.random, self.placements.only_matrix(obj), self.placements.scale(obj))
        variants = self.materials.variants(material, (*Placements.key(obj), self.random), lambda name: Surface(space_of=lambda: space), owner, True)
        return [variant for variant in variants if variant.medium], Box(space.low, space.high)

    def _write_objects(self, moving):
        shared, exported = {}, {}
        for key, instance in self.instances():
            obj = instance.object
            hidden = self.visibility.hidden(instance)
            if hidden is None:
                continue
            matrix, end = self.still.get(key) or instance.matrix_world.copy(), None if key in self.still else moving.get(key)
            fit = export_lights.lit_matrix(obj.data) if obj.type == "LIGHT" else with_extent
            matrix, end = fit(matrix), end and fit(end)
            if matrix is None:
                continue
            if obj.type == "LIGHT" and instance.show_self:
                self._write_lamp(obj, matrix, end, hidden)
            elif obj.type in WRITTEN:
                # An emitter may be hidden behind its strands, and strands behind their emitter.
                self.random = self._random_of(instance)
                shown = (obj.name_full, obj.data.as_pointer(), instance.show_self, instance.show_particles, self.random)
                if shown not in exported:
                    is_shown = instance.show_self and (self.layer.use_solid or obj.type == "VOLUME")
                    exported[shown] = (self._export_parts(obj) if is_shown else []) + (
                        self._export_strands(obj) if instance.show_particles and self.layer.use_strand else [])
                parts = [part for part in exported[shown] if set(part.variant.rays) - hidden]
                if not parts:
                    continue
                around = self.volumes.around(obj, matrix, self.warn) if any(part.variant.medium for part in parts) else ()
                media, is_holdout = self.materials.media, self.visibility.is_holdout(instance)
                stands_alone = any(part.variant.emission or media.varies(part.variant.medium) for part in parts)
                if instance.is_instance and not stands_alone:
                    shown += (frozenset(hidden), is_holdout, around)
                    if shown not in shared:
                        shared[shown] = f"object {len(shared)}"
                        self.out.write(f'ObjectBegin "{shared[shown]}"\n')
                        write_parts(self.out, media, parts, hidden, is_holdout, around, matrix)
                        self.out.write("ObjectEnd\n")
                    self.out.write("AttributeBegin\n" + placement("ConcatTransform", matrix, end) +
                                   f'ObjectInstance "{shared[shown]}"\nAttributeEnd\n')
                else:
                    self.out.write("AttributeBegin\n" + placement("ConcatTransform", matrix, end))
                    write_parts(self.out, media, parts, hidden, is_holdout, around, matrix)
                    self.out.write("AttributeEnd\n")
            elif obj.type in ("GPENCIL", "GREASEPENCIL"):
                self.warn(f"object '{obj.name}' is grease pencil, which is not rendered")
        self.visibility.tell(self.warn)

    def _write_lamp(self, obj, matrix, end, hidden):
        lamp = obj.data
        moves = end is not None and not is_same(matrix, end)
        if moves and lamp.type not in export_lights.MAY_MOVE:
            self.warn(f"lamp '{obj.name}' is a {lamp.type.lower()} and moves while the shutter is open; it stays where it is "
                      "at the opening")
            moves = False
        export_lights.write_lamp(self.out, export_lights.ScaledLamp(lamp, matrix, self.reach), matrix, end if moves else None, hidden, self.lamp_images, self.warn)

    def _export_parts(self, obj):
        """The Parts of an evaluated object, its files and materials written."""
        if obj.type == "CURVES":
            return self._strands_parts(obj, 0, export_strands.hair_curves(obj.data))
        if obj.type == "POINTCLOUD":
            return [Spheres(centres, radii, variant, self.placements.sole_matrix(obj)) for slot, centres, radii in spheres(obj.data)
                    for variant in self._variants(obj, slot, None)]
        if obj.type == "VOLUME":
            variants, box = self._volume_variants(obj)
            return self._parts(variants, box.corners(), None, None, Box.TRIANGLES) if variants else []
        mesh = obj.to_mesh()
        if mesh is None:
            return []
        if obj.name_full in self.still_shapes and self.is_own(obj):
            export_meshes.reshape(mesh, self.still_shapes[obj.name_full])
        piece, motions = self._motions(obj, mesh)
        kept = self._displace(obj, mesh)
        parts = []

        def uvs_of_slot(slot):
            variants = self._variants(obj, slot, mesh)
            body = next((variant.body for variant in variants if variant.body), None)
            if body:
                return body.corner_uvs()
            chosen, is_all = export_meshes.uv_map(mesh, self._uv_maps(variants))
            if not is_all:
                self.warn(f"object '{obj.name}': its textures want UV maps that it has not, or several; '{chosen}' is used for all")
            return export_meshes.loop_uvs(mesh, mesh.uv_layers[chosen])[export_meshes.triangle_loops(mesh)] if chosen else None

        def tangents_of_slot(slot):
            wanted = next((variant.tangent for variant in self._variants(obj, slot, mesh) if variant.tangent), None)
            return wanted and wanted.at_corners(mesh)

        for slot, number, positions, normals, uvs, triangles, tangents in export_meshes.parts(mesh, uvs_of_slot, piece, tangents_of_slot, kept):
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
            parts += self._parts(self._variants(obj, slot, mesh), positions, normals, uvs, triangles, motion, tangents)
        obj.to_mesh_clear()
        return parts

    def _displace(self, obj, mesh):
        def owner_of(material):
            return Owner(obj, material, self.random, self.placements.only_matrix(obj), self.placements.scale(obj))
        return Displacer(self.materials.files.source, owner_of, self.warn).displace(mesh, self._materials(obj), self.placements.sole_matrix(obj))

    def _export_strands(self, obj):
        """The same of its hair."""
        is_render = self.depsgraph.mode == "RENDER"
        return [part for slot, *strands in export_strands.particle_systems(obj, is_render)
                for part in self._strands_parts(obj, slot, [strands])]

    def _strands_parts(self, obj, slot, strands):
        variants = self._variants(obj, slot, None, is_strand=True)
        if set(self._uv_maps(variants)) - {STRANDS}:
            self.warn(f"object '{obj.name}': strands have no texture coordinates; their images lie along and around them")
        return [part for sides, *tubes in export_strands.meshes(strands, lambda *s: self.placements.across(obj, *s))
                for part in self._parts(variants, *tubes, tube_sides=sides)]

    def _materials(self, obj):
        if self.layer.material_override is not None:
            return [self.layer.material_override] * max(1, len(obj.material_slots))
        return [s.material for s in obj.material_slots] if self.is_own(obj) else list(obj.data.materials)

    def _trees(self):
        """The trees of nodes of all materials of the layer."""
        return {tree_of(m) for _, instance in self.instances() if instance.object.type in WRITTEN for m in self._materials(instance.object)} - {None}

    def _random_of(self, instance):
        """The random number that the materials of an instance ask for; None where none does."""
        materials = self._materials(instance.object)
        for material in materials:
            if material and material.name_full not in self.random_materials:
                self.random_materials[material.name_full] = asks_for_random(material)
        is_asked = any(material and self.random_materials[material.name_full] for material in materials)
        return random_of(instance) if is_asked else None

    @staticmethod
    def _uv_maps(variants):
        """The names of the UV maps that they read."""
        return tuple(dict.fromkeys(name for variant in variants for name in variant.uv_maps))

    def _variants(self, obj, slot, mesh, is_strand=False):
        """The Variants of a slot's material, as it is on the object's mesh; None: on its strands, which have no places on a body
        and no UV map, so that they are as anywhere."""
        materials = self._materials(obj)
        material = materials[min(slot, len(materials) - 1)] if materials else None

        def body():
            found = self._body(obj, mesh, material)
            found.lay_out(self.atlases, self.placements.density(obj, mesh)[found.chosen], self.placements.most_texels)
            return found

        def surface_of(name):
            of_body = (body, export_meshes.active_uv_map(mesh), space) if mesh and Body.is_of(mesh) else ()
            return Surface(self.uv_ranges.of(name), *of_body)

        def space():
            return VolumeSpace(*export_meshes.box(mesh), texture_space(mesh), self.placements.only_matrix(obj), most=self.most_places)

        owner = Owner(obj, material, self.random, self.placements.only_matrix(obj), self.placements.scale(obj), is_strand)
        return self.materials.variants(material, (*Placements.key(obj), mesh is None, self.random), surface_of, owner)

    def _body(self, obj, mesh, material):
        """The Body of what has a material on an object, of all of it where nothing has; made once, without its atlas."""
        key = (*Placements.key(obj), material.name_full)
        if key not in self.bodies:
            matrix = self.placements.only_matrix(obj) if hangs_on_world(material.node_tree) else None
            chosen = export_meshes.triangles_of(mesh, self._materials(obj), material)
            self.bodies[key] = Body(mesh, chosen if chosen.any() else ~chosen, matrix, attributes.names(material.node_tree),
                                    mesh_numbers.asked_for(material.node_tree), self.camera.from_world())
        return self.bodies[key]

    def _look_at_bodies(self):
        """Makes all atlases coarser where they would be too large together."""
        demand, seen = BodyDemand(self.materials.files.source, self.placements.most_texels), set()
        for _, instance in self.instances():
            obj = instance.object
            if obj.type not in SURFACES or not instance.show_self or Placements.key(obj) in seen:
                continue
            seen.add(Placements.key(obj))
            active = export_meshes.active_uv_map(obj.data) if obj.type == "MESH" else None
            images = {material: demand.images(material, active) for material in set(self._materials(obj)) if material}
            mesh = obj.to_mesh() if any(count for count, _ in images.values()) else None
            if mesh is None:
                continue
            if all(method_of(material) != "BOTH" for material in images):
                self._displace(obj, mesh)  # colours hang on where the surface is; heights over one that is moved on where it was
            for material, (count, kinds) in images.items() if Body.is_of(mesh) else ():
                if count and export_meshes.triangles_of(mesh, self._materials(obj), material).any():
                    body = self._body(obj, mesh, material)
                    demand.add(material, count, kinds, body, self.placements.density(obj, mesh)[body.chosen])
            obj.to_mesh_clear()
        most = MOST_TEXELS_OF_PREVIEWS if self.is_preview else MOST_TEXELS
        self.placements.share = demand.share_of_density(most, self.warn)

    def _look_at_instances(self):
        self.uv_ranges, varying = UvRanges(), Varying()
        self.placements = Placements(None if self.is_preview else self.camera)
        for _, instance in self.instances():
            obj = instance.object
            if obj.type in WRITTEN:
                self.placements.add(instance)
            if obj.type == "MESH":
                materials = {m.name_full: m for m in self._materials(obj) if m}
                self.uv_ranges.add(obj.data, set(materials))
                varying.add(materials)
            elif obj.type == "VOLUME":
                varying.add_volume()
        self.most_places = varying.most_places(self.is_preview)
        self.volume_objects.placements, self.volume_objects.most = self.placements, self.most_places

    def _parts(self, variants, positions, normals, uvs, triangles, motion=None, tangents=None, tube_sides=0):
        file = f"mesh{len(os.listdir(self.folder))}.ply"
        ply.write(os.path.join(self.folder, file), positions, normals, uvs, triangles, tangents)
        return [Part(file, variant, motion, tube_sides) for variant in variants]

    def _motions(self, obj, mesh):
        """(piece of each triangle, motion of each piece) of what changes its shape; (None, None) of what does not."""
        has_motion = self.shutter and obj.type == "MESH" and self.is_own(obj)
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
