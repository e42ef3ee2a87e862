"""Scenes from files and strings."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable

from . import _covtrace
from .arguments import path_of, paths_of, shutter_of, text_of
from .builder_calls import BuilderCalls
from .errors import SceneWarning


class Scene:
    """A scene in the pbrt-v4 or glTF 2.0 format, read and checked, not yet built.

    `Scene(file)` reads a file and the meshes that it names; `Scene.from_string` a text (pbrt-v4).
    `warnings` tells what the scene asks for and covtrace replaces or ignores, and what stands in for
    a camera or lights that it has not; each is warned of, too, the latter where it is rendered.
    """

    _named: Callable[[str], str]  # puts names into messages, for scenes of a SceneBuilder

    def __init__(self, file: str | os.PathLike[str],
                 search_paths: Iterable[str | os.PathLike[str]] = (),
                 shutter: tuple[float, float] | None = None) -> None:
        """Reads a file. shutter: when it opens and closes, in place of the file's; seconds of glTF's
        animations, whose nodes rest at 0 without it."""
        file = path_of("file", file)
        self._named = str
        self._is_placed = _covtrace.is_gltf(file)
        self._shutter = shutter_of(shutter)
        self._take(_covtrace.SceneDescription.read(file, paths_of("search_paths", search_paths),
                                                   self._shutter))

    @classmethod
    def _of_builder(cls, file: str, search_paths: Iterable[str | os.PathLike[str]],
                    calls: BuilderCalls) -> Scene:
        """The scene that a SceneBuilder wrote; its warnings name the builder's calls."""
        scene = cls.__new__(cls)
        scene._is_placed, scene._shutter, scene._named = False, None, calls.named
        scene._take(_covtrace.SceneDescription.read(file, paths_of("search_paths", search_paths), None),
                    stacklevel=4)
        return scene

    @classmethod
    def from_string(cls, text: str, folder: str | os.PathLike[str] = ".", name: str = "scene",
                    search_paths: Iterable[str | os.PathLike[str]] = ()) -> Scene:
        """Reads a text. Relative file names in it refer to `folder`; messages call it `name`."""
        scene = cls.__new__(cls)
        scene._is_placed, scene._shutter, scene._named = False, None, str
        scene._take(_covtrace.SceneDescription.read_string(
            text_of("text", text), text_of("name", name), path_of("folder", folder, "a folder's path"),
            paths_of("search_paths", search_paths)))
        return scene

    def _take(self, description: _covtrace.SceneDescription, stacklevel: int = 3) -> None:
        self._description = description
        # Stand-ins for a camera or lights are warned of when they are used: options may replace them.
        for text in description.told:
            warnings.warn(self._named(text), SceneWarning, stacklevel=stacklevel)

    @property
    def name(self) -> str:
        return self._description.name

    @property
    def resolution(self) -> tuple[int, int]:
        """(width, height)"""
        return self._description.resolution

    @property
    def spp(self) -> int:
        """Samples per pixel that the scene asks for."""
        return self._description.spp

    @property
    def warnings(self) -> list[str]:
        return [self._named(text) for text in self._description.warnings]

    def summary(self) -> str:
        """Several lines for people, as `covtrace info`."""
        return self._description.summary()

    def __repr__(self) -> str:
        width, height = self.resolution
        return f"<covtrace.Scene {self.name!r}, {width}x{height}>"
