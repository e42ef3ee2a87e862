"""Grids of OpenVDB as arrays: densities, temperatures and colours of smoke and clouds."""

import functools
import glob
import importlib
import itertools
import os
import sys
from importlib import machinery, util

import bpy
import numpy as np

from .volume_lattice import Lattice, VolumeSpace, moved

MODULES = ("openvdb", "pyopenvdb")  # Debian 12 has the latter
OFFSET = 0.5 if bpy.app.version < (5, 0, 0) else 0.0
ALIKE = 1e-3  # of a voxel: places that differ by less are the same


def library():
    """Python's module of OpenVDB; None where neither Blender nor the system has it."""
    for name in MODULES:
        try:
            return importlib.import_module(name)
        except ImportError:
            pass
    # Python's module bpy has it in a folder in which Python does not look.
    spec = machinery.PathFinder.find_spec(MODULES[0], glob.glob(os.path.join(
        bpy.utils.resource_path("LOCAL"), "python", "lib", "python*", "site-packages")))
    if spec is None:
        return None
    module = sys.modules[MODULES[0]] = util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class DenseGrid:
    """A function of (n, 3) places of an object to (n, 3) values, linear between those of a Lattice of the grid's index space. values:
    (count, 1 or 3) at its places, a number standing for all three; to_index: 4x4 from the object's space."""

    def __init__(self, lattice, values, to_index):
        self._lattice, self._values, self._to_index = lattice, values, to_index

    def __call__(self, places):
        found = self._lattice.interpolated(moved(places, self._to_index), lambda numbers: self._values[numbers]).astype(np.float32)
        return np.repeat(found, 3, axis=1) if found.shape[1] == 1 else found


def index_to_object(grid):
    """4x4. Before Blender 5 Cycles takes the place of a voxel for its least corner, from which its middle is half a voxel away."""
    origin = np.array(grid.transform.indexToWorld((0, 0, 0)))
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([grid.transform.indexToWorld(axis) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]).T - origin[:, None]
    matrix[:3, 3] = origin + OFFSET * matrix[:3, :3].sum(1)
    return matrix


def corners_of(low, high):
    """(8, 3) of a box."""
    return np.array(list(itertools.product(*zip(low, high))))


class Blocks:
    """Cubes of `step` voxels along each side that hold the voxels from low to high, and one cube more beyond each side. lattice: their
    middles, in index space."""

    def __init__(self, low, high, step=1):
        self._step, self._first = step, np.array(low) - step
        self.lattice = Lattice.of_cells(self._first - 0.5, np.full(3, float(step)), -(-(np.array(high) - low + 1) // step) + 2)

    def means(self, grid):
        """(count, 1 or 3) float32 of a grid."""
        step, (nx, ny, nz), width = self._step, self.lattice.shape, np.size(grid.background)
        found = np.empty((nz, ny, nx, width), np.float32)
        slab = np.empty((step, ny * step, nz * step, *((width,) if width > 1 else ())), np.float32)
        for i in range(nx):
            grid.copyToArray(slab, ijk=tuple(int(n) for n in self._first + (i * step, 0, 0)))
            found[:, :, i] = slab.reshape(step, ny, step, nz, step, width).mean((0, 2, 4)).transpose(1, 0, 2)
        return found.reshape(-1, width)


class VolumeGrids:
    """The grids of a file of OpenVDB. name: what warnings call it."""

    def __init__(self, module, path, name, warn):
        self._name, self._warn, self._grids = name, warn, {}
        for found in module.readAllGridMetadata(path):
            try:
                grid = module.read(path, found.name)
            except (TypeError, KeyError, RuntimeError):  # of a type that Python does not know
                warn(f"{name}: its grid '{found.name}' is of a type that Python's OpenVDB does not read, and is left out")
                continue
            if grid.evalLeafDim() != (0, 0, 0) and np.size(grid.background) in (1, 3) and not isinstance(grid.background, bool):
                self._grids[found.name] = grid

    @functools.lru_cache(maxsize=None)
    def space(self, names, most, density):
        """The VolumeSpace of those grids that have one of these names, with a Lattice as fine as their finest, or as it may have places; None
        where there is none. most, density: as VolumeSpace has them."""
        grids = {name: self._grids[name] for name in names if name in self._grids}
        if not grids:
            return None
        matrices = {name: index_to_object(grid) for name, grid in grids.items()}
        sizes = {name: abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3) for name, matrix in matrices.items()}
        boxes = {name: np.array(grid.evalActiveVoxelBoundingBox()) for name, grid in grids.items()}
        finest = min(sorted(grids), key=lambda name: (sizes[name], -np.prod(np.ptp(boxes[name], axis=0) + 1.0)))
        matrix = matrices[finest]
        whole = np.concatenate([moved(corners_of(*boxes[name]), np.linalg.inv(matrix) @ matrices[name]) for name in grids])
        low, high = np.floor(whole.min(0) + ALIKE).astype(int), np.ceil(whole.max(0) - ALIKE).astype(int)
        step = next(n for n in itertools.count(1) if Blocks(low, high, n).lattice.count() <= most)
        if step > 1:
            self._warn(f"{self._name}: its grids have {' x '.join(str(n) for n in high - low + 1)} voxels; blocks of {step} along each side "
                       "have their mean")
        boxes[finest] = np.array((low, high))
        blocks = {name: Blocks(*boxes[name], max(1, round(step * sizes[finest] / sizes[name]))) for name in grids}
        dense = {name: DenseGrid(blocks[name].lattice, blocks[name].means(grid), np.linalg.inv(matrices[name])) for name, grid in grids.items()}
        index, axes = blocks[finest].lattice, matrix[:3, :3]
        # Beyond the middles of the outermost blocks there is nothing.
        ends = moved(corners_of(index.low + index.cell / 2, index.high - index.cell / 2), matrix)
        is_straight = (axes.diagonal() > 0).all() and np.abs(axes - np.diag(axes.diagonal())).max() < 1e-6 * np.abs(axes).max()
        lattice = Lattice.of_cells(moved(index.low[None], matrix)[0], index.cell * axes.diagonal(), index.shape) if is_straight else \
            Lattice(ends.min(0), ends.max(0), index.count())
        # Generated coordinates are those of the object, as in Cycles.
        return VolumeSpace(ends.min(0), ends.max(0), (np.zeros(3), np.ones(3)), None, dense, most, lattice, density)
