"""Inputs of a shader node's sockets: constants, and images with their place and treatment."""

import numpy as np

from .blackbody import blackbody, temperature_of


class Value:
    """Value of a socket: a constant, or an image with a treatment."""

    def __init__(self, constant=None, image=None, mapping=None, channel=None, scale=1.0, offset=0.0, filter="bilinear",
                 wrap="repeat"):
        self.constant, self.image, self.mapping, self.channel = constant, image, mapping, channel
        self.scale, self.offset, self.filter, self.wrap = scale, offset, filter, wrap

    def inverse(self, whole=1.0):
        """whole - this."""
        if self.image:
            return Value(image=self.image, mapping=self.mapping, channel=self.channel, scale=-self.scale,
                         offset=whole - self.offset, filter=self.filter, wrap=self.wrap)
        if hasattr(self.constant, "__len__"):
            return Value(tuple(whole - c for c in self.constant))
        return Value(whole - self.constant)

    def is_plainly_placed(self):
        return self.mapping == PLAIN_MAPPING and self.filter == "bilinear" and self.wrap == "repeat"

    def apply(self, pixels):
        """(h, w, 4) to (h, w, 3), or to (h, w) where one number is wanted."""
        if self.channel == "grey":
            values = pixels[..., :3] @ np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)
        elif self.channel is not None:
            values = pixels[..., "RGBA".index(self.channel)]
        else:
            values = pixels[..., :3]
        return values * self.scale + self.offset

    def key(self):
        return (self.channel, self.scale, self.offset)


PLAIN_MAPPING = (1, 1, 0, 0)

# Blender's ways to go on beyond an image, in pbrt's words.
WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "black"}


class SocketReader:
    """Reads sockets of the material `name`; what is left out is told to `warn`, and `uv_maps` collects the names of the UV
    maps that images want ("": the mesh's)."""

    def _linked(self, socket):
        """The node and socket that feed it, reroutes passed."""
        while socket.is_linked:
            link = socket.links[0]
            if link.from_node.type != "REROUTE":
                return link.from_node, link.from_socket
            socket = link.from_node.inputs[0]
        return None, None

    def _value(self, socket, grey=False):
        """Value of a socket; what is not understood becomes the socket's own constant, with a warning."""
        node, output = self._linked(socket)
        if node is None:
            return self._constant(socket.default_value, grey)
        value = self._node_value(node, output, grey)
        if value is None:
            self.warn(f"material '{self.name}': node '{node.name}' at '{socket.name}' is not supported; "
                      "the socket's own value is used")
            return self._constant(socket.default_value, grey)
        return value

    def _plain(self, socket):
        """A number where there can be no image; what is linked and no constant is told."""
        value = self._value(socket, True)
        if value.image:
            self.warn(f"material '{self.name}': an image at '{socket.name}' is not supported; the socket's own value is used")
            return float(socket.default_value)
        return float(value.constant)

    def _constant(self, v, grey):
        if hasattr(v, "__len__"):
            v = tuple(v)[:3]
            return Value(0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2] if grey else v)
        return Value(float(v) if grey else (float(v),) * 3)

    def _node_value(self, node, output, grey):
        if node.type == "RGB" or node.type == "VALUE":
            return self._constant(output.default_value, grey)
        if node.type == "BLACKBODY" and temperature_of(node) is not None:
            return self._constant(blackbody(temperature_of(node)), grey)
        if node.type == "TEX_IMAGE" and node.image:
            channel = "A" if output.name == "Alpha" else "grey" if grey else None
            if node.projection != "FLAT":
                self.warn(f"material '{self.name}': the projection of '{node.name}' is not supported; its image lies flat")
            if node.extension not in WRAPS:
                self.warn(f"material '{self.name}': the extension of '{node.name}' is not supported; its image repeats")
            return Value(image=node.image, mapping=self._mapping(node), channel=channel,
                         filter="point" if node.interpolation == "Closest" else "bilinear",
                         wrap=WRAPS.get(node.extension, "repeat"))
        if node.type in ("SEPARATE_COLOR", "SEPRGB") and grey and getattr(node, "mode", "RGB") == "RGB":
            source = self._node_value(*self._linked(node.inputs[0]), False) if node.inputs[0].is_linked else None
            if source and source.image and output.name[:1] in "RGB":
                source.channel = output.name[:1]
                return source
        if node.type == "MATH" and grey and node.operation == "SUBTRACT" and not node.inputs[0].is_linked:
            return self._value(node.inputs[1], True).inverse(node.inputs[0].default_value)
        if node.type == "INVERT" and not node.inputs[0].is_linked and node.inputs[0].default_value == 1:
            return self._value(node.inputs[1], grey).inverse()
        return None

    def _is_uv(self, node, output):
        """Whether the node gives texture coordinates of a mesh; notes of which map."""
        if node is None or node.type == "TEX_COORD" and output.name == "UV":
            name = ""
        elif node.type == "UVMAP":
            name = node.uv_map
        else:
            return False
        if name not in self.uv_maps:
            self.uv_maps.append(name)
        return True

    def _mapping(self, node):
        """pbrt's scale and offset of (u, v), from a Mapping node."""
        source, output = self._linked(node.inputs["Vector"])
        if self._is_uv(source, output):
            return PLAIN_MAPPING
        if source.type == "MAPPING" and source.vector_type in ("POINT", "TEXTURE"):
            inner, inner_output = self._linked(source.inputs["Vector"])
            linked = any(source.inputs[name].is_linked for name in ("Rotation", "Location", "Scale"))
            rotation = source.inputs["Rotation"].default_value
            location, scale = source.inputs["Location"].default_value, source.inputs["Scale"].default_value
            if not linked and max(map(abs, rotation)) < 1e-6 and self._is_uv(inner, inner_output):
                if source.vector_type == "POINT":
                    return (scale[0], scale[1], location[0], location[1])
                if scale[0] != 0 and scale[1] != 0:
                    return (1 / scale[0], 1 / scale[1], -location[0] / scale[0], -location[1] / scale[1])
        self._is_uv(None, None)
        self.warn(f"material '{self.name}': only UV coordinates, scaled and moved, place images; "
                  f"those of '{node.name}' are used as they are")
        return PLAIN_MAPPING
