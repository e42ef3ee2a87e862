"""Reads the EXR files that the program writes, and writes such ones: one part, 32-bit float, scan lines, ZIP or none.

Written from the description of the file layout at openexr.com, without a library, so that it is a second opinion."""

import array
import struct
import sys
import zlib
from dataclasses import dataclass, field

MAGIC = 20000630
FLOAT = 2
NO_COMPRESSION, ZIP_SCANLINES = 0, 3
ROWS_PER_BLOCK = {NO_COMPRESSION: 1, ZIP_SCANLINES: 16}


@dataclass
class Exr:
    attributes: dict  # name: (type, value)
    channels: list  # names as stored, all FLOAT
    pixels: dict = field(default_factory=dict)  # channel: array('f'), row by row

    def value(self, name):
        return self.attributes[name][1]

    @property
    def data_window(self):
        """The window as x0, y0, x1, y1; end exclusive."""
        return self._exclusive("dataWindow")

    @property
    def display_window(self):
        return self._exclusive("displayWindow")

    @property
    def width(self):
        x0, _, x1, _ = self.data_window
        return x1 - x0

    @property
    def height(self):
        _, y0, _, y1 = self.data_window
        return y1 - y0

    def _exclusive(self, name):
        x0, y0, x1, y1 = self.value(name)
        return x0, y0, x1 + 1, y1 + 1


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _decode(kind, raw):
    if kind == "int":
        return struct.unpack("<i", raw)[0]
    if kind == "float":
        return struct.unpack("<f", raw)[0]
    if kind == "string":
        return raw.decode()
    if kind == "box2i":
        return struct.unpack("<4i", raw)
    if kind in ("v2f", "v3f", "m33f", "m44f"):
        return struct.unpack(f"<{len(raw) // 4}f", raw)
    if kind in ("compression", "lineOrder"):
        return raw[0]
    if kind == "chlist":
        channels, at = [], 0
        while raw[at] != 0:
            name, at = _text(raw, at)
            channels.append((name, struct.unpack_from("<i", raw, at)[0]))
            at += 16
        return channels
    return raw


def read_header(data):
    """The header and the offset behind it."""
    magic, version = struct.unpack_from("<II", data)
    if magic != MAGIC:
        raise ValueError("no EXR file")
    if version & 0xFF != 2 or version & 0x1A00:
        raise ValueError(f"not a file of one part with scan lines: version field {version:#x}")
    attributes, at = {}, 8
    while data[at] != 0:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = (kind, _decode(kind, data[at + 4 : at + 4 + size]))
        at += 4 + size
    channels = attributes["channels"][1]
    if any(kind != FLOAT for _, kind in channels):
        raise ValueError("a channel is not 32-bit float")
    return Exr(attributes, [name for name, _ in channels]), at + 1


def _unzip(block, size):
    if len(block) == size:
        return block
    coded = bytearray(zlib.decompress(block))
    for i in range(1, len(coded)):
        coded[i] = (coded[i - 1] + coded[i] - 128) & 0xFF
    half = (len(coded) + 1) // 2
    plain = bytearray(len(coded))
    plain[0::2], plain[1::2] = coded[:half], coded[half:]
    return bytes(plain)


def read(path):
    """The header and all pixels."""
    with open(path, "rb") as file:
        data = file.read()
    image, at = read_header(data)
    rows_per_block = ROWS_PER_BLOCK[image.value("compression")]
    _, y0, _, y1 = image.data_window
    row_bytes = image.width * 4
    blocks = -(-image.height // rows_per_block)
    for name in image.channels:
        image.pixels[name] = array.array("f", bytes(row_bytes * image.height))
    for offset in struct.unpack_from(f"<{blocks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(rows_per_block, y1 - y)
        raw = _unzip(data[offset + 8 : offset + 8 + size], rows * row_bytes * len(image.channels))
        position = 0
        for row in range(y - y0, y - y0 + rows):
            for name in image.channels:
                values = array.array("f", raw[position : position + row_bytes])
                if sys.byteorder == "big":
                    values.byteswap()
                image.pixels[name][row * image.width : (row + 1) * image.width] = values
                position += row_bytes
    return image


def write(path, width, height, channels, metadata):
    """Writes channels {name: values row by row} without compression; metadata are whole numbers and texts."""
    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    names = sorted(channels, key=str.encode)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", MAGIC, 2 | (0x400 if any(len(n) > 31 for n in names) else 0))
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iB3xii", FLOAT, 0, 1, 1) for n in names) + b"\0"
    header += attribute("channels", "chlist", listed) + attribute("compression", "compression", bytes([NO_COMPRESSION]))
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", bytes(8)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    for name, value in metadata.items():
        is_number = isinstance(value, int)
        header += attribute(name, "int" if is_number else "string", struct.pack("<i", value) if is_number else value.encode())
    header += b"\0"
    row_bytes = 4 * width * len(names)
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + y * (8 + row_bytes) for y in range(height)))
    rows = []
    for y in range(height):
        values = [v for name in names for v in channels[name][y * width : (y + 1) * width]]
        rows.append(struct.pack(f"<ii{len(values)}f", y, row_bytes, *values))
    with open(path, "wb") as file:
        file.write(header + offsets + b"".join(rows))
