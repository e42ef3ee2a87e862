"""How much of a tree of shaders stops light: Transparents and alphas let the rest pass."""

import numpy as np

from .export_shaders import ShaderWriter
from .shader_nodes.unsupported import Unsupported
from .values import Value
from .working_space import luminance


def _blended(share, first, second):
    """first * (1 - share) + second * share of Values of one number; None where images would be multiplied."""
    if not first.varies and not second.varies and first.constant == second.constant:
        return first
    if share.varies:
        if first.varies or second.varies:
            return None
        return share.times(second.constant - first.constant, first.constant)
    if first.varies and second.varies:
        return None
    if second.varies:
        return second.times(share.constant, first.constant * (1 - share.constant))
    return first.times(1 - share.constant, second.constant * share.constant)


class OpacityReader(ShaderWriter):
    """Reads the opacity of shaders, and what weighs two of them where the rest lets light pass."""

    def _opacity_of_transparent(self, node):
        """That of a Transparent, by the brightness of its colour, which is told where it is no grey."""
        socket = node.inputs["Color"]
        value = self._value(socket, True)
        if value.varies:
            self._tell_brightness_alone(node)
            return value.inverse().clipped()
        colour = self._value(socket)
        if not colour.varies and max(colour.constant) - min(colour.constant) > 0.01:
            self._tell_brightness_alone(node)
        passing = max(value.constant, 0.0)
        return Value(1 - passing if passing < 0.9999 else 0.0)  # beyond roundings

    def _tell_brightness_alone(self, node):
        self.warn(f"material '{self.name}': of the colour of '{node.name}' the brightness alone counts")

    def _opacity(self, node):
        """The opacity of a shader's node as the Value of a number; None as a node is black."""
        if node is None:
            return Value(1.0)
        if node.type == "BSDF_TRANSPARENT":
            return self._opacity_of_transparent(node)
        if node.type == "BSDF_PRINCIPLED":
            return self._value(node.inputs["Alpha"], True)
        if node.type not in ("MIX_SHADER", "ADD_SHADER"):
            return Value(1.0)
        parts = [self._opacity(part) for part in self._parts(node)]
        if len(parts) < 2:
            return parts[0] if parts else Value(1.0)
        found = _blended(self._mix_share(node), *parts)
        return found or self._baked_share(node, "opacity", lambda nodes: self._opacity_at(nodes, node), Value(1.0))

    def _opacity_at(self, nodes, node):
        """The same at the places of an Evaluator."""
        if node is not None and node.type in ("MIX_SHADER", "ADD_SHADER"):
            parts = self._parts(node)
            if len(parts) < 2:
                return self._opacity_at(nodes, parts[0] if parts else None)
            share, first, second = self._mixed_at(nodes, node)
            return first * (1 - share) + second * share
        if node is not None and node.type == "BSDF_PRINCIPLED":
            return np.clip(nodes.number(node.inputs["Alpha"]), 0, 1)
        if node is not None and node.type == "BSDF_TRANSPARENT":
            return 1 - np.clip(nodes.number(node.inputs["Color"]), 0, 1)
        return np.float32(self._opacity(node).constant)

    def _mixed_at(self, nodes, node):
        """The share of the second part of a Mix, and both opacities."""
        return (self._share_at(nodes, node), *(self._opacity_at(nodes, part) for part in self._parts(node)))

    def _share_at(self, nodes, node):
        """The share of the second part of a Mix."""
        return np.clip(nodes.number(node.inputs[0]), 0, 1)

    def _share_of_opaque(self, node, share, first, second):
        """The share of the second part of a Mix in what stops light. share: that in all; first, second: both opacities."""
        for clear, whole in ((first, 1.0), (second, 0.0)):
            if not clear.varies and clear.constant == 0:
                return Value(whole)
        if not first.varies and not second.varies:
            if first.constant == second.constant or not share.varies and share.constant in (0, 1):
                return share
            if not share.varies:
                return Value(share.constant * second.constant / max(_blended(share, first, second).constant, 1e-6))

        return self._baked_share(node, "share of opaque", lambda nodes: self._opaque_share_at(nodes, node), share)

    def _opaque_share_at(self, nodes, node):
        """The same at the places of an Evaluator; where nothing is opaque that at which it ends, so that texels which are partly clear
        do not mix in a part that is seen nowhere."""
        share, first, second = self._mixed_at(nodes, node)
        total = first * (1 - share) + second * share
        limit = np.where(first + second > 0, second / np.maximum(first + second, np.float32(1e-6)), share)
        return np.where(total > 1e-6, share * second / np.maximum(total, np.float32(1e-6)), limit)

    def _baked_share(self, node, how, get, otherwise):
        """Value of what a function of an Evaluator gives of a shader's node; `otherwise` where nodes cannot be evaluated, which is told."""
        try:
            return self._baked_function(get, node.outputs[0], (how,))
        except Unsupported as problem:
            self._ask_for_body(problem)
            self.warn(f"material '{self.name}': node '{problem.node.name}' at '{node.name}' is not supported ({problem.reason})")
            return otherwise

    def _mix_share(self, node):
        """The share of the second part of a Mix."""
        return self._value(node.inputs[0], True).clipped()

    def _border_of(self, socket):
        """The index of refraction of a border whose reflectance a socket gets; None of others."""
        node, output = self._linked(socket)
        if node is None or node.inputs["Normal"].is_linked:
            return None
        if node.type == "FRESNEL":
            return max(self._plain(node.inputs["IOR"]), 1.0001)
        if node.type == "LAYER_WEIGHT" and output.identifier == "Fresnel":
            return max(1 / max(1 - self._plain(node.inputs["Blend"]), 1e-5), 1.0001)
        return None

    def _parts(self, node):
        """The shaders of a Mix, None being black, and those of an Add but for those that shine alone."""
        if node.type == "MIX_SHADER":
            return [self._linked(node.inputs[i])[0] for i in (1, 2)]
        nodes = [self._linked(node.inputs[i])[0] for i in (0, 1)]
        return [other for other in nodes if other and not self._is_light(other)]

    def _is_light(self, node):
        """Whether a shader is an Emission, or a sum of such alone."""
        return node.type == "EMISSION" or node.type == "ADD_SHADER" and not self._parts(node)
