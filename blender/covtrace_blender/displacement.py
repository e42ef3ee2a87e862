"""Displacement that moves the vertices of a mesh, as nodes at a material's output tell."""

import numpy as np

from . import attributes, export_meshes, mesh_numbers
from .body import Body, corner_normals, keep_undeformed
from .node_signature import tree_of
from .shader_nodes.evaluator import evaluated
from .shader_nodes.flat import flat_output
from .shader_nodes.place import BodyPlace
from .shader_nodes.unsupported import Unsupported

MOVES = ("DISPLACEMENT", "BOTH")  # methods of materials


def method_of(material):
    """Blender's word for what Displacement does to a material: BUMP, DISPLACEMENT or BOTH."""
    # Before Blender 4.1 the settings of Cycles have it
    return getattr(material, "displacement_method", None) or getattr(getattr(material, "cycles", None), "displacement_method", "BUMP")


def node_of(material):
    """The node that moves vertices of what a material is on; None where none does."""
    if not tree_of(material) or method_of(material) not in MOVES:
        return None
    output = flat_output(material.node_tree)
    link = next(iter(output.inputs["Displacement"].links), None) if output else None
    return link.from_node if link else None


class _Vertices:
    """A body whose places are vertices: each at a corner of a triangle, as BodyPlace asks for it. corner: (n,) numbers of corners."""

    def __init__(self, body, corner):
        self._body, self._corner = body, corner

    def knows(self, kind):
        return self._body.knows(kind)

    def values(self, kind, texels, shift):
        return self._body.corners(kind).reshape(-1, 3)[self._corner[texels]].astype(np.float32)


class Displacer:
    """Displaces meshes of objects. source: pixels of images, as TextureFiles has it; owner_of(material): its Owner; warn(text): is told what
    is left out."""

    def __init__(self, source, owner_of, warn):
        self._source, self._owner_of, self._warn = source, owner_of, warn

    def displace(self, mesh, materials, matrix):
        """Moves the vertices of a mesh whose slots have these materials; matrix: 4x4 to the world, None where it is not known. Each vertex is
        moved once, by the first triangle that has it, as in Cycles. Returns None, or (which triangles, (n, 3, 3) normals of all corners before
        that) of those on which heights turn normals, too: in Cycles they turn these."""
        nodes = {material: node_of(material) for material in materials}
        if not any(nodes.values()) or not Body.is_of(mesh):
            return None
        mesh.calc_loop_triangles()
        triangles, places = export_meshes.triangles(mesh), export_meshes.positions(mesh)
        moves = np.zeros((len(places), 3))
        first = np.full(len(places), len(triangles))
        chosen_of = {material: export_meshes.triangles_of(mesh, materials, material) for material, node in nodes.items() if node}
        for chosen in chosen_of.values():
            np.minimum.at(first, triangles[chosen], np.flatnonzero(chosen)[:, None])
        for material, chosen in chosen_of.items():
            numbers = np.flatnonzero(chosen)
            corners = triangles[numbers].ravel()
            own = np.flatnonzero(first[corners] == np.repeat(numbers, 3))
            vertices, index = np.unique(corners[own], return_index=True)
            if len(vertices):
                body = Body(mesh, chosen, matrix, attributes.names(material.node_tree), mesh_numbers.asked_for(material.node_tree))
                moves[vertices] = self._moves(nodes[material], material, body, own[index], matrix)
        turned = np.zeros(len(triangles), bool)
        for material, chosen in chosen_of.items():
            turned |= chosen & (method_of(material) == "BOTH")
        kept = (turned, corner_normals(mesh, places, triangles, export_meshes.triangle_loops(mesh))) if turned.any() else None
        keep_undeformed(mesh)
        export_meshes.reshape(mesh, (places + moves).astype(np.float32))
        return kept

    def _moves(self, node, material, body, corner, matrix):
        """(n, 3) in the mesh's space, at corners of the body's triangles."""
        place = BodyPlace(_Vertices(body, corner), np.arange(len(corner)), (0.0, 0.0), self._source, None, self._owner_of(material))
        try:
            return self._offset(node, body, corner, place, np.eye(4) if matrix is None else matrix)
        except Unsupported as problem:
            self._warn(f"material '{material.name}': node '{problem.node.name}' at its Displacement is not supported ({problem.reason}); it moves "
                       "nothing")
            return np.zeros((len(corner), 3))

    @staticmethod
    def _offset(node, body, corner, place, matrix):
        def number(name):
            return np.broadcast_to(evaluated(lambda nodes: nodes.number(node.inputs[name]), place), len(corner))[:, None].astype(float)

        if node.type == "DISPLACEMENT" and not node.inputs["Normal"].is_linked:
            normal = body.corners("NORMAL").reshape(-1, 3)[corner]
            amount = (number("Height") - number("Midlevel")) * number("Scale")
            if node.space == "OBJECT":
                return normal * amount
            turned = normal @ np.linalg.inv(matrix[:3, :3])
            turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-30)
        elif node.type == "VECTOR_DISPLACEMENT" and node.space != "TANGENT":
            vector = np.broadcast_to(evaluated(lambda nodes: nodes.vector(node.inputs["Vector"]), place), (len(corner), 3))
            turned, amount = vector - number("Midlevel"), number("Scale")
            if node.space == "OBJECT":
                return turned * amount
        else:
            raise Unsupported(node, "it is no Displacement along the normal and no vector of the object's or the world's space")
        return (turned * amount) @ np.linalg.inv(matrix[:3, :3]).T
