"""The node Light Path: what the shaders of a surface or a world are to each kind of ray."""

from .unsupported import Unsupported

# Kinds of rays, by the names that covtrace has for them.
RAYS = ("camera", "diffuse", "glossy", "transmission", "volume", "shadow")

# The rays that an output is 1 for. Cycles takes what passes glass for glossy, too.
_RAYS_OF = {"Is Camera Ray": ("camera",), "Is Shadow Ray": ("shadow",), "Is Diffuse Ray": ("diffuse",),
            "Is Glossy Ray": ("glossy", "transmission"), "Is Reflection Ray": ("diffuse", "glossy"),
            "Is Transmission Ray": ("transmission",), "Is Volume Scatter Ray": ("volume",)}


def _light_path(node, output, inputs):
    if output.name not in _RAYS_OF or inputs.place.ray is None:
        raise Unsupported(node, f"'{output.name}' has no counterpart")
    return float(inputs.place.ray in _RAYS_OF[output.name])


NODES = {"LIGHT_PATH": _light_path}


def value_for(output, ray):
    """The value of an output for rays of a kind; None where that is not known."""
    return float(ray in _RAYS_OF[output.name]) if output.name in _RAYS_OF else None


def groups_of_rays(nodes, rays=RAYS):
    """Kinds of rays, in groups of those to which all Light Path nodes among `nodes` are the same."""
    used = {output.name for node in nodes if node.type == "LIGHT_PATH" for output in node.outputs if output.is_linked}
    groups = {}
    for ray in rays:
        groups.setdefault(tuple(sorted(name for name in used if ray in _RAYS_OF.get(name, ()))), []).append(ray)
    return [tuple(group) for group in groups.values()]
