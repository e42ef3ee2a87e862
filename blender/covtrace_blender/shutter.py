"""The time for which the shutter is open, and what is sharp all the while."""

# Shares of the time by which the shutter opens before the frame.
EARLIER = {"START": 0.0, "CENTER": 0.5, "END": 1.0}


def shutter_times(scene):
    """(opening, closing) in frames from the current one."""
    render = scene.render
    # Cycles had it to itself before Blender 4.2.
    position = getattr(render, "motion_blur_position", None) or getattr(getattr(scene, "cycles", None), "motion_blur_position", "CENTER")
    opening = -EARLIER[position] * render.motion_blur_shutter
    return opening, opening + render.motion_blur_shutter


def is_blurred(instance):
    """Whether an instance shows its motion; else it stands where it is in the middle of that time."""
    things = (instance.object, instance.parent) if instance.is_instance else (instance.object,)
    return all(moves_blurred(thing) for thing in things if thing)


def moves_blurred(obj):
    """Whether an object shows its motion, by its own setting."""
    return _of_cycles(obj, "use_motion_blur")


def has_blurred_shape(obj):
    """Whether an object shows its changes of shape as they move."""
    return moves_blurred(obj) and _of_cycles(obj, "use_deform_motion")


def _of_cycles(obj, name):
    return getattr(getattr(obj, "cycles", None), name, True)
