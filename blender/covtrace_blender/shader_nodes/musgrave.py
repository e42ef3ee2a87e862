"""The nodes Musgrave, of Blender up to 4.0, and Magic."""

import numpy as np

from .fractals import KINDS, Octaves
from .noise_nodes import points


def _musgrave(node, output, inputs):
    dimensions = int(node.musgrave_dimensions[0])
    p = points(node, inputs, dimensions) * inputs.number("Scale")[..., None]
    # All kinds but these have their first octave whole.
    least = 0 if node.musgrave_type in ("FBM", "MULTIFRACTAL") else 1
    lacunarity = np.maximum(inputs.number("Lacunarity"), 1e-5)
    octaves = Octaves(p, np.clip(inputs.number("Detail"), least, 15), lacunarity ** -np.maximum(inputs.number("Dimension"), 1e-5), lacunarity)
    return KINDS[node.musgrave_type](octaves, inputs.number("Offset"), inputs.number("Gain"))


# Steps of Magic beyond the first: which of x, y, z is set, by which function with which sign, of x, y, z with which signs.
_STEPS = ((1, np.cos, -1, (1, -1, 1)), (0, np.cos, 1, (1, -1, -1)), (2, np.sin, 1, (-1, -1, -1)), (0, np.cos, -1, (-1, 1, -1)),
          (1, np.sin, -1, (-1, 1, 1)), (1, np.cos, -1, (-1, 1, 1)), (0, np.cos, 1, (1, 1, 1)), (2, np.sin, 1, (1, 1, -1)),
          (0, np.cos, -1, (-1, -1, 1)), (1, np.sin, -1, (1, -1, 1)))


def _magic(node, output, inputs):
    x, y, z = np.moveaxis(np.atleast_2d(inputs.coordinates() * inputs.number("Scale")[..., None]) % (2 * np.pi), -1, 0)
    distortion = inputs.number("Distortion")
    waves = [np.sin(5 * (x + y + z)), np.cos(5 * (-x + y - z)), -np.cos(5 * (-x - y + z))]
    if node.turbulence_depth > 0:
        waves = [wave * distortion for wave in waves]
        for axis, function, sign, signs in _STEPS[:node.turbulence_depth]:
            waves[axis] = sign * function(sum(s * wave for s, wave in zip(signs, waves))) * distortion
    half = np.where(distortion != 0, 2 * distortion, 1)
    colour = np.stack([0.5 - wave / half for wave in waves], axis=-1)
    return colour.mean(axis=-1) if output.type == "VALUE" else colour


NODES = {"TEX_MUSGRAVE": _musgrave, "TEX_MAGIC": _magic}
