"""Atlases of the last export, kept so that the next frame, or a moved object in a viewport, lays out none again."""

import hashlib

import numpy as np

from .atlas import Atlas

MOST_BYTES = 1 << 28  # kept during an export, and between two; texels, which are quickly found again, go first

_known = {}  # {key: Atlas}


def digest(*arrays):
    """A text that is equal for equal arrays."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(repr((array.shape, array.dtype.str)).encode() + np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


class Atlases:
    """Those of one export, which remembers the last one's."""

    def __init__(self):
        self._used, self._last, self._bytes = {}, None, {}

    def of(self, corners, triangles, density, most_texels):
        """(key, Atlas) as Atlas has them; the key is equal for equal ones. The texels of the last one are asked for until the next one is."""
        self._bound_texels()
        key = digest(corners, triangles, density, np.array(most_texels))
        found = self._used.get(key) or _known.get(key) or Atlas(corners, triangles, density, most_texels)
        self._used[key], self._last = found, key
        return key, found

    def _bound_texels(self):
        if self._last:
            self._bytes[self._last] = self._used[self._last].bytes_of_texels()
        if sum(self._bytes.values()) > MOST_BYTES:
            for key in self._bytes:
                self._used[key].forget_texels()
            self._bytes.clear()

    def keep(self):
        """Ends the export."""
        kept, size = {}, 0
        for key, atlas in self._used.items():
            size += atlas.bytes_of_layout()
            if size <= MOST_BYTES:
                kept[key] = atlas
        for atlas in kept.values():
            size += atlas.bytes_of_texels()
            if size > MOST_BYTES:
                atlas.forget_texels()
        _known.clear()
        _known.update(kept)
