"""Shader node trees as pbrt-v4 materials; docs/guide/blender.md has the table."""

import io
import math
import types

import numpy as np

from . import hair_pigment
from .baked_images import BakedImages
from .baking import Baker, Surface
from .displacement import method_of
from .emission import either
from .export_shaders import squared, stretch_of_glossy, stretch_of_layers
from .export_textures import TextureFiles
from .export_volumes import medium_of
from .media import Media
from .node_signature import all_nodes, tree_of
from .owner import Owner, asked_of_owner
from .shader_nodes import sight, surroundings
from .shader_nodes.flat import flat_output
from .shader_nodes.light_path import RAYS, groups_of_rays
from .shader_nodes.unsupported import NeedsBody, Unsupported
from .sums import SumExporter
from .values import Value

TRANSPARENT = '"float alpha" 0'
WITHOUT_MATERIAL = types.SimpleNamespace(name="", name_full="", pass_index=0)  # stands for the one of a volume object that has none


class Variant:
    """A material as it is to some kinds of rays: its pbrt name, its Emission or None, the text of its alpha parameter, the
    names of the UV maps that it reads ("" is the mesh's), and the name of the medium that fills what it is on, or "". body:
    the Body whose atlas stands for the UV map, or None. is_light_alone, is_volume_alone: whether it is no surface but
    for its light, or its medium. is_holdout: whether the camera sees a hole there. tangent: the Tangent that it wants of its mesh, or
    None."""

    body, is_light_alone, is_volume_alone, is_holdout = None, False, False, False

    def __init__(self, rays, name, emission=None, alpha="", uv_maps=(), medium="", tangent=None):
        self.rays, self.name, self.emission, self.alpha, self.uv_maps = rays, name, emission, alpha, uv_maps
        self.medium, self.tangent = medium, tangent


