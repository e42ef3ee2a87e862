"""Images in tiles (UDIM), as one image over all squares of the UV plane that they fill."""

import os

import bpy
import numpy as np

FIRST, PER_ROW = 1001, 10  # number of the tile at the origin; columns
MOST_TEXELS = 1 << 26  # of all tiles together, beyond which they are coarser
MOST_BYTES = 1 << 30  # kept between exports, but for the last image

_known = {}  # {key: what _join gives}, in the order of their last use


def grid(image):
    """(columns, rows) from the origin on that hold all tiles; (1, 1) of other images."""
    if image.source != "TILED":
        return 1, 1
    columns, rows = zip(*(_place(tile) for tile in image.tiles))
    return max(columns) + 1, max(rows) + 1


def joined(image, pixels_of, missing, warn):
    """(h, w, 4) of all tiles, from the top. pixels_of(image of a tile): (h, w, 4), or None where its file is missing; missing: the
    colour where there is no tile.

    What files have is read once: Blender takes the image of a tile, loaded for its pixels, for a change of the scene, and would have a
    viewport export it without end."""
    key = _key(image)
    found = _known.pop(key, None) or _join(image, pixels_of, missing)
    if key:
        _known[key] = found
        while len(_known) > 1 and sum(whole.nbytes for whole, _ in _known.values()) > MOST_BYTES:
            del _known[next(iter(_known))]
    whole, lacking = found
    for number in lacking:
        warn(f"the file of tile {number} of the image '{image.name}' is missing; it is magenta, as in Cycles")
    return whole


def _key(image):
    """Equal for images of the same pixels; None of one that is not as its files are."""
    if image.is_dirty or image.packed_file:
        return None
    times = tuple((tile.number, _time(_path(image, tile))) for tile in image.tiles)
    return image.filepath, image.library and image.library.filepath, times, image.colorspace_settings.name, image.alpha_mode


def _time(path):
    """When a file was changed last; None of one that is missing."""
    try:
        return os.stat(path).st_mtime_ns
    except OSError:
        return None


def _join(image, pixels_of, missing):
    """(pixels as `joined` has them, numbers of the tiles whose files are missing)."""
    tiles, lacking, (columns, rows) = {}, [], grid(image)
    for tile in image.tiles:
        found = _tile(image, tile, pixels_of)
        if found is None:
            lacking.append(tile.number)
        else:
            tiles[_place(tile)] = found
    height, width = (max((t.shape[axis] for t in tiles.values()), default=1) for axis in (0, 1))
    while height * width * columns * rows > MOST_TEXELS and max(height, width) > 1:
        height, width = max(height // 2, 1), max(width // 2, 1)
    whole = np.empty((rows * height, columns * width, 4), np.float32)
    whole[:] = missing
    for (column, row), found in tiles.items():
        top = (rows - 1 - row) * height
        whole[top:top + height, column * width:(column + 1) * width] = _resized(found, height, width)
    return whole, lacking


def _place(tile):
    """(column, row)."""
    return (tile.number - FIRST) % PER_ROW, (tile.number - FIRST) // PER_ROW


def _path(image, tile):
    column, row = _place(tile)
    path = bpy.path.abspath(image.filepath, library=image.library)
    return path.replace("<UDIM>", str(tile.number)).replace("<UVTILE>", f"u{column + 1}_v{row + 1}")


def _tile(image, tile, pixels_of):
    """The pixels of a tile, of which Blender itself shows those of the first one alone; None where they are missing."""
    if tile == image.tiles[0] and image.size[0] > 0:
        return pixels_of(image)
    try:
        alone = bpy.data.images.load(_path(image, tile))
    except RuntimeError:
        return None
    try:
        alone.colorspace_settings.name, alone.alpha_mode = image.colorspace_settings.name, image.alpha_mode
        return pixels_of(alone) if alone.size[0] > 0 else None
    finally:
        bpy.data.images.remove(alone)


def _resized(values, height, width):
    """The same image with so many pixels: means over whole ones where they divide it, else the nearest ones."""
    rows, columns = values.shape[:2]
    if rows % height == 0 and columns % width == 0:
        return values.reshape(height, rows // height, width, columns // width, -1).mean(axis=(1, 3))
    return values[(np.arange(height) + 0.5).astype(int) * rows // height][:, (np.arange(width) + 0.5).astype(int) * columns // width]
