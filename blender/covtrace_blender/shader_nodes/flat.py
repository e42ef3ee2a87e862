"""Trees of nodes as they are without groups, reroutes and muted nodes: each node sees what really feeds it."""

import numpy as np

from ..working_space import luminance


def flat_output(tree):
    """The FlatNode of a tree's active output for Cycles; None where there is none."""
    output = tree.get_output_node("CYCLES")
    return output and FlatNode(output, tree)


def flat_socket(socket):
    """The FlatSocket of a node that is in no group."""
    return FlatSocket(socket, FlatNode(socket.node, socket.id_data))


class FlatNode:
    """A node as Blender has it, but for its sockets. tree: the outermost one; groups: the group nodes that it is inside of, from the
    outermost one on. path: names that tell it from all other nodes of the tree."""

    def __init__(self, node, tree, groups=()):
        self._node, self.tree, self.groups = node, tree, groups
        self.path = (*(group.name for group in groups), node.name)

    def __getattr__(self, name):
        return getattr(self._node, name)

    def __eq__(self, other):
        return isinstance(other, FlatNode) and self.path == other.path and self.tree == other.tree

    def __hash__(self):
        return hash(self.path)

    @property
    def inputs(self):
        return _Sockets(self._node.inputs, self)

    @property
    def outputs(self):
        return _Sockets(self._node.outputs, self)


class _Sockets:
    """The inputs or outputs of a FlatNode, by name or number."""

    def __init__(self, sockets, node):
        self._sockets, self._node = sockets, node

    def __getitem__(self, key):
        found = self._sockets[key]
        return [FlatSocket(s, self._node) for s in found] if isinstance(key, slice) else FlatSocket(found, self._node)

    def __contains__(self, name):
        return name in self._sockets

    def __iter__(self):
        return (FlatSocket(socket, self._node) for socket in self._sockets)

    def get(self, name):
        return self[name] if name in self._sockets else None


class _Link:
    """Where a linked socket has its value from."""

    def __init__(self, from_node, from_socket):
        self.from_node, self.from_socket = from_node, from_socket


class FlatSocket:
    """A socket of a FlatNode. As an input it is linked where a node's output reaches it, through groups or not; else its
    default_value is what reaches it: that of the group's socket, where one feeds it."""

    def __init__(self, socket, node):
        self._socket, self.node = socket, node

    def __getattr__(self, name):
        return getattr(self._socket, name)

    @property
    def id_data(self):
        return self.node.tree

    @property
    def is_linked(self):
        return self._socket.is_linked if self._socket.is_output else self._source()[0] is not None

    @property
    def links(self):
        found, _ = self._source()
        return [found] if found else []

    @property
    def default_value(self):
        own = self._socket.default_value
        if self._socket.is_output:
            return own
        link, end = self._source()
        return own if link else _as_type_of(own, end)

    def _source(self):
        """(_Link or None, the socket whose default value counts without one)."""
        socket, groups = self._socket, self.node.groups
        while link := next((k for k in socket.links if k.is_valid and not k.is_muted), None):
            node, output = link.from_node, link.from_socket
            if node.type == "REROUTE":
                socket = node.inputs[0]
            elif node.mute:
                socket = next((k.from_socket for k in node.internal_links if k.to_socket == output), None)
            elif node.type == "GROUP":
                groups, socket = (*groups, node), _output_inside(node.node_tree, output.identifier)
            elif node.type == "GROUP_INPUT":
                group, groups = groups[-1], groups[:-1]
                socket = next((s for s in group.inputs if s.identifier == output.identifier), None)
            else:
                found = FlatNode(node, self.node.tree, groups)
                return _Link(found, FlatSocket(output, found)), None
            if socket is None:
                break
        is_end = socket is None or socket.node.type == "REROUTE"
        return None, self._socket if is_end else socket


def _output_inside(tree, identifier):
    """The input of a group's active output node; None for a group without a tree."""
    ends = [node for node in tree.nodes if node.type == "GROUP_OUTPUT" and node.is_active_output] if tree else []
    return next((socket for end in ends for socket in end.inputs if socket.identifier == identifier), None)


def _as_type_of(own, end):
    """The default value of the socket `end`, as a number or as many numbers as `own` is, by the rules of links."""
    value = end.default_value
    if not hasattr(value, "__len__"):
        return (*(float(value),) * 3, 1.0)[:len(own)] if hasattr(own, "__len__") else value
    if hasattr(own, "__len__"):
        return (*tuple(value)[:3], 1.0)[:len(own)]
    return float(luminance(np.array(value)[:3])) if end.type == "RGBA" else sum(tuple(value)[:3]) / 3
