"""Images of node trees as files that the scene names."""

import os
import struct
import zlib

import numpy as np

from . import tiled_images
from .baked import BakedImage
from .node_images import MISSING, NodeImage, with_other_opacity
from .working_space import from_rec709


def to_linear(values):
    """sRGB to linear, elementwise."""
    values = np.maximum(values, 0)
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def to_srgb(values):
    """Linear to sRGB, elementwise."""
    values = np.clip(values, 0, 1)
    return np.where(values <= 0.0031308, values * 12.92, 1.055 * values ** (1 / 2.4) - 0.055)


LINEAR = ("Linear", "Linear Rec.709")  # linear Rec.709 before Blender 4.0, and since


def pixels(image, warn):
    """(height, width, 4) float32 from the top, of all its tiles; colours linear where the image says that it is sRGB. image: or a
    NodeImage."""
    if image.source == "TILED":
        return tiled_images.joined(image, lambda tile: _own_pixels(tile, warn), MISSING, warn)
    return _own_pixels(image, warn)


def _own_pixels(image, warn):
    """The same of the first tile alone."""
    width, height = image.size
    if width == 0 or height == 0 or image.channels == 0:
        warn(f"the image '{image.name}' has no pixels (is its file '{image.filepath}' missing?); it is magenta, as in Cycles")
        return np.array([[MISSING]], dtype=np.float32)
    values = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(height, width, image.channels)[::-1]
    if image.channels < 4:
        rgba = np.ones((height, width, 4), dtype=np.float32)
        rgba[..., :3] = values[..., :3] if image.channels == 3 else values[..., :1]
        values = rgba
    values = values.copy()
    if isinstance(image, NodeImage):
        values = with_other_opacity(values, image.is_multiplied)
    if not image.is_float and _is_srgb(image, warn):
        values[..., :3] = from_rec709(to_linear(values[..., :3]))
    return values


def _is_srgb(image, warn):
    """Whether bytes are taken for sRGB; no other space but linear Rec.709 is known."""
    space = image.colorspace_settings
    if space.name == "sRGB" or space.is_data or space.name in LINEAR:
        return space.name == "sRGB"
    like = "sRGB" if "sRGB" in space.name else "linear"
    warn(f"the image '{image.name}' is in the colour space {space.name}, which is not supported; it is taken as {like}")
    return like == "sRGB"


def write_png(path, values):
    """(height, width) or (height, width, 3) in [0, 1] as 16-bit PNG, values as they are."""
    if values.ndim == 2:
        values = values[..., None]
    height, width, channels = values.shape
    integers = np.clip(values * 65535 + 0.5, 0, 65535).astype(">u2")
    rows = integers.reshape(height, -1).view(np.uint8).reshape(height, -1)
    raw = np.hstack([np.zeros((height, 1), dtype=np.uint8), rows]).tobytes()

    def chunk(name, data):
        return (struct.pack(">I", len(data)) + name + data +
                struct.pack(">I", zlib.crc32(name + data)))

    header = struct.pack(">IIBBBBB", width, height, 16, 2 if channels == 3 else 0, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                   chunk(b"IDAT", zlib.compress(raw, 1)) + chunk(b"IEND", b""))


def write_pfm(path, values):
    """(height, width, 3) floats as PFM."""
    height, width, _ = values.shape
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode("ascii"))
        file.write(np.ascontiguousarray(values[::-1]).astype("<f4").tobytes())


class TextureFiles:
    """Writes each combination of image and treatment once."""

    def __init__(self, folder, warn):
        self.folder, self.warn = folder, warn
        self.files = {}
        self.cache = {}

    def source(self, image):
        """Pixels of an image of Blender's or a NodeImage, (h, w, 4), or of a baked one, (h, w, 3)."""
        if isinstance(image, BakedImage):
            return image.values
        if image.name_full not in self.cache:
            self.cache[image.name_full] = pixels(image, self.warn)
        return self.cache[image.name_full]

    def write(self, image, key, treat):
        """The file's name, relative to the scene; treat: pixels to what is written."""
        full_key = (image.name_full, key)
        if full_key not in self.files:
            name = f"texture{len(self.files)}.png"
            write_png(os.path.join(self.folder, name), treat(self.source(image)))
            self.files[full_key] = name
        return self.files[full_key]

    def write_emission(self, image, key, treat):
        """The same for what lamps show: brighter than 1 where the image is."""
        full_key = (image.name_full, ("emission", key))
        if full_key not in self.files:
            values = np.maximum(treat(self.source(image)), 0)
            name = f"texture{len(self.files)}"
            if values.max() > 1:
                name += ".pfm"
                write_pfm(os.path.join(self.folder, name), values)
            else:
                name += ".png"
                write_png(os.path.join(self.folder, name), to_srgb(values))
            self.files[full_key] = name
        return self.files[full_key]

    def write_heights(self, image):
        """The file of a grey image's heights, of any size and sign."""
        full_key = (image.name_full, "heights")
        if full_key not in self.files:
            name = f"texture{len(self.files)}.pfm"
            write_pfm(os.path.join(self.folder, name), self.source(image)[..., :3])
            self.files[full_key] = name
        return self.files[full_key]
