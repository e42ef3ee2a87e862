"""The layers of covtrace's images. They are EXR files of one part, 32-bit float, scan lines, ZIP or none (openexr.com,
"File Layout"); Blender's own loader matches passes by the name of the view layer, which users change."""

import struct
import zlib

import numpy as np

_ROWS_PER_BLOCK = {0: 1, 3: 16}  # by compression: none, ZIP


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _header(data):
    """{name: raw bytes} of the attributes, and the offset behind them."""
    attributes, at = {}, 8
    while data[at] != 0:
        name, at = _text(data, at)
        _, at = _text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _channels(raw):
    names, at = [], 0
    while raw[at] != 0:
        name, at = _text(raw, at)
        names.append(name)
        at += 16
    return names


def _unzip(block, size):
    if len(block) == size:
        return np.frombuffer(block, dtype=np.uint8)
    coded = np.frombuffer(zlib.decompress(block), dtype=np.uint8)
    # Each byte is the difference to the one before, plus 128.
    plain = np.cumsum(coded.astype(np.int64) - 128) + 128
    half = (len(coded) + 1) // 2
    result = np.empty(len(coded), dtype=np.uint8)
    result[0::2], result[1::2] = plain[:half] & 255, plain[half:] & 255
    return result


def read(path):
    """{channel: (height, width) float32, rows from the bottom, as Blender has them}."""
    with open(path, "rb") as file:
        data = file.read()
    attributes, at = _header(data)
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names = _channels(attributes["channels"])
    rows_per_block = _ROWS_PER_BLOCK[attributes["compression"][0]]
    blocks = -(-height // rows_per_block)
    pixels = np.empty((height, len(names), width), dtype=np.float32)
    for offset in struct.unpack_from(f"<{blocks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(rows_per_block, height - (y - y0))
        raw = _unzip(data[offset + 8 : offset + 8 + size], rows * len(names) * width * 4)
        pixels[y - y0 : y - y0 + rows] = raw.view("<f4").reshape(rows, len(names), width)
    return {name: pixels[::-1, i] for i, name in enumerate(names)}


def pixels(channels, names):
    """(height, width, n) of n of them, rows from the bottom."""
    return np.ascontiguousarray(np.stack([channels[name] for name in names], axis=-1))
