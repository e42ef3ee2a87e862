"""Instances that are rendered, and where they are while the shutter is open."""

import math

import numpy as np

from . import export_meshes
from .placement import is_finite
from .shutter import has_blurred_shape, is_blurred, shutter_times


class Instances:
    """The base of an exporter with engine, depsgraph, scene, frame, camera, warn and volume_objects as SceneExporter has them. is_preview:
    whether it is for a viewport; shutter: (open, close) in frames, or None; still: matrices by key of what is not blurred; still_shapes,
    closing: places of vertices by name."""

    def __init__(self, engine, depsgraph, camera):
        self.engine, self.depsgraph, self.scene, self.camera = engine, depsgraph, depsgraph.scene, camera
        self.frame = self.scene.frame_current_final
        self.is_preview, self.shutter, self.still, self.still_shapes, self.closing = False, None, {}, {}, {}

    def look_at_close(self):
        """Where things are when the shutter closes: (matrices by key, (open, close) in frames); then back to open."""
        if not self.scene.render.use_motion_blur:
            return {}, None
        frame, (opening, closing) = self.frame, shutter_times(self.scene)
        if not self.camera.is_blurred() or not all(is_blurred(instance) and has_blurred_shape(instance.object) and instance.object.type != "VOLUME"
                                                   for _, instance in self.instances()):
            self.go_to(frame + 0.5 * (opening + closing))
        self.still = {key: instance.matrix_world.copy() for key, instance in self.instances() if not is_blurred(instance)}
        self.still_shapes = self._shapes(is_blurred=False)
        for obj in (instance.object for _, instance in self.instances()):
            if obj.type == "VOLUME" and self.is_own(obj):
                self.volume_objects.keep(obj)
        self.camera.hold_if_sharp()
        self.go_to(frame + closing)
        matrices = {key: instance.matrix_world.copy() for key, instance in self.instances()}
        matrices["camera"] = self.camera.matrix()
        self.closing = self._shapes(is_blurred=True)
        self.go_to(frame + opening)
        return matrices, (opening, closing)

    def _shapes(self, is_blurred):
        """{object's name: where the vertices of its mesh are} of those whose changes of shape are blurred or not."""
        return {obj.name_full: export_meshes.positions(obj.data) for obj in (instance.object for _, instance in self.instances())
                if obj.type == "MESH" and has_blurred_shape(obj) == is_blurred and self.is_own(obj)}

    def is_own(self, obj):
        """Whether its data is that of the object of its name: geometry nodes place other data under their object's name."""
        own = obj.original.evaluated_get(self.depsgraph).data
        return own is not None and own.as_pointer() == obj.data.as_pointer()

    def corners(self):
        """(n, 3) corners of the boxes around all instances, in the world, and the camera's place, or the origin in viewports."""
        found = [np.zeros((1, 3)) if self.is_preview else np.array(self.camera.matrix().translation)[None]]
        for _, instance in self.instances():
            matrix, corners = np.array(instance.matrix_world), np.array([tuple(corner) for corner in instance.object.bound_box])
            found.append(corners @ matrix[:3, :3].T + matrix[:3, 3])
        places = np.concatenate(found)
        return places[np.isfinite(places).all(1)]

    def go_to(self, time):
        frame = math.floor(time)
        self.engine.frame_set(frame, subframe=time - frame)

    def instances(self):
        for instance in self.depsgraph.object_instances:
            if instance.show_self or instance.show_particles and instance.object.particle_systems:
                if not is_finite(instance.matrix_world):
                    self.warn(f"object '{instance.object.name}' has a place or a size that is not finite and is left out")
                    continue
                parent = instance.parent.name_full if instance.parent else ""
                yield (instance.object.name_full, parent, tuple(instance.persistent_id)), instance
