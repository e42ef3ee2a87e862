"""Holdouts: what the camera's rays, straight on, end at as where there is nothing, so that the picture is black and clear there."""

from .node_signature import tree_of
from .shader_nodes.flat import flat_output


def holds_out(material):
    """Whether a material is a Holdout and nothing else."""
    output = flat_output(tree_of(material)) if tree_of(material) else None
    socket = output and output.inputs["Surface"]
    return bool(socket and socket.is_linked and socket.links[0].from_node.type == "HOLDOUT")


def is_holdout(instance, view_layer):
    """Whether an instance is one: by a mark of its object or collection in the view layer, or of what makes the instance, as in Cycles; or by
    all of its materials."""
    marked = instance.parent if instance.is_instance and instance.parent else instance.object
    if marked.is_holdout or of_layer(marked, "holdout_get", view_layer):
        return True
    override = view_layer.material_override
    # The slots of an evaluated instance may be gone.
    materials = [override] if override else [slot.material for slot in instance.object.original.material_slots]
    return bool(materials) and all(holds_out(material) for material in materials)


def of_layer(obj, question, view_layer):
    """The answer of an object's collections in a view layer."""
    try:
        return getattr(obj.original, question)(view_layer=view_layer)
    except RuntimeError:  # objects of instances need not be in the layer
        return False
