"""The world's light: a colour, an image around the scene, or what Cycles makes of its nodes."""

import os

import numpy as np
from mathutils import Euler, Matrix

from . import world_baking
from .baking import Surface
from .export_shaders import numbers
from .export_textures import pixels, write_pfm
from .node_signature import all_nodes, tree_of
from .shader_nodes.blackbody import blackbody, blackbody_temperature
from .shader_nodes.evaluator import Evaluator
from .shader_nodes.flat import flat_socket
from .shader_nodes.light_path import RAYS, groups_of_rays
from .shader_nodes.place import UvPlace
from .shader_nodes.unsupported import Unsupported
from .visibility import hidden_from

LEAST_ROWS = 256  # of images that are brought to twice their height


def write_world(out, world, folder, warn, tell, time, is_preview=False, reach=(1, 1, 1), is_seen=True):
    """Writes the light of the world; a black one, too, as covtrace lights scenes that have no light at all.

    warn(text): what is left out; tell(text): what is done; time: in frames; is_preview: bakes are coarse; reach: how much of each channel
    comes to the scene; is_seen: whether the camera sees it.
    """
    found = set()  # kinds of rays that find light
    for rays in _groups(world, is_seen) if any(reach) else []:
        light = _light(world, warn, tell, time, is_preview, rays[0])
        if isinstance(light, tuple):
            light = _visible(tuple(c * r for c, r in zip(light, reach)))
        elif light is not None:
            light.values = light.values * np.array(reach, np.float32)
        if light is not None:
            hidden = hidden_from(() if len(rays) == len(_SKY_RAYS) else set(RAYS) - set(rays))
            _write_light(out, light, os.path.join(folder, f"world {rays[0]}.pfm"), hidden)
            found.update(rays)
    if not found:
        _write_light(out, (0, 0, 0), "", hidden_from(() if is_seen else ("camera",)))
    elif is_seen and "camera" not in found:
        _write_light(out, (0, 0, 0), "", hidden_from(set(RAYS) - {"camera"}))  # black, which is not clear


# Kinds of rays that find a sky.
_SKY_RAYS = tuple(ray for ray in RAYS if ray != "shadow")


def _groups(world, is_seen):
    """The kinds of rays that see the world, in groups that see the same; is_seen: whether the camera may."""
    if world is None:
        return []
    seen = getattr(world, "cycles_visibility", None)  # None where Cycles is not enabled
    rays = [ray for ray in _SKY_RAYS if getattr(seen, "scatter" if ray == "volume" else ray, True) and (is_seen or ray != "camera")]
    nodes = list(all_nodes(tree_of(world))) if tree_of(world) else []
    return groups_of_rays(nodes, rays)


