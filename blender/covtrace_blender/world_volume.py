"""The volume of a world, which fills all space."""

import numpy as np

from .coefficients import Coefficients
from .export_shaders import numbers
from .export_volumes import medium_of
from .node_signature import tree_of
from .shader_nodes.flat import flat_output
from .shader_nodes.unsupported import Unsupported
from .solid import Box

NOTHING = Coefficients()
# Mean free paths of the channel that is clearest, from the scene to where the medium ends: what is beyond adds at most exp(-8), 3e-4, of
# what comes from a ray without end. The program itself would end such a ray at two radii of the scene.
DEPTH = 8


def world_volume(world, pixels_of, warn):
    """The Coefficients of a world, or None. pixels_of: as places of nodes have it; warn(text): what is left out."""
    output = flat_output(tree_of(world)) if tree_of(world) else None
    node = next((link.from_node for link in output.inputs["Volume"].links), None) if output else None
    if node is None:
        return None

    def tell(text):
        warn(f"the world: {text}")

    try:
        found, _ = medium_of(node, None, pixels_of, None, None, tell)
    except Unsupported as problem:
        tell(f"its volume is not supported and left out ({problem})")
        return None
    extinction = found.scattering + found.absorption
    if (found.light[extinction == 0] > 0).any():
        tell("its volume shines without end, as nothing in it absorbs or scatters; its light is left out")
        found = Coefficients(found.scattering, found.absorption, found.g, np.where(extinction > 0, found.light, 0))
    return found if extinction.any() else None


def reach_of_distant_light(found):
    """(3,) how much of the light of skies and suns comes through world_volume(): all or nothing of each channel, as in Cycles."""
    return tuple(float(e == 0) for e in (found or NOTHING).scattering + (found or NOTHING).absorption)


def border(found, name, places):
    """pbrt's shape around the medium of this name, all of world_volume() that is written. places: (n, 3) of the world, corners of all that is
    seen."""
    extinction = found.scattering + found.absorption
    reach = DEPTH / extinction[extinction > 0].min()
    box = Box(places.min(0) - reach, places.max(0) + reach)
    return (f'AttributeBegin\nMaterial "interface"\nMediumInterface "{name}" ""\n'
            f'Shape "trianglemesh" "point3 P" [{numbers(box.corners().ravel())}] "integer indices" [{" ".join(map(str, Box.TRIANGLES.ravel()))}]\n'
            'AttributeEnd\n')
