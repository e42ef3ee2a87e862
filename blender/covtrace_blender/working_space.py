"""The linear colour space of the scene's numbers, which Blender 5 lets one choose. Pictures are rendered channel by channel, and are
in it as the numbers are; what is told in Rec.709 is brought to it."""

import numpy as np
from mathutils import Color

ROUNDING = 1e-4  # of the matrix of Rec.709 to itself
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)  # of linear Rec.709


def from_rec709(colours):
    """(..., 3) linear Rec.709 in the space of the scene."""
    matrix = np.array([Color(unit).from_rec709_linear_to_scene_linear() for unit in np.eye(3)], np.float32)
    return colours if np.abs(matrix - np.eye(3)).max() < ROUNDING else np.maximum(colours @ matrix, 0)


def luminance(colours):
    """Luminance of (..., 3) in the space of the scene."""
    weights = np.array([Color(unit).from_scene_linear_to_rec709_linear() for unit in np.eye(3)], np.float32) @ LUMINANCE
    return colours @ (LUMINANCE if np.abs(weights - LUMINANCE).max() < ROUNDING else weights)