def _write_light(out, light, file, hidden):
    """file: a path for the image of the light, in the scene's folder."""
    if isinstance(light, tuple):
        out.write(f'LightSource "infinite" "rgb L" [{numbers(light)}]{hidden}\n')
        return
    values, turn = light.values, light.turn.inverted()
    width = values.shape[1]
    # Blender's azimuth runs the other way, from the middle of the image.
    columns = (width // 2 - 1 - np.arange(width)) % width
    write_pfm(file, values[:, columns])
    out.write(f'AttributeBegin\nConcatTransform [{numbers(turn[row][column] for column in range(4) for row in range(4))}]\n'
              f'LightSource "infinite" "string filename" "{os.path.basename(file)}"{hidden}\nAttributeEnd\n')


class Image:
    """(h, 2 h, 3) radiances from the top, as Blender's equirectangular images lie; `turn` takes directions to it."""

    def __init__(self, values, turn):
        self.values, self.turn = values, turn


def _light(world, warn, tell, time, is_preview, ray):
    """None, a colour, or an Image: the world as rays of a kind see it."""
    if not tree_of(world):
        return _visible(tuple(world.color))
    output = next((n for n in world.node_tree.nodes if n.type == "OUTPUT_WORLD" and n.is_active_output), None)
    if output is None or not output.inputs["Surface"].is_linked:
        return None
    background = _seen_shader(output.inputs["Surface"], ray)
    if background is None:
        return None
    plain = _plain_light(background, warn, ray)
    if plain is not None:
        return _visible(plain) if isinstance(plain, tuple) else plain
    return _baked(world, background, warn, tell, time, is_preview, ray)


def _seen_shader(socket, ray):
    """The shader that is linked to a socket, behind mixtures of which rays of a kind see one part alone; None for no
    shader."""
    node = socket.links[0].from_node if socket.is_linked else None
    while node is not None and node.type in ("MIX_SHADER", "REROUTE") and not node.mute:
        share = 0.0 if node.type == "REROUTE" else _constant(node.inputs[0], ray)
        if share is None or 0 < share < 1:
            break
        chosen = node.inputs[0 if node.type == "REROUTE" else 2 if share >= 1 else 1]
        node = chosen.links[0].from_node if chosen.is_linked else None
    return node


def _constant(socket, ray):
    """The number that a socket gets everywhere for rays of a kind; None for others."""
    def pixels_of(image):
        raise Unsupported(socket.node, f"the image '{image.name}' is not the same everywhere")
    place = UvPlace(np.zeros((1, 2), np.float32), pixels_of, ray)
    try:
        value = np.asarray(Evaluator(place).number(flat_socket(socket)))
    except Unsupported:
        return None
    return None if place.uv_maps or place.hangs_on_angle else float(value.ravel()[0])


def _visible(colour):
    return colour if max(colour) > 0 else None


def _plain_light(background, warn, ray):
    """The colour or Image of a Background node of either; None for all else."""
    if background.type != "BACKGROUND" or background.mute:
        return None
    strength, socket = _constant(background.inputs["Strength"], ray), background.inputs["Color"]
    if strength is None:
        return None
    if not socket.is_linked:
        return tuple(c * strength for c in tuple(socket.default_value)[:3])
    temperature = blackbody_temperature(socket)
    if temperature is not None:
        return tuple(c * strength for c in blackbody(temperature))
    node = socket.links[0].from_node
    if node.type == "TEX_ENVIRONMENT" and not node.mute and node.image and node.projection == "EQUIRECTANGULAR":
        turn = _turn(node)
        if turn is not None:
            return Image(_twice_as_wide(pixels(node.image, warn)[..., :3] * strength), turn)
    return None


def _turn(node):
    """The matrix that takes directions to the image's coordinates: the rotation of a Mapping node; None for what does
    more."""
    if not node.inputs["Vector"].is_linked:
        return Matrix()
    source = node.inputs["Vector"].links[0].from_node
    if source.type == "TEX_COORD" and node.inputs["Vector"].links[0].from_socket.name == "Generated":
        return Matrix()
    if source.type != "MAPPING" or source.mute:
        return None
    vector = source.inputs["Vector"]
    is_plain = vector.is_linked and vector.links[0].from_node.type == "TEX_COORD" and \
        vector.links[0].from_socket.name == "Generated"
    names = [name for name in ("Location", "Rotation", "Scale") if name in source.inputs]
    values = {name: tuple(source.inputs[name].default_value) for name in names}
    if is_plain and not any(source.inputs[name].is_linked for name in names) and \
            max(map(abs, values.get("Location", (0, 0, 0)))) < 1e-6 and \
            max(abs(s - 1) for s in values["Scale"]) < 1e-6:
        turn = Euler(values["Rotation"]).to_matrix().to_4x4()
        return turn.inverted() if source.vector_type == "TEXTURE" else turn
    return None


def _twice_as_wide(values):
    """(h, w, 3) stretched to twice as wide as high, which the reader of environment maps wants."""
    height, width, _ = values.shape
    if width == 2 * height:
        return values
    rows = max(height, -(-width // 2), LEAST_ROWS)
    v = np.clip((np.arange(rows) + 0.5) / rows * height - 0.5, 0, height - 1)
    u = (np.arange(2 * rows) + 0.5) / (2 * rows) * width - 0.5
    top = np.floor(v).astype(int)
    low, share = np.minimum(top + 1, height - 1), (v - top)[:, None, None]
    stretched = values[top] * (1 - share) + values[low] * share
    left = np.floor(u).astype(int)
    share = (u - left)[:, None]
    return (stretched[:, left % width] * (1 - share) + stretched[:, (left + 1) % width] * share).astype(np.float32)


def _baked(world, background, warn, tell, time, is_preview, ray):
    try:
        values = world_baking.bake(world, time, is_preview, tell, warn, ray)
    except world_baking.Failed as problem:
        warn(f"the world's '{background.name}' is not supported, and Cycles has not baked it ({problem}); "
             "its own colour is used" if background.type == "BACKGROUND" else
             f"the world's '{background.name}' is not supported, and Cycles has not baked it ({problem}); the world is black")
        if background.type != "BACKGROUND":
            return None
        strength = background.inputs["Strength"].default_value
        return _visible(tuple(c * strength for c in tuple(background.inputs["Color"].default_value)[:3]))
    return Image(values, Matrix())
