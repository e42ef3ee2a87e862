"""The object that a material is on, as the node Object Info knows it."""

import functools

import numpy as np

from .node_signature import all_nodes, tree_of
from .shader_nodes.coordinates import IS_STRAND
from .shader_nodes.hashing import hashed

# Values of Random that are told apart: each makes a material of its own and, of instances, a mesh of its own.
LEVELS, LEVELS_OF_INSTANCES = 256, 8
RANGE = 1 << 32  # of Blender's random numbers


class Owner:
    """All that Object Info tells of an evaluated object and the material on it. random: in [0, 1]; matrix: 4x4 from the object to the
    world, None where there is none that is the only one. scale: the mean one in the world, of which Object Info tells nothing. is_strand:
    whether it is on the strands of the object, of which Curves Info tells."""

    def __init__(self, obj=None, material=None, random=0.5, matrix=None, scale=1.0, is_strand=False):
        self.scale, self._object = scale, obj
        self._values = {"Random": random, "Color": (1.0, 1.0, 1.0), "Alpha": 1.0, "Object Index": 0.0, "Material Index": 0.0,
                        IS_STRAND: float(is_strand)}
        if obj is not None:
            self._values.update({"Color": tuple(obj.color)[:3], "Alpha": obj.color[3], "Object Index": float(obj.pass_index),
                                 "Material Index": float(material.pass_index) if material else 0.0})
        if matrix is not None:
            self._values["Location"] = tuple(float(v) for v in matrix[:3, 3])

    def only(self, names):
        """The same, of which nothing but the outputs of these names is known."""
        found = Owner()
        found._values = {name: value for name, value in self._values.items() if name in names}
        for kind, name in (name for name in names if isinstance(name, tuple)):
            value = _attribute(self._object, name) if self._object else None
            if value is not None:
                found._values[kind, name] = value
        return found

    def key(self):
        """Equal for owners of which Object Info tells the same."""
        return tuple(sorted(self._values.items(), key=repr))

    def value(self, name):
        """() or (3,), of ("OBJECT", name of an attribute) (1,), (3,) or (4,); None for what is not known."""
        return None if name not in self._values else np.asarray(self._values[name], np.float32)


def _attribute(obj, name):
    """Up to four numbers of an object's property, or of its data's: one of the user's own, or of Blender's; None of what it has not."""
    for thing in (obj, obj.data):
        value = thing.get(name)
        if value is None:
            try:
                value = thing.path_resolve(name)
            except ValueError:
                continue
        try:
            value = tuple(float(v) for v in value) if hasattr(value, "__len__") else (float(value),)
        except (TypeError, ValueError):
            continue
        if len(value) in (1, 3, 4):
            return value
    return None


def asked_of_owner(nodes):
    """Names of outputs of Object Info, ("OBJECT", name) of attributes, and IS_STRAND, that nodes ask for."""
    return {output.name for node in nodes if node.type == "OBJECT_INFO" for output in node.outputs if output.is_linked} | {
        ("OBJECT", node.attribute_name) for node in nodes if node.type == "ATTRIBUTE" and node.attribute_type == "OBJECT"} | {
        IS_STRAND for node in nodes if node.type == "HAIR_INFO"}


def asks_for_random(material):
    """Whether a material's nodes ask for the random number of what it is on."""
    tree = tree_of(material)
    return tree is not None and "Random" in asked_of_owner(all_nodes(tree))


def random_of(instance):
    """The random number of an instance, or of an object by its name as Cycles has it, in the middle of its level."""
    if instance.is_instance:
        random_id, levels = instance.random_id % RANGE, LEVELS_OF_INSTANCES
    else:
        of_name = functools.reduce(lambda number, byte: (number * 37 + byte) % RANGE, instance.object.name.encode(), 0)
        random_id, levels = int(hashed(np.uint32(of_name), np.uint32(0))), LEVELS
    return (random_id * levels // RANGE + 0.5) / levels
