"""Objects of the type Volume: smoke and clouds of files of OpenVDB, and what geometry nodes make of meshes."""

import math
import os

import numpy as np

from . import attributes, openvdb_grids
from .export_materials import WITHOUT_MATERIAL
from .export_volumes import has_volume
from .node_signature import all_nodes

PRINCIPLED_SOCKETS = ("Density Attribute", "Color Attribute", "Temperature Attribute")


def _asked_grids(material):
    """The names of grids that a material's nodes ask for."""
    if material is WITHOUT_MATERIAL:
        return ("density",)
    names = {name for name in attributes.names(material.node_tree) if name}
    for node in all_nodes(material.node_tree):
        if node.type == "PRINCIPLED_VOLUME":
            names.update(node.inputs[name].default_value for name in PRINCIPLED_SOCKETS if name in node.inputs)
        elif node.type == "VOLUME_INFO":
            names.update(output.identifier.lower() for output in node.outputs if output.is_linked)
    return tuple(sorted(names))


class VolumeObjects:
    """Grids of evaluated objects. folder: for files that are gone at once. Before a space() is asked for: placements, the Placements of all
    instances, and most, places of a lattice."""

    def __init__(self, folder, warn):
        self.placements, self.most, self._folder, self._warn = None, 0, folder, warn
        self._grids, self._kept, self._module = {}, {}, openvdb_grids.library()

    def keep(self, obj):
        """Keeps the grids of an object whose data are its own as they are now, whatever frame is gone to."""
        if obj.name_full not in self._kept and self.material(obj.data.materials):
            self._kept[obj.name_full] = self._read(obj)

    def material(self, materials):
        """That of a volume object with these in its slots; None where it shows nothing."""
        if not materials or materials[0] is None:
            return WITHOUT_MATERIAL
        return materials[0] if has_volume(materials[0]) else None

    def space(self, obj, material):
        """The VolumeSpace of an object; None where it has no grid that its material asks for."""
        grids = self._grids_of(obj)
        matrix = np.array(self.placements.first_matrix(obj))
        # Cycles measures along the diagonal. By the object's space what is larger is not less clear.
        along = np.linalg.norm(matrix[:3, :3] @ np.ones(3)) / math.sqrt(3)
        density = 1 / max(along, 1e-30) if obj.data.render.space == "OBJECT" else 1.0
        space = grids and grids.space(_asked_grids(material), self.most, float(f"{density:.6g}"))
        if space:
            space.matrix = self.placements.only_matrix(obj)
        return space

    def _grids_of(self, obj):
        if obj.name_full in self._kept:
            return self._kept[obj.name_full]
        key = obj.data.as_pointer()
        if key not in self._grids:
            self._grids[key] = self._read(obj)
        return self._grids[key]

    def _read(self, obj):
        """The VolumeGrids of an object; None where they cannot be read."""
        if self._module is None:
            self._warn("volume objects are not rendered: this Blender has no Python module openvdb (of Debian: python3-openvdb)")
            return None
        name, grids = f"volume object '{obj.name}'", obj.data.grids
        if not grids.load():
            self._warn(f"{name} is not rendered: {grids.error_message or 'its file cannot be read'}")
            return None
        if len(grids) == 0:
            return None
        # Those that nodes have made are in no file yet.
        path = os.path.join(self._folder, "grids.vdb")
        try:
            if not grids.save(path):
                self._warn(f"{name} is not rendered: its grids cannot be written to '{self._folder}'")
                return None
            return openvdb_grids.VolumeGrids(self._module, path, name, self._warn)
        finally:
            if os.path.exists(path):
                os.remove(path)
