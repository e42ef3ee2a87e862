"""Objects that tell what is meant by attributes that they do not have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn


class Hinting:
    """`_other_names` has what to write in place of names that other libraries have, by name."""

    _other_names: Mapping[str, str] = {}

    def __getattr__(self, name: str) -> NoReturn:  # after all that is there
        meant = self._meant_by(name)
        raise AttributeError(f"{type(self).__name__} has no attribute {name!r}{meant and '; '}{meant}")

    def _meant_by(self, name: str) -> str:
        """The attribute or call that does the work of one that there is not; empty where none is known."""
        return self._other_names.get(name, "")


class Closed(Hinting):
    """Refuses to set attributes that its class neither has nor annotates: they would be lost without a word.
    `_items` names an item in the message, for classes whose values are items."""

    _items: str | None = None
    _set_by: Mapping[str, str] = {}  # what to write in place of setting attributes that can only be read, by name

    def __setattr__(self, name: str, value: Any) -> None:
        if isinstance(found := getattr(type(self), name, None), property) and found.fset is None:
            meant = self._set_by.get(name, "")
            raise AttributeError(f"{name} of {type(self).__name__} cannot be set{meant and '; '}{meant}")
        is_annotated = any(name in getattr(kind, "__annotations__", {}) for kind in type(self).__mro__)
        if not name.startswith("_") and not hasattr(type(self), name) and not is_annotated:
            meant = self._meant_by(name)
            raise AttributeError(f"{type(self).__name__} has no attribute {name!r} to set{meant and '; '}{meant}")
        super().__setattr__(name, value)

    def _meant_by(self, name: str) -> str:
        if self._items and not name.startswith("_"):
            return self._other_names.get(name, f"its values are items, such as [{self._items!r}]")
        return super()._meant_by(name)
