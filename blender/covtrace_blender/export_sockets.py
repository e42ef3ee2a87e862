"""Inputs of a shader node's sockets: constants, and images with their place and treatment, Blender's own or baked."""

import numpy as np

from . import tiled_images
from .baking import Surface
from .node_images import image_of
from .shader_nodes.unsupported import NeedsBody, Unsupported
from .values import PLAIN_MAPPING, Value
from .working_space import luminance


# Blender's ways to go on beyond an image, in pbrt's words.
WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "black"}


class SocketReader:
    """Reads FlatSockets of the material `name` on `surface`; what is left out is told to `warn`, `uv_maps` collects the names
    of the UV maps that images want ("": the mesh's), and `hangs_on_object` is whether the object counts that it is on.
    `baker`: a Baker, `baked`: BakedImages."""

    surface, hangs_on_object = Surface(), False

    def _linked(self, socket):
        """The node and socket that feed it."""
        link = next(iter(socket.links), None)
        return (link.from_node, link.from_socket) if link else (None, None)

    def _value(self, socket, grey=False, only_unit_square=False, by_angle=True):
        """Value of a socket; what is not understood becomes the socket's own constant, with a warning.

        only_unit_square: for images that can have no other place; by_angle: whether it may hang on the angle of sight, of which it else is
        the mean, with a warning.
        """
        node, output = self._linked(socket)
        if node is None:
            return self._constant(socket.default_value, grey)
        direct = None if self.surface.body else self._direct_value(node, output, grey)
        if direct is not None:
            return direct
        try:
            return self._baked_value(socket, grey, only_unit_square, by_angle)
        except Unsupported as problem:
            self._ask_for_body(problem)
            if node.type == "TEX_IMAGE" and node.image and not self.surface.body:
                return self._image_as_it_lies(node, output, grey, problem)
            self.warn(f"material '{self.name}': node '{problem.node.name}' at '{socket.name}' is not supported "
                      f"({problem.reason}); the socket's own value is used")
            return self._constant(socket.default_value, grey)

    def _baked_value(self, socket, is_number, only_unit_square=False, by_angle=True):
        """Value of a number or a vector. The rest as _value has it. Raises Unsupported."""
        def get(nodes):
            return nodes.number(socket) if is_number else nodes.vector(socket)

        return self._baked_function(get, socket, (is_number, only_unit_square), only_unit_square, by_angle)

    def _baked_function(self, get, socket, how, only_unit_square=False, by_angle=True):
        """Value of what a function of an Evaluator gives. It hangs on the tree of the socket, and is told from others of that socket by
        `how`. Raises Unsupported."""
        how = (*how, by_angle, self.baker.ray, self.baker.owner and self.baker.owner.key())
        baked = self.baked.of(socket, self.surface, how, lambda: self.baker.bake(get, self.surface, only_unit_square, by_angle))
        if baked.is_cut:
            self.warn(f"material '{self.name}': a texture that can only lie on the unit square repeats beyond it")
        if baked.is_mean:
            self.warn(f"material '{self.name}': what feeds '{socket.name}' of '{socket.node.name}' hangs on the angle of sight; it is the mean "
                      "over all angles")
        for name in baked.uv_maps:
            self._note_uv_map(name)
        return baked.value()

    def _ask_for_body(self, problem):
        """Raises `problem` again where the surface has a body that solves it."""
        if isinstance(problem, NeedsBody):
            self.hangs_on_object = True
            if self.surface.body_of:
                try:
                    raise problem
                finally:
                    del problem  # else its traceback and it would hold on to each other, and to all that is known here

    def _plain(self, socket):
        """A number where there can be no image; what is linked and no constant is told."""
        value = self._value(socket, True, by_angle=False)
        if value.varies:
            self.warn(f"material '{self.name}': an image at '{socket.name}' is not supported; the socket's own value is used")
            return float(socket.default_value)
        return float(value.constant)

    def _constant(self, v, grey):
        if hasattr(v, "__len__"):
            v = tuple(v)[:3]
            return Value(float(luminance(np.array(v, np.float32))) if grey else v)
        return Value(float(v) if grey else (float(v),) * 3)

    def _direct_value(self, node, output, grey):
        """An image as it is in its file, and what is easily done to it; None for all else."""
        if node.type == "TEX_IMAGE" and node.image:
            mapping = self._mapping(node)
            if node.projection != "FLAT" or node.extension not in WRAPS or mapping is None:
                return None
            return self._image(node, output, grey, mapping)
        if node.type in ("SEPARATE_COLOR", "SEPRGB") and grey and getattr(node, "mode", "RGB") == "RGB":
            source = self._direct_value(*self._linked(node.inputs[0]), False) if node.inputs[0].is_linked else None
            if source and source.channel is None and output.name[:1] in "RGB":
                source.channel = output.name[:1]
                return source
        if node.type == "MATH" and node.operation == "SUBTRACT" and not node.use_clamp and not node.inputs[0].is_linked \
                and node.inputs[1].is_linked and grey:
            source = self._direct_value(*self._linked(node.inputs[1]), True)
            return source and source.inverse(node.inputs[0].default_value)
        if node.type == "INVERT" and not node.inputs[0].is_linked and node.inputs[0].default_value == 1 \
                and node.inputs[1].is_linked:
            source = self._direct_value(*self._linked(node.inputs[1]), grey)
            return source and source.inverse()
        return None

    def _image(self, node, output, grey, mapping):
        squares = tiled_images.grid(node.image)
        mapping = tuple(value / squares[k % 2] for k, value in enumerate(mapping))
        return Value(image=image_of(node), mapping=mapping, channel="A" if output.name == "Alpha" else "grey" if grey else None,
                     filter="point" if node.interpolation == "Closest" else "bilinear",
                     wrap=WRAPS.get(node.extension, "repeat"))

    def _image_as_it_lies(self, node, output, grey, problem):
        self.warn(f"material '{self.name}': node '{problem.node.name}' is not supported ({problem.reason}); the image "
                  f"of '{node.name}' lies on the UV map as it is")
        self._note_uv_map("")
        return self._image(node, output, grey, PLAIN_MAPPING)

    def _note_uv_map(self, name):
        if name not in self.uv_maps:
            self.uv_maps.append(name)

    def _is_uv(self, node, output):
        """Whether the node gives texture coordinates of a mesh; notes of which map."""
        if node is None or node.type == "TEX_COORD" and output.name == "UV":
            self._note_uv_map("")
        elif node.type == "UVMAP":
            self._note_uv_map(node.uv_map)
        else:
            return False
        return True

    def _mapping(self, node):
        """pbrt's scale and offset of (u, v), from a Mapping node; None for what these cannot tell."""
        source, output = self._linked(node.inputs["Vector"])
        if self._is_uv(source, output):
            return PLAIN_MAPPING
        if source.type == "MAPPING" and source.vector_type in ("POINT", "TEXTURE") and source.inputs["Vector"].is_linked:
            inner, inner_output = self._linked(source.inputs["Vector"])
            linked = any(source.inputs[name].is_linked for name in ("Rotation", "Location", "Scale"))
            rotation = source.inputs["Rotation"].default_value
            location, scale = source.inputs["Location"].default_value, source.inputs["Scale"].default_value
            if not linked and max(map(abs, rotation)) < 1e-6 and self._is_uv(inner, inner_output):
                if source.vector_type == "POINT":
                    return (scale[0], scale[1], location[0], location[1])
                if scale[0] != 0 and scale[1] != 0:
                    return (1 / scale[0], 1 / scale[1], -location[0] / scale[0], -location[1] / scale[1])
        return None
