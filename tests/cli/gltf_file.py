"""A glTF file for tests of materials: one large square that a directional light lights and an orthographic camera sees."""

import base64
import json
import math
import struct
import zlib


def png(width, height, pixels):
    """The bytes of an 8-bit RGBA picture; pixels: (r, g, b, a) in [0, 255], row by row from the top."""
    rows = b"".join(b"\0" + b"".join(bytes(p) for p in pixels[y * width:(y + 1) * width]) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">2I5B", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def uri(data, kind="application/octet-stream"):
    return f"data:{kind};base64," + base64.b64encode(data).decode()


def shining(colour):
    """A material that sends out twice this colour on both sides."""
    return {"emissiveFactor": colour, "doubleSided": True, "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}}


def direction(azimuth, polar):
    """The unit vector at these angles in degrees: azimuth from +x towards +y, polar from +z."""
    a, p = math.radians(azimuth), math.radians(polar)
    return math.sin(p) * math.cos(a), math.sin(p) * math.sin(a), math.cos(p)


def normalized(v):
    size = math.sqrt(sum(x * x for x in v))
    return [x / size for x in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def looking_from(towards, distance):
    """The matrix of a node whose z axis is `towards` and that stands there."""
    up = [0, 1, 0] if abs(towards[1]) < 0.9 else [1, 0, 0]
    x = normalized(cross(up, towards))
    y = cross(towards, x)
    return [*x, 0, *y, 0, *towards, 0, *[distance * t for t in towards], 1]


def lit_square(material, eye, light, images=(), uv=((0, 100), (100, 100), (100, 0), (0, 0)), tangent=None):
    """The text of a file whose square in z = 0 has its tangent along +x, its bitangent along +y. All of it is lit by a directional
    light of 1 from `light` and seen from `eye`, both unit vectors. images: of the textures, as PNG. tangent: TANGENT of all corners."""
    corners = [-50, -50, 0, 50, -50, 0, 50, 50, 0, -50, 50, 0]
    data = struct.pack("<12f", *corners) + struct.pack("<8f", *[x for st in uv for x in st]) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    file = plain_square(data, material, eye, light, images)
    if tangent:
        more = struct.pack("<12f", *[0, 0, 1] * 4) + struct.pack("<16f", *tangent * 4)
        file["meshes"][0]["primitives"][0]["attributes"] |= {"NORMAL": 3, "TANGENT": 4}
        file["accessors"] += [{"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC3"},
                              {"bufferView": 4, "componentType": 5126, "count": 4, "type": "VEC4"}]
        file["bufferViews"] += [{"buffer": 1, "byteLength": 48}, {"buffer": 1, "byteOffset": 48, "byteLength": 64}]
        file["buffers"].append({"byteLength": len(more), "uri": uri(more)})
    return json.dumps(file)


def plain_square(data, material, eye, light, images):
    """The document of lit_square without tangents. data: corners, coordinates and indices."""
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 1}]}},
        "nodes": [
            {"mesh": 0},
            {"camera": 0, "matrix": looking_from(eye, 200)},
            {"matrix": looking_from(light, 1), "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 1000}}],
        "materials": [material],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "images": [{"uri": uri(image, "image/png")} for image in images],
        "textures": [{"source": i} for i in range(len(images))],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-50, -50, 0], "max": [50, 50, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32}, {"buffer": 0, "byteOffset": 80, "byteLength": 12},
        ],
        "buffers": [{"byteLength": len(data), "uri": uri(data)}],
    }
