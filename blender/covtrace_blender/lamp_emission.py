"""Light of a lamp as its nodes make it: a colour, and where they have a photometric file an image over directions."""

import math

import bpy
import numpy as np
from mathutils import Euler, Matrix

from .node_signature import tree_of
from .photometry import SIZE, Damaged, directions_of_rows
from .shader_nodes.blackbody import blackbody, blackbody_temperature
from .shader_nodes.evaluator import Evaluator
from .shader_nodes.flat import flat_socket
from .shader_nodes.place import LampPlace
from .shader_nodes.unsupported import Unsupported


_MATHS = {"ADD": np.add, "SUBTRACT": np.subtract, "MULTIPLY": np.multiply,
          "DIVIDE": lambda a, b: np.where(np.equal(b, 0), 0, np.divide(a, np.where(np.equal(b, 0), 1, b)))}

ROWS_OF_AREA = 256  # of images over the UV map of area lamps, and their columns; what they light is blurred

# Share of an image by which its channels may differ and still be one colour; the light of a lamp has one in all directions.
SAME_COLOUR = 1e-3


class LampEmission:
    """Reads the nodes of a lamp. `images`: PhotometricImages; `directions`: what takes directions of the light's space to those
    by which the lamp's nodes ask (3, 3), the one direction (3) that a sun has, or None for lamps without photometric files."""

    def __init__(self, lamp, images, directions, warn):
        self.lamp, self.images, self.directions, self.warn = lamp, images, directions, warn

    def key(self):
        """Equal for lamps that `read` finds alike."""
        return self.lamp.name_full, None if self.directions is None else np.asarray(self.directions, float).tobytes()

    def read(self):
        """The lights whose sum it is: [(the colour by which the nodes multiply the lamp's power, an image (h, w) over directions that
        multiplies it, (h, w, 3) over the UV map of area lamps, or None)]."""
        lamp = self.lamp
        if not tree_of(lamp):
            return [((1, 1, 1), None)]
        output = lamp.node_tree.get_output_node("CYCLES")
        light = self._emitted(output.inputs["Surface"]) if output else np.zeros(3)
        if light.ndim == 1:
            return [(tuple(float(c) for c in light), None)]
        light = np.maximum(light, 0)
        if lamp.type == "AREA":
            return [((float(light.max()),) * 3, light / max(light.max(), 1e-30))]
        colour = light.mean((0, 1))
        if not colour.any():
            return []
        image = light.mean(-1) / colour.mean()
        if abs(light - image[..., None] * colour).max() > SAME_COLOUR * light.max():
            # An image over directions is grey, so that each channel is a light of its own.
            return [(tuple(np.eye(3)[c] * colour[c]), light[..., c] / colour[c]) for c in range(3) if colour[c] > 0]
        return [(tuple(float(c) for c in colour), image)]

    def _emitted(self, socket):
        """The colours (3) or (h, w, 3) that the tree of shaders at a socket emits: of each Emission the share that mixtures
        leave it."""
        shader = _node_at(socket)
        if shader is None:
            return np.zeros(3)
        if shader.type in ("MIX_SHADER", "ADD_SHADER"):
            first, second = (self._emitted(part) for part in shader.inputs[-2:])
            if shader.type == "ADD_SHADER":
                return first + second
            share = np.clip(np.asarray(self._number(shader.inputs[0]), float), 0, 1)[..., None]
            return (1 - share) * first + share * second
        if shader.type != "EMISSION":
            if shader.type.startswith("BSDF_"):
                return np.zeros(3)
            self.warn(f"lamp '{self.lamp.name}': its shader '{shader.name}' is not supported; its own colour and power are used")
            return np.ones(3)
        colour, strength = self._colour(shader.inputs["Color"]), self._number(shader.inputs["Strength"])
        return colour * np.asarray(strength)[..., None] if np.ndim(strength) else colour * strength

    def _colour(self, socket):
        temperature = blackbody_temperature(socket)
        if temperature is not None:
            return np.array(blackbody(temperature))
        node = _node_at(socket)
        if node is not None and node.type == "RGB":
            return np.array(node.outputs[0].default_value)[:3]
        number = self._linked_number(node)
        if number is not None:
            return np.asarray(number)[..., None] * np.ones(3)
        colour = self._evaluated(socket, is_number=False) if node else None
        if colour is not None:
            return colour
        self._tell_linked(socket)
        return np.array(socket.default_value)[:3]

    def _number(self, socket):
        number = self._linked_number(_node_at(socket))
        if number is None and socket.is_linked:
            number = self._evaluated(socket, is_number=True)
        if number is None:
            self._tell_linked(socket)
            number = socket.default_value
        return number

    def _linked_number(self, node):
        """The value of a node, a number or an image (h, w); None for nodes that are not understood."""
        if node is None:
            return None
        if node.type == "TEX_IES":
            return self._photometric(node)
        if node.type == "VALUE":
            return node.outputs[0].default_value
        if node.type == "MATH" and node.operation in _MATHS:
            value = _MATHS[node.operation](*(self._number(socket) for socket in node.inputs[:2]))
            return np.clip(value, 0, 1) if node.use_clamp else value
        return None

    def _photometric(self, node):
        """The light of a photometric file; one that can't be read leaves the lamp as it is without."""
        matrix = self._mapping(node)
        try:
            if self.directions is None:
                raise Damaged("area lamps have none here")
            if matrix is None:
                raise Damaged("what is linked to its Vector is not supported")
            return self._number(node.inputs["Strength"]) * self.images.of(self._text(node), matrix @ self.directions)
        except Damaged as problem:
            self.warn(f"lamp '{self.lamp.name}': its photometric file is left out: {problem}")
            return 1.0

    def _text(self, node):
        if node.mode == "INTERNAL":
            if node.ies is None:
                raise Damaged("none is chosen")
            return node.ies.as_string()
        if not node.filepath:
            raise Damaged("none is chosen")
        path = bpy.path.abspath(node.filepath, library=self.lamp.library)
        try:
            with open(path, encoding="latin-1") as file:
                return file.read()
        except OSError as problem:
            raise Damaged(f"'{path}' cannot be read ({problem.strerror})") from problem

    @staticmethod
    def _mapping(node):
        """The matrix of the Mapping node between the normal of the light and the file; None for other vectors."""
        matrix, source = Matrix.Identity(3), node.inputs["Vector"]
        mapping = _node_at(source)
        if mapping is not None and mapping.type == "MAPPING" and mapping.vector_type in ("POINT", "TEXTURE", "VECTOR"):
            location, rotation, scale = (mapping.inputs.get(name) for name in ("Location", "Rotation", "Scale"))
            if any(socket.is_linked for socket in (location, rotation, scale) if socket):
                return None
            if mapping.vector_type != "VECTOR" and any(location.default_value):
                return None
            matrix = Euler(rotation.default_value).to_matrix() @ Matrix.Diagonal(scale.default_value)
            if mapping.vector_type == "TEXTURE":
                if matrix.determinant() == 0:
                    return None
                matrix = matrix.inverted()
            source = mapping.inputs["Vector"]
        link = _link_at(source)
        if link is None:
            return np.array(matrix) if source == node.inputs["Vector"] else None
        is_normal = link.from_node.type == "TEX_COORD" and link.from_socket.name == "Normal"
        return np.array(matrix) if is_normal else None

    def _evaluated(self, socket, is_number):
        """The number or colour that a socket gets for the rays that lamps are sampled by, which in Cycles are of no kind, everywhere or as an
        image; None where it hangs on anything else."""
        def at(count):
            uv, normals = self._places(count)
            if bpy.app.version < (4, 0, 0):
                uv = None  # pictures lie otherwise in Cycles 3.4
            place = LampPlace(count * count, uv, normals, self.images.source)
            nodes = Evaluator(place)
            value = np.asarray(nodes.number(flat) if is_number else nodes.vector(flat), float)
            return None if place.hangs_on_angle else value, place.is_uniform

        flat = flat_socket(socket)
        try:
            value, is_uniform = at(1)
            if value is None or is_uniform:
                return value if value is None or value.shape in ((), (3,)) else value[0]
            if self.lamp.type == "SUN":
                return value.reshape(-1, 3)[0] if not is_number else value.ravel()[0]
            rows = ROWS_OF_AREA if self.lamp.type == "AREA" else SIZE
            value, _ = at(rows)
        except Unsupported:
            return None
        return np.broadcast_to(value, (rows * rows, *value.shape[1:])).reshape(rows, rows, *value.shape[1:])

    def _places(self, rows):
        """(UV, normals or None) of LampPlace, for an image of so many rows and columns from the top."""
        if self.lamp.type == "AREA":
            middles = (np.arange(rows) + 0.5) / rows
            u, v = np.meshgrid(middles, middles[::-1])
            return np.column_stack((u.ravel(), v.ravel())), None
        if self.lamp.type == "SUN":
            return np.full((rows * rows, 2), 0.5), np.tile(self.directions, (rows * rows, 1))
        away = directions_of_rows(np.arange(rows), rows).reshape(-1, 3) @ np.asarray(self.directions).T
        away /= np.linalg.norm(away, axis=1, keepdims=True)
        x, y, z = away.T
        if self.lamp.type == "SPOT":
            # The cone's circle fills the square of the map.
            widen = 0.5 / (math.tan(0.5 * self.lamp.spot_size) * np.maximum(-z, 1e-6))
            return np.column_stack((0.5 + widen * x, 0.5 + widen * y)), away
        return np.column_stack((0.5 * (1 - np.arctan2(x, y) / math.pi), 1 - np.arccos(np.clip(z, -1, 1)) / math.pi)), away

    def _tell_linked(self, socket):
        if socket.is_linked:
            self.warn(f"lamp '{self.lamp.name}': what is linked to '{socket.name}' of its shader is not supported; "
                      "the socket's own value is used")


def _link_at(socket):
    """The link that feeds a socket, reroutes passed."""
    while socket.is_linked:
        link = socket.links[0]
        if link.from_node.type != "REROUTE":
            return link
        socket = link.from_node.inputs[0]
    return None


def _node_at(socket):
    link = _link_at(socket)
    return link and link.from_node
