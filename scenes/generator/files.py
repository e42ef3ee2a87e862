"""Binary writers: PNG (8 bit), PFM (32-bit float) and little-endian PLY."""

import struct
import zlib
from array import array
from pathlib import Path


def _png_chunk(kind, payload):
    body = kind + payload
    return struct.pack(">I", len(payload)) + body + struct.pack(">I", zlib.crc32(body))


def write_png(path, rows, channels):
    """Writes rows of bytes (top row first, `channels` 1 or 3 bytes a pixel) as an 8-bit PNG."""
    width = len(rows[0]) // channels
    color_type = {1: 0, 3: 2}[channels]
    header = struct.pack(">IIBBBBB", width, len(rows), 8, color_type, 0, 0, 0)
    raw = b"".join(b"\0" + bytes(row) for row in rows)
    data = (
        b"\x89PNG\r\n\x1a\n"
        + _png_chunk(b"IHDR", header)
        + _png_chunk(b"IDAT", zlib.compress(raw, 6))
        + _png_chunk(b"IEND", b"")
    )
    Path(path).write_bytes(data)


def _little_endian(values, typecode):
    data = array(typecode, values)
    if struct.pack("=H", 1) != struct.pack("<H", 1):
        data.byteswap()
    return data.tobytes()


def write_pfm(path, rows):
    """Writes rows of interleaved RGB floats, top row first, as a little-endian PFM."""
    width = len(rows[0]) // 3
    parts = [f"PF\n{width} {len(rows)}\n-1.0\n".encode("ascii")]
    # The format stores the bottom row first.
    parts.extend(_little_endian(row, "f") for row in reversed(rows))
    Path(path).write_bytes(b"".join(parts))


def write_ply(path, mesh):
    """Writes a mesh with positions, normals and uv as a binary little-endian PLY."""
    header = "\n".join(
        ["ply", "format binary_little_endian 1.0", f"element vertex {len(mesh.positions)}"]
        + [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz", "u", "v")]
        + [f"element face {len(mesh.faces)}", "property list uint8 int vertex_indices"]
        + ["end_header", ""]
    )
    vertices = []
    for position, normal, uv in zip(mesh.positions, mesh.normals, mesh.uvs):
        vertices += (*position, *normal, *uv)
    faces = b"".join(struct.pack("<Biii", 3, *face) for face in mesh.faces)
    Path(path).write_bytes(header.encode("ascii") + _little_endian(vertices, "f") + faces)
