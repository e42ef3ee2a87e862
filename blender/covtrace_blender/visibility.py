"""Which rays see an object, and what of that covtrace does not have."""

from .holdouts import is_holdout, of_layer
from .shader_nodes.light_path import RAYS
from .shadow_catchers import hidden_in, is_catcher

_PROPERTIES = {ray: "visible_volume_scatter" if ray == "volume" else f"visible_{ray}" for ray in RAYS}

MOST_BOUNCES = 1024  # of a lamp; Blender's own, which is no limit


def hidden_from(rays):
    """The parameter of a shape or a sky that is hidden from some kinds of rays; with a space before it."""
    names = " ".join(f'"{ray}"' for ray in RAYS if ray in rays)
    return f' "string hiddenfrom" [{names}]' if names else ""


class Visibility:
    """Looks at the evaluated objects of a view layer, which a Clipping hides from the camera, and tells once for each kind what has no
    counterpart. picture: one of shadow_catchers, or None; is_scattered_through: whether something in the layer scatters light that passes it."""

    def __init__(self, view_layer, clipping, picture=None, is_scattered_through=False):
        self.view_layer, self._clipping, self._picture, self._is_scattered_through = view_layer, clipping, picture, is_scattered_through
        self._names = {}

    def hidden(self, instance):
        """The kinds of rays that an instance of the layer is hidden from; None where none sees it. Notes what the answer
        leaves out."""
        obj = instance.object
        hidden = self._hidden_of(instance)
        if "camera" not in hidden and self._clipping.hides(instance):
            hidden.add("camera")
        hidden = hidden_in(self._picture, instance, hidden, self.is_holdout(instance))
        if hidden is None or not set(RAYS) - hidden:
            return None
        self._note_linking(obj)
        if obj.type == "LIGHT":
            return self._lamp_hidden(obj, hidden) if self._is_lamp_lit(obj, hidden) else None
        if self._picture is None and is_catcher(instance):
            self._note("rendered as surfaces although they catch shadows", obj)
        return hidden

    def is_holdout(self, instance):
        return instance.object.type not in ("LIGHT", "VOLUME") and is_holdout(instance, self.view_layer)

    def note_volume(self, instance, variants):
        """Notes an instance that is hidden from some kinds of rays where these Variants are its volume alone: media end there for all rays."""
        if any(variant.is_volume_alone for variant in variants) and self._hidden_of(instance):
            self._note("volumes that all rays see alike", instance.object)

    def _hidden_of(self, instance):
        return self._hidden(instance.object) | (self._hidden(instance.parent) if instance.is_instance and instance.parent else set())

    def _hidden(self, obj):
        hidden = {ray for ray in RAYS if not getattr(obj, _PROPERTIES[ray])}
        return hidden | ({"camera"} if of_layer(obj, "indirect_only_get", self.view_layer) else set())

    def _is_lamp_lit(self, obj, hidden):
        of_cycles = getattr(obj.data, "cycles", None)  # None where Cycles is not enabled
        if getattr(of_cycles, "is_portal", False):
            return False  # a help for Cycles' sampling
        dark = hidden & {"diffuse", "glossy", "transmission"}
        if len(dark) == 3:
            return False
        if dark and not has_extent(obj.data):
            self._note("lighting diffuse, glossy and transmitting surfaces alike", obj)
        if not getattr(of_cycles, "cast_shadow", True) or not getattr(obj.data, "use_shadow", True):
            self._note("casting shadows although they should not", obj)
        if getattr(of_cycles, "max_bounces", MOST_BOUNCES) < MOST_BOUNCES:
            self._note("lighting by more bounces than their own limit", obj)
        return True

    def _lamp_hidden(self, obj, hidden):
        """No ray finds a lamp without Multiple Importance, which files of before Blender 2.8 have off: it is not seen in mirrors and
        through glass, and is sampled by all that is rough. What is hidden from a kind of rays gives no light to what scatters by them:
        hidden from glossy ones it would have no highlights, so it stays in mirrors, and from transmission leaves before it would be
        black, so it stays behind glass where there are such."""
        if getattr(getattr(obj.data, "cycles", None), "use_multiple_importance_sampling", True) or not has_extent(obj.data):
            return hidden
        return hidden | ({"camera"} if self._is_scattered_through else {"camera", "transmission"})

    def _note_linking(self, obj):
        linking = getattr(obj, "light_linking", None)  # from Blender 4.0 on
        if linking and linking.receiver_collection:
            self._note("lighting all objects and not those alone that they are linked to", obj)
        if linking and linking.blocker_collection:
            self._note("shadowed by all objects and not by those alone that they are linked to", obj)

    def _note(self, kind, obj):
        names = self._names.setdefault(kind, [])
        if obj.name not in names:
            names.append(obj.name)

    def tell(self, warn):
        self._clipping.tell(warn)
        for kind, names in self._names.items():
            shown = ", ".join(f"'{name}'" for name in names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
            warn(f"ray visibility has no counterpart: {shown}: {kind}")


def has_extent(lamp):
    """Whether rays can find a lamp."""
    if lamp.type == "SUN":
        return lamp.angle > 0
    return lamp.type == "AREA" or lamp.shadow_soft_size > 0
