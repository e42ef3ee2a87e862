"""Trees of nodes as they are without groups, reroutes and muted nodes: each node sees what really feeds it."""

import bpy
import numpy as np

from ..working_space import luminance


def flat_output(tree):
    """The FlatNode of a tree's active output for Cycles, which may be in a group; None where there is none."""
    return _output_of(tree, tree, ())


def _output_of(inner, tree, groups):
    """The same of a tree inside of these groups."""
    output = inner.get_output_node("CYCLES")
    if output:
        return FlatNode(output, tree, groups)
    inside = (_output_of(node.node_tree, tree, (*groups, node)) for node in inner.nodes if node.type == "GROUP" and node.node_tree)
    return next((found for found in inside if found), None)


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


class Conversion:
    """A node that turns what reaches a FlatSocket into its type, as a socket of a group does, or into the type of an output, as a
    muted node does."""

    type = "CONVERSION"

    def __init__(self, socket):
        self.inputs = [socket]
        self.name, self.path = socket.name, (*socket.node.path, "", socket.identifier)


class Shining:
    """The Emission that a colour or a number is where it reaches a FlatSocket of shaders, as in Cycles."""

    type, name, mute = "EMISSION", "Emission", False

    def __init__(self, socket, link):
        self.id_data, self.path = socket.id_data, (*socket.node.path, "", socket.identifier)
        self.outputs = [ShiningSocket(self, "Emission", "SHADER", None)]
        self.inputs = _ByName(ShiningSocket(self, "Color", "RGBA", (0.0, 0.0, 0.0, 1.0), link), ShiningSocket(self, "Strength", "VALUE", 1.0))


class ShiningSocket:
    """A socket of Shining, as a FlatSocket is one."""

    def __init__(self, node, name, kind, default_value, link=None):
        self.node, self.name, self.identifier, self.type, self.default_value = node, name, name, kind, default_value
        self.id_data, self.links, self.is_linked = node.id_data, [link] if link else [], link is not None


class _ByName(dict):
    """Sockets by their names, which are gone through in a row."""

    def __init__(self, *sockets):
        super().__init__((socket.name, socket) for socket in sockets)

    def __iter__(self):
        return iter(self.values())


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
        if found and self._socket.type == "SHADER" and found.from_socket.type != "SHADER":
            shining = Shining(self, found)
            return [_Link(shining, shining.outputs[0])]
        return [found] if found else []

    @property
    def default_value(self):
        own = self._socket.default_value
        if self._socket.is_output:
            return own
        link, end = self._source()
        if link or end is self._socket:
            return own
        return _as_type_of(own, end) if end else _zero(own)

    def _source(self):
        """(_Link or None, the socket whose default value counts without one, None for zero)."""
        return self._source_since_5() if bpy.app.version >= (5, 0, 0) else self._source_before_5()

    def _source_since_5(self):
        """Sockets of groups convert constants alone, and a link from a reroute or a muted node that nothing feeds is none; groups without
        an output and group inputs of the outermost tree are zero."""
        groups = self.node.groups
        link = _used_link(self._socket)
        while link and _passes(link.from_node):
            node, output = link.from_node, link.from_socket
            socket = node.inputs[0] if node.type == "REROUTE" else _passed_on(node, output)
            link = socket and _used_link(socket)
        if not link:
            return None, self._socket
        node, output = link.from_node, link.from_socket
        if node.type == "GROUP":
            socket, groups = _output_inside(node.node_tree, output.identifier), (*groups, node)
        elif node.type == "GROUP_INPUT":
            socket, groups = groups and _input_of(groups[-1], output.identifier), groups[:-1]
        else:
            found = FlatNode(node, self.node.tree, groups)
            return _Link(found, FlatSocket(output, found)), None
        if not socket:
            return None, None
        passed = FlatSocket(socket, FlatNode(socket.node, self.node.tree, groups))
        found, end = passed._source()
        return found, end and passed

    def _source_before_5(self):
        """Sockets on the way convert, as in Cycles; reroutes, muted nodes and groups without an output that nothing feeds are zero."""
        socket, groups = self._socket, self.node.groups
        if not socket.is_linked:
            return None, socket
        while link := _used_link(socket):
            node, output = link.from_node, link.from_socket
            if node.type == "REROUTE":
                socket = node.inputs[0]
            elif node.mute:
                socket = _passed_on(node, output) or self._socket
                if socket != self._socket and "VALUE" in (_kind(socket), _kind(output)) and _kind(socket) != _kind(output):
                    muted = FlatNode(node, self.node.tree, groups)
                    return _Link(Conversion(FlatSocket(socket, muted)), FlatSocket(output, muted)), None
            elif node.type == "GROUP":
                groups, socket = (*groups, node), _output_inside(node.node_tree, output.identifier)
            elif node.type == "GROUP_INPUT":
                # The outermost tree has none: nothing feeds its group inputs.
                group, groups = (groups[-1], groups[:-1]) if groups else (None, ())
                socket = _input_of(group, output.identifier) if group else self._socket
            else:
                found = FlatNode(node, self.node.tree, groups)
                return _Link(found, FlatSocket(output, found)), None
            if socket is None or socket == self._socket:
                break
            if _kind(socket) != _kind(self._socket):
                return self._converted(FlatSocket(socket, FlatNode(socket.node, self.node.tree, groups)))
        is_zero = socket is None or socket != self._socket and _passes(socket.node)
        return None, None if is_zero else self._socket if socket == self._socket else socket

    def _converted(self, passed):
        """The _source through a socket of another type."""
        link, end = passed._source()
        if link is None:
            return None, None if end is passed._socket and _passes(passed.node) else end and passed
        own, between, first = (_kind(socket) for socket in (self, passed, link.from_socket))
        is_narrow = between == "VALUE" and "VALUE" not in (own, first)
        is_weighed = own == "VALUE" and "VALUE" not in (between, first) and between != first
        return _Link(Conversion(passed), passed) if is_narrow or is_weighed else link, None


def _used_link(socket):
    """The link that feeds an input; None for no such."""
    # Blender looks through all links of a tree for those of one socket.
    return next((k for k in socket.links if k.is_valid and not k.is_muted), None) if socket.is_linked else None


def _passes(node):
    """Whether a node only hands on what reaches it."""
    return node.type == "REROUTE" or node.mute


def _passed_on(node, output):
    """The input that a muted node has in place of an output, or None."""
    return next((k.from_socket for k in node.internal_links if k.to_socket == output), None)


def _input_of(group, identifier):
    """The input of a group node by its identifier, or None."""
    return next((socket for socket in group.inputs if socket.identifier == identifier), None)


def _kind(socket):
    """The type of a socket, all of one number being the same."""
    return socket.type if socket.type in ("RGBA", "VECTOR", "SHADER") else "VALUE"


def _zero(own):
    return (0.0, 0.0, 0.0, 1.0)[:len(own)] if hasattr(own, "__len__") else 0.0


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
