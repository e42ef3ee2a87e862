"""Warnings at the line of the program that uses the package, in whatever thread they arise."""

from __future__ import annotations

import os
import sys
import threading
import warnings
from typing import Any, NamedTuple

from .errors import SceneWarning

_FOLDER = os.path.dirname(os.path.abspath(__file__)) + os.sep
_of_thread = threading.local()


class Place(NamedTuple):
    file: str
    line: int
    module: str | None
    registry: dict[Any, Any]  # by which Python knows what it has told there


def place_of_caller() -> Place:
    """The nearest line on the stack that is not the package's."""
    frame = sys._getframe(1)
    while frame.f_back is not None and os.path.abspath(frame.f_code.co_filename).startswith(_FOLDER):
        frame = frame.f_back
    return Place(frame.f_code.co_filename, frame.f_lineno, frame.f_globals.get("__name__"),
                 frame.f_globals.setdefault("__warningregistry__", {}))


def place_of_thread(place: Place) -> None:
    """From now on the calling thread's warnings are of `place`, as the package has begun the thread."""
    _of_thread.place = place


def warn(text: str) -> None:
    place = getattr(_of_thread, "place", None) or place_of_caller()
    warnings.warn_explicit(text, SceneWarning, place.file, place.line, place.module, place.registry)
