"""Shadow catchers: surfaces of which nothing is seen but what other things take from their light, by several pictures."""

import numpy as np

from .shader_nodes.light_path import RAYS

# The pictures: all but the catchers, which light it; the catchers with all other things there, which the camera does not see; the catchers
# alone; and where the film is not transparent what is behind.
MATTE, CAUGHT, BARE, BEHIND = "matte", "caught", "bare", "behind"
LEAST_LIGHT = 1e-6  # of a catcher, of which a share can be told


def is_catcher(instance):
    """Whether an instance catches shadows. Lamps have the same mark where they light what does, from the start."""
    parent = instance.parent if instance.is_instance else None
    return instance.object.type != "LIGHT" and bool(instance.object.is_shadow_catcher or parent and parent.is_shadow_catcher)


def pictures(depsgraph):
    """Those that a scene needs; (None,), which is all as it is, where nothing catches shadows."""
    if not any(instance.show_self and is_catcher(instance) for instance in depsgraph.object_instances):
        return (None,)
    return (MATTE, CAUGHT, BARE) if depsgraph.scene.render.film_transparent else (MATTE, CAUGHT, BARE, BEHIND)


def hidden_in(picture, instance, hidden, is_holdout=False):
    """The kinds of rays that an instance is hidden from in a picture, which without it are `hidden`; None where it is not there. Holdouts
    hide what is behind them from the camera in all pictures."""
    if picture is None or instance.object.type == "LIGHT" and picture != BEHIND:
        return hidden
    if is_holdout and picture in (BARE, BEHIND):
        return hidden | set(RAYS) - {"camera"}
    if is_holdout and picture == CAUGHT:
        return hidden
    catches = is_catcher(instance)
    if picture == BEHIND or picture == BARE and not catches:
        return None
    return hidden | {"camera"} if catches == (picture == MATTE) else hidden


def composed(found):
    """(h, w, 4) of {picture: (h, w, 4)}, of which BEHIND alone shows the sky. As in Cycles: what is taken of the
    catchers' light, in the mean of its channels, is opacity, and black. The MATTE alone is itself, where others are missing."""
    if CAUGHT not in found or BARE not in found:
        return found[MATTE]
    matte, caught, bare = (found[picture] for picture in (MATTE, CAUGHT, BARE))
    light = bare[..., :3]
    # Other things may add to the light of a channel, as a red one beside does.
    left = np.where(light > LEAST_LIGHT, caught[..., :3] / np.maximum(light, LEAST_LIGHT), 1).mean(-1, keepdims=True)
    # Filters carry some light over the edge of a catcher, where shares of it mean nothing.
    left = 1 - bare[..., 3:] * (1 - left)
    alpha = np.clip(1 - (1 - matte[..., 3:]) * left, 0, 1)
    if BEHIND in found:
        return np.concatenate((matte[..., :3] + (1 - alpha) * found[BEHIND][..., :3], np.ones_like(alpha)), axis=-1)
    return np.concatenate((matte[..., :3], alpha), axis=-1)
