"""Objects that Cycles shows to some rays only, and covtrace to all."""

RAYS = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")


class Visibility:
    """Looks at the evaluated objects of a view layer, and tells once for each kind what has no counterpart."""

    def __init__(self, view_layer):
        self.view_layer = view_layer
        self._names = {}

    def is_seen(self, obj):
        """Whether rays of any kind meet it; notes what the answer leaves out."""
        if obj.type == "LIGHT":
            return self._is_lamp_lit(obj)
        seen = [ray for ray in RAYS if getattr(obj, "visible_" + ray)]
        if not set(seen) - {"volume_scatter"}:
            return False
        for ray in set(RAYS) - set(seen) - {"camera", "shadow", "volume_scatter"}:
            self._note("seen by diffuse, glossy and transmitted rays alike", obj)
        if "shadow" not in seen:
            self._note("casting shadows although they should not", obj)
        if self._is_holdout(obj):
            self._note("rendered although they are holdouts", obj)
        if obj.is_shadow_catcher:
            self._note("rendered as surfaces although they catch shadows", obj)
        return True

    def is_hidden_from_camera(self, obj):
        return not obj.visible_camera or self._of_layer(obj, "indirect_only_get")

    def note_seen_by_camera(self, obj):
        """Notes that the camera sees an object that is_hidden_from_camera()."""
        self._note("seen by the camera although they should not be", obj)

    def _is_lamp_lit(self, obj):
        of_cycles = getattr(obj.data, "cycles", None)  # None where Cycles is not enabled
        if getattr(of_cycles, "is_portal", False):
            return False  # a help for Cycles' sampling
        rays = [ray for ray in ("diffuse", "glossy", "transmission") if not getattr(obj, "visible_" + ray)]
        if len(rays) == 3:
            return False
        if rays:
            self._note("lighting diffuse, glossy and transmitting surfaces alike", obj)
        if not getattr(of_cycles, "cast_shadow", True) or not getattr(obj.data, "use_shadow", True):
            self._note("casting shadows although they should not", obj)
        return True

    def _is_holdout(self, obj):
        return obj.is_holdout or self._of_layer(obj, "holdout_get")

    def _of_layer(self, obj, question):
        """The answer of an object's collections in this view layer."""
        try:
            return getattr(obj.original, question)(view_layer=self.view_layer)
        except RuntimeError:  # objects of instances need not be in the layer
            return False

    def _note(self, kind, obj):
        names = self._names.setdefault(kind, [])
        if obj.name not in names:
            names.append(obj.name)

    def tell(self, warn):
        for kind, names in self._names.items():
            shown = ", ".join(f"'{name}'" for name in names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
            warn(f"ray visibility has no counterpart: {shown}: {kind}")