class MaterialExporter(SumExporter):
    """Writes textures and materials into `out`, each once; `variants(m)` returns what shapes need."""

    def __init__(self, out, folder, warn):
        self.out, self.warn = out, warn
        self.files, self.media = TextureFiles(folder, warn), Media(out)
        self.baker, self.baked = Baker(self.files.source), BakedImages()
        self.known, self.of_objects, self.of_scales, self.interfaces = {}, set(), set(), set()
        self.media_of_boxes = {}  # of what is the same in the same box
        self.count, self.owner, self.is_of_volume = 0, Owner(), False

    def variants(self, material, place=None, surface_of=lambda material_name: Surface(), owner=Owner(), is_of_volume=False):
        """The Variants of a material: one, unless Light Path nodes show it to rays of different kinds as different ones. No
        ray has two of them; one that has none passes.

        place: what it is on, for what hangs on it. surface_of(name of the material): its Surface there; owner: its Owner. is_of_volume:
        whether that is a volume object, of which nothing is seen but what is within.
        """
        name = material.name_full if material else None
        self.is_of_volume = is_of_volume
        key = self._key(name, place, owner)
        if key not in self.known:
            self.owner = owner
            exported = self._on(surface_of(name), material)
            if self.hangs_on_object:
                self.of_objects.add(name)
            key = self._key(name, place, owner)
            self.known[key] = exported
        return self.known[key]

    def _key(self, name, place, owner):
        """Equal where a material is the same, by what is known to count for it."""
        return name, self.is_of_volume, place if name in self.of_objects else None, owner.scale if name in self.of_scales else None

    def _on(self, surface, material):
        """The Variants on a Surface, all of them on its body where one needs that."""
        self.surface, self.hangs_on_object = surface, False
        out, warn, told = self.out, self.warn, []
        self.out, self.warn = io.StringIO(), told.append
        try:
            exported = self._variants(material)
        except NeedsBody:
            self.surface, self.out, told[:] = surface.on_body(), io.StringIO(), ()
            exported = self._variants(material)
        finally:
            self.out, written, self.warn = out, self.out, warn
        if self.own_holdouts - {variant.name for variant in exported}:
            told.append(f"material '{self.name}': Holdout is not supported in a mixture with others; black takes its place")
        out.write(written.getvalue())
        for text in told:
            warn(text)
        for variant in exported:
            variant.body, is_alone = self.surface.body, variant.name in self.interfaces
            variant.is_holdout = variant.name in self.own_holdouts
            variant.is_light_alone, variant.is_volume_alone = is_alone and not variant.medium, is_alone and bool(variant.medium)
        return exported

    # -- shaders

    def _variants(self, material):
        self.name, self.own_holdouts = material.name if material else "none", set()
        if material is WITHOUT_MATERIAL:
            return [Variant(RAYS, self._interface(), medium=self._medium(None))]
        if not tree_of(material):
            colour = tuple(material.diffuse_color)[:3] if material else (0.8, 0.8, 0.8)
            return [Variant(RAYS, self._make("diffuse", [self._colour("reflectance", Value(colour))]))]
        nodes = list(all_nodes(material.node_tree))
        if any(node.type in sight.NODES and node.inputs["Normal"].is_linked and any(output.is_linked for output in node.outputs) for node in nodes):
            self.warn(f"material '{self.name}': what hangs on the angle of sight does so by the smooth normal, not by that of bumps or maps")
        for kind, text in surroundings.TOLD.items():
            if any(node.type == kind and any(output.is_linked for output in node.outputs) for node in nodes):
                self.warn(f"material '{self.name}': {text}")
        self.baker.owner = None
        asked = asked_of_owner(nodes)
        if asked:
            self.baker.owner, self.hangs_on_object = self.owner.only(asked), True
        if not any(node.type == "LIGHT_PATH" for node in nodes):
            return [Variant(RAYS, *self._export(material))]
        found = []
        for rays in groups_of_rays(nodes):
            self.baker.ray = rays[0]
            found.append(Variant(rays, *self._export(material)))
        self.baker.ray = None
        return self._with_shadow([v for v in found if v.alpha != TRANSPARENT])

    @staticmethod
    def _with_shadow(variants):
        """Joins what casts shadows to a variant that is as opaque: a shadow shows nothing else of a surface."""
        alone = [v for v in variants if v.rays == ("shadow",)]
        same = [v for v in variants if v not in alone and alone and v.alpha == alone[0].alpha]
        if not same:
            return variants
        same[0].rays += ("shadow",)
        return [v for v in variants if v not in alone]

    def _export(self, material):
        """(pbrt name, Emission or None, alpha parameter text, names of the UV maps, medium, Tangent or None), to rays of the baker's
        kind."""
        self.uv_maps, self.tangent = [], None
        output = flat_output(material.node_tree)
        self.heights = self._heights_of(material, output) if output else None
        node, _ = self._linked(output.inputs["Surface"]) if output else (None, None)
        volume, _ = self._linked(output.inputs["Volume"]) if output else (None, None)
        medium = self._medium(volume) if volume else ""
        if volume and (node is None or node.type == "BSDF_TRANSPARENT" or self.is_of_volume):
            # A body that is nothing but its volume.
            if node and not self.is_of_volume:
                self._tell_of_tint(node)
            return self._interface(), None, "", (), medium, None
        if node is None:
            return self._black(), None, "", (), "", None
        self.in_full = self._has_sum(node)
        shader, emission = self._whole(node) if self.in_full else self._shader(node), self._emission_of(node)
        opacity = Value(1.0) if self.in_full else self._opacity(node)
        alpha = self._number("alpha", opacity) if self._is_clear(opacity) else ""
        if shader in self.interfaces and not medium:
            if emission:
                # Interfaces have no light; rays pass this surface for its light's sake.
                shader = self._black()
                self.interfaces.add(shader)
            else:
                alpha = TRANSPARENT
        self._ask_for_body_of_uv_maps(node)
        return shader, emission, alpha, tuple(self.uv_maps), medium, self.tangent

    def _heights_of(self, material, output):
        """Finds the heights of the output's Displacement, as `heights` has them."""
        node, _ = self._linked(output.inputs["Displacement"])
        if node is None:
            return None
        if method_of(material) == "DISPLACEMENT":
            return None  # moves vertices and nothing else
        if node.type != "DISPLACEMENT" or node.inputs["Normal"].is_linked:
            self.warn(f"material '{self.name}': Displacement is not supported and left out but for the node Displacement along the normal")
            return None
        scale = self._plain(node.inputs["Scale"])
        if node.space == "OBJECT":
            self.of_scales.add(material.name_full)
            scale *= self.owner.scale
        return node.inputs["Height"], scale

    def _ask_for_body_of_uv_maps(self, node):
        """Raises NeedsBody where images lie on several UV maps, of which a mesh has one here."""
        if len(self.uv_maps) > 1:
            self.hangs_on_object = True  # by the name of the UV map that is active for rendering
            if self.surface.body_of and not self.surface.body and len({name or self.surface.active_uv_map for name in self.uv_maps}) > 1:
                raise NeedsBody(node, "several UV maps meet")

    def _tell_of_tint(self, node):
        """Warns where a Transparent colours what passes: an interface has no colour."""
        tint = self._value(node.inputs["Color"])
        if tint.varies or max(abs(c - 1) for c in tint.constant) > 0.01:
            self.warn(f"material '{self.name}': the colour of '{node.name}' around a volume is not supported and left out")

    def _medium(self, node):
        """The name of the medium that a volume shader makes; "" for what is left out."""
        def tell(text):
            self.warn(f"material '{self.name}': {text}")

        space, owner = self.surface.space_of and self.surface.space_of(), self.baker.owner
        key = self.name, self.baker.ray, owner and owner.key(), space and space.key()
        if key in self.media_of_boxes:
            self.hangs_on_object = True
            return self.media_of_boxes[key]
        try:
            found, asked = medium_of(node, space, self.files.source, self.baker.ray, owner, tell)
        except Unsupported as problem:
            tell(f"its volume is not supported and left out ({problem})")
            return ""
        name = self.media.add(found)
        if asked:
            self.hangs_on_object = True  # even where what it asked for is not known: elsewhere it may be
            if "WORLD" not in asked:
                self.media_of_boxes[key] = name
        return name

    def _shader(self, node):
        known = {"BSDF_TRANSPARENT": lambda node: self._black(), "BSDF_PRINCIPLED": self._principled,
                 "BSDF_DIFFUSE": self._diffuse, "BSDF_GLOSSY": self._glossy, "BSDF_ANISOTROPIC": self._glossy, "BSDF_METALLIC": self._metallic,
                 "BSDF_HAIR_PRINCIPLED": self._hair, "BSDF_GLASS": self._glass, "BSDF_REFRACTION": self._glass, "BSDF_TRANSLUCENT": self._translucent,
                 "SUBSURFACE_SCATTERING": self._subsurface_scattering,
                 "BSDF_SHEEN": self._fibres, "BSDF_VELVET": self._fibres, "BSDF_TOON": self._toon, "HOLDOUT": self._holdout,
                 "EMISSION": lambda node: self._black(), "MIX_SHADER": self._mix_shader, "ADD_SHADER": self._add_shader}
        if node.type in known:
            return known[node.type](node)
        self.warn(f"material '{self.name}': shader '{node.name}' is not supported; grey takes its place")
        return self._make("diffuse", ['"rgb reflectance" [0.5 0.5 0.5]'])

    def _input_shader(self, socket):
        node, _ = self._linked(socket)
        return self._shader(node) if node else self._black()

    def _black(self):
        return self._make("diffuse", ['"rgb reflectance" [0 0 0]'])

    def _diffuse(self, node):
        return self._make("diffuse", [self._colour("reflectance", self._value(node.inputs["Color"])),
                                      *self._normal_map(node)])

    def _fibres(self, node):
        """Sheen, and Velvet as it is named before Blender 4.0: those of Principled over black."""
        if getattr(node, "distribution", "ASHIKHMIN") == "ASHIKHMIN":
            self.warn(f"material '{self.name}': the distribution of '{node.name}' is not supported; that of Principled's sheen takes its place")
        roughness = either(node.inputs, "Roughness", "Sigma")
        return self._make("diffuse", ['"rgb reflectance" [0 0 0]', self._colour("sheen", self._value(node.inputs["Color"])),
                                      self._number("sheenroughness", self._value(roughness, True), squared, "squared"), *self._normal_map(node)])

    def _toon(self, node):
        self.warn(f"material '{self.name}': shader '{node.name}' is not supported; {'Diffuse' if node.component == 'DIFFUSE' else 'Glossy'} "
                  "of its colour takes its place")
        if node.component == "DIFFUSE":
            return self._diffuse(node)
        return self._metal(self._value(node.inputs["Color"]), self._value(node.inputs["Size"], True), None, self._normal_map(node))

    def _holdout(self, node):
        name = self._black()
        self.own_holdouts.add(name)
        return name

    def _rough(self, node):
        return Value(0.0) if getattr(node, "distribution", "") == "SHARP" else self._value(node.inputs["Roughness"], True)

    def _glossy(self, node):
        return self._metal(self._value(node.inputs["Color"]), self._rough(node), None, self._scattering(node) + self._normal_map(node),
                           self._stretch_of(node))

    def _stretch_of(self, node):
        """Those of a node Glossy or Glass. Before Blender 4.0 the first has a node of its own that is anisotropic."""
        return self._stretch(node, "Anisotropy", "Rotation", stretch_of_glossy)

    def _metallic(self, node):
        get, rest = node.inputs, self._film(node.inputs) + self._scattering(node) + self._normal_map(node)
        stretch = self._stretch(node, "Anisotropy", "Rotation", stretch_of_layers)
        if node.fresnel_type == "F82":
            return self._metal(self._value(get["Base Color"]), self._rough(node), self._value(get["Edge Tint"]), rest, stretch)
        return self._make("conductor", [
            self._index("eta", self._value(get["IOR"])), self._index("k", self._value(get["Extinction"])),
            *self._roughness(self._rough(node), stretch), *rest])

    def _glass(self, node):
        return self._clear(self._value(node.inputs["Color"]), self._value(node.inputs["Roughness"], True),
                           self._plain(node.inputs["IOR"]),
                           self._film(node.inputs) + self._scattering(node) + self._normal_map(node), stretch=self._stretch_of(node))

    def _hair(self, node):
        """Principled Hair: pbrt's hair has the same model, Chiang's."""
        # Cycles turns the sign of its alpha where it sets the model up (bsdf_hair_chiang_setup)
        get = node.inputs
        is_huang = getattr(node, "model", "CHIANG") == "HUANG"
        if is_huang:
            self.warn(f"material '{self.name}': the model Huang of '{node.name}' is not supported; that of Chiang takes its place")
        along = self._value(get["Roughness"], True)
        about = along if is_huang else self._value(get["Radial Roughness"], True)
        parameters = [self._number("beta_m", along), self._number("beta_n", about),
                      f'"float alpha" {-math.degrees(self._plain(get["Offset"])):.9g}', f'"float eta" {self._plain(get["IOR"]):.9g}']
        if not is_huang and "Coat" in get:
            parameters.append(self._number("haircoat", self._value(get["Coat"], True)))
        if node.parametrization == "COLOR":
            return self._make("hair", [*parameters, self._colour("color", self._value(get["Color"]))])
        if node.parametrization == "MELANIN":
            absorption = hair_pigment.absorption_of_pigments(self._plain(get["Melanin"]), self._plain(get["Melanin Redness"]))
            tint = self._value(get["Tint"])
            if tint.varies:
                self.warn(f"material '{self.name}': an image at 'Tint' of '{node.name}' is not supported and left out")
            else:
                radial = self._plain(get["Roughness" if is_huang else "Radial Roughness"])
                absorption = absorption + hair_pigment.absorption_of_colour(np.array(tint.constant), radial)
            value = Value(tuple(absorption))
        else:
            value = self._value(get["Absorption Coefficient"])
        return self._make("hair", [*parameters, self._index("sigma_a", value)])

    def _translucent(self, node):
        return self._make("diffusetransmission", ['"rgb reflectance" [0 0 0]',
                                                  self._colour("transmittance", self._value(node.inputs["Color"]))])

    def _mix_shader(self, node):
        first, second = self._parts(node)
        whole = self._under_border(node, first, second)
        if whole:
            return whole
        amount = self._mix_share(node)
        if not amount.varies and not 0 < amount.constant < 1:
            return self._input_shader(node.inputs[2 if amount.constant >= 1 else 1])
        opacities = [self._opacity(shader) for shader in (first, second)]
        for opacity, other in zip(opacities, (2, 1)):
            if not opacity.varies and opacity.constant == 0:
                return self._input_shader(node.inputs[other])
        return self._mix(self._input_shader(node.inputs[1]), self._input_shader(node.inputs[2]),
                         self._share_of_opaque(node, amount, *opacities))

    def _under_border(self, node, first, second):
        """The body of glass that a Refraction is with a Glossy by the reflectance of a border; None of other mixtures."""
        if (first and first.type, second and second.type) != ("BSDF_REFRACTION", "BSDF_GLOSSY"):
            return None
        eta = self._border_of(node.inputs[0])
        if not eta:
            return None
        tint = self._value(second.inputs["Color"])
        if tint.varies or min(tint.constant) < 0.99:
            self.warn(f"material '{self.name}': the colour of '{second.name}' over a border is not supported and left out")
        return self._clear(self._value(first.inputs["Color"]), self._rough(first), eta, self._normal_map(first))

    def _add_shader(self, node):
        """The surface of a sum of at most one with light."""
        surfaces = self._parts(node)
        return self._shader(surfaces[0]) if surfaces else self._black()
