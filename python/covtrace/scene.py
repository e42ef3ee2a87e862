"""Scenes from files and strings."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterable, Mapping
from typing import NoReturn

import numpy
from numpy.typing import NDArray

from . import _covtrace
from .arguments import choice_of, path_of, paths_of, shutter_of, text_of
from .builder import SceneBuilder
from .builder_calls import name_errors
from .closed import Closed
from .scene_parts import AreaLight, Camera, Instance, Light, Material, Parts, Shape
from .scene_warnings import warn


def _read(file: str, search_paths: Iterable[str | os.PathLike[str]],
          shutter: tuple[float, float] | None,
          choices: Mapping[str, str | int | None]) -> _covtrace.SceneDescription:
    chosen = [choice_of(name, choices[name]) for name in ("camera", "gltf_scene", "animation", "variant")]
    return _covtrace.SceneDescription.read(file, paths_of("search_paths", search_paths), shutter, *chosen)


class _OwnFolder:
    """A folder that lasts as long as the scenes that read from it."""

    def __init__(self) -> None:
        self.path = tempfile.mkdtemp(prefix="covtrace-")
        weakref.finalize(self, shutil.rmtree, self.path, True)


_LIGHT = "render(scene, light=...) adds lamps, environment=... lights it from all around"
_ADD = "a SceneBuilder makes scenes; what a file has can be changed"
_CHOSEN = "Scene(file, gltf_scene=..., animation=..., variant=...) chooses of a glTF file's, and summary() tells of the scene"
_VIEW = "scene.camera.look_at(eye, target) places the camera, and render(scene, camera='eye x,y,z target x,y,z fov N') is another"


class Scene(Closed):
    """A scene in the pbrt-v4 or glTF 2.0 format, read and checked, not yet built.

    `Scene(file)` reads a file and the meshes that it names, or what a `SceneBuilder` has collected
    so far; `Scene.from_string` a text (pbrt-v4).
    `warnings` tells what the scene asks for and covtrace replaces or ignores, and what stands in for
    a camera or lights that it has not; each is warned of, too, the latter where it is rendered.

    Camera, materials, lights and places of shapes can be changed, and the scene rendered again
    without reading its files: `scene.materials["floor"]["reflectance"] = (0.2, 0.3, 0.1)`.
    """

    _other_names = {**dict.fromkeys(("add_light", "add_lamp", "environment", "background", "world", "envmap"), _LIGHT),
                    **dict.fromkeys(("add", "add_shape", "add_mesh", "add_material", "add_object"), _ADD),
                    **dict.fromkeys(("objects", "meshes", "nodes"), "there are shapes, instances and materials"),
                    **dict.fromkeys(("width", "height", "size"), "resolution is (width, height)"),
                    **dict.fromkeys(("bounds", "bbox", "bounding_box"), "extent has two corners of the box around all shapes"),
                    **dict.fromkeys(("film", "sensor"), "resolution and spp are the film's; render(scene, resolution=..., spp=...) takes others"),
                    **dict.fromkeys(("animations", "variants", "scenes"), _CHOSEN),
                    **dict.fromkeys(("frames", "duration", "time"), "Scene(file, shutter=(begin, end)) is a glTF file at another time"),
                    **dict.fromkeys(("look_at", "set_camera", "view", "fov"), _VIEW),
                    **dict.fromkeys(("info", "describe", "triangles", "stats"), "summary() tells of the scene"),
                    **dict.fromkeys(("save", "write", "export"), "scenes are not written; render(scene).write('image.exr') writes its image"),
                    "cameras": "Scene(file, camera=...) chooses one of a glTF file's, by its name or number",
                    "render": "covtrace.render(scene) renders it"}

    _set_by = {"resolution": "render(scene, resolution=(width, height)) takes another", "spp": "render(scene, spp=...) takes another number",
               "camera": _VIEW, "lights": _LIGHT,
               **dict.fromkeys(("materials", "shapes", "instances", "area_lights"), "its items can be changed")}

    _named: Callable[[str], str]  # puts names into messages, for scenes of a SceneBuilder
    _files: _OwnFolder | None = None  # where a SceneBuilder's textures are, which each render reads

    def __init__(self, file: str | os.PathLike[str] | SceneBuilder,
                 search_paths: Iterable[str | os.PathLike[str]] = (),
                 shutter: tuple[float, float] | None = None, *, camera: str | int | None = None,
                 gltf_scene: str | int | None = None, animation: str | int | None = None,
                 variant: str | int | None = None) -> None:
        """Reads a file, or a `SceneBuilder` as it is now. shutter: when it opens and closes, in place of the file's; seconds of glTF's
        animations, whose nodes rest at 0 without it. camera, gltf_scene, animation, variant: one
        of a glTF file's by its name or its number from 0; animations also "none" and "all", else the
        first."""
        self._named = str
        if isinstance(file, SceneBuilder):
            self._files = _OwnFolder()
            file, calls = file.written(self._files.path)
            self._named = calls.named
        file = path_of("file", file, "a file's path or a SceneBuilder")
        self._is_placed = _covtrace.is_gltf(file)
        self._shutter = shutter_of(shutter)
        with name_errors(self._named):
            self._take(_read(file, search_paths, self._shutter,
                             {"camera": camera, "gltf_scene": gltf_scene, "animation": animation,
                              "variant": variant}))

    @classmethod
    def from_string(cls, text: str, folder: str | os.PathLike[str] = ".", name: str = "scene",
                    search_paths: Iterable[str | os.PathLike[str]] = ()) -> Scene:
        """Reads a text. Relative file names in it refer to `folder`; messages call it `name`."""
        scene = cls.__new__(cls)
        scene._is_placed, scene._shutter, scene._named = False, None, str
        scene._take(_covtrace.SceneDescription.read_string(
            text_of("text", text), text_of("name", name), path_of("folder", folder, "a folder's path", True),
            paths_of("search_paths", search_paths)))
        return scene

    def _take(self, description: _covtrace.SceneDescription) -> None:
        self._description = description
        # Stand-ins for a camera or lights are warned of when they are used: options may replace them.
        for text in description.told:
            warn(self._named(text))

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

    def copy(self) -> Scene:
        """A scene that can be changed apart from this one; meshes are shared."""
        scene = Scene.__new__(Scene)
        scene._is_placed, scene._shutter, scene._named = self._is_placed, self._shutter, self._named
        scene._files, scene._description = self._files, self._description.copy()
        return scene

    def __copy__(self) -> Scene:
        return self.copy()

    def __deepcopy__(self, memo: object) -> Scene:
        return self.copy()

    def __reduce__(self) -> NoReturn:
        raise TypeError("a Scene cannot be pickled; another process gets the file's path, or a SceneBuilder")

    @property
    def camera(self) -> Camera:
        return Camera(self._description)

    @property
    def materials(self) -> Parts:
        """All materials, by index or name: `scene.materials["floor"]["roughness"] = 0.2`."""
        return Parts("material", lambda *indices: Material(self._description, *indices),
                     [name for name, _ in self._description.parts()["materials"]], joins=True)

    @property
    def lights(self) -> Parts:
        """Lights that are no shapes."""
        return Parts("light", lambda i: Light(self._description, i), len(self._description.parts()["lights"]))

    def remove_light(self, index: int) -> None:
        """Removes one of `lights`; those behind it move up."""
        lights = self.lights
        lights[index]  # raises IndexError where there is none
        self._description.remove_light(range(len(lights))[index])

    @property
    def area_lights(self) -> Parts:
        return Parts("area light", lambda i: AreaLight(self._description, i), self._description.parts()["area_lights"])

    @property
    def shapes(self) -> Parts:
        """The shapes outside of objects."""
        return Parts("shape", lambda i: Shape(self._description, i), len(self._description.parts()["shapes"]))

    @property
    def instances(self) -> Parts:
        return Parts("instance", lambda i: Instance(self._description, i), self._description.parts()["instances"])

    @property
    def extent(self) -> NDArray[numpy.float64] | None:
        """Two opposite corners of the box around all shapes and instances as they stand when the shutter
        opens, [lowest, highest], in world space; None where there are none."""
        found = self._description.extent()
        return None if found is None else numpy.array(found)

    def summary(self) -> str:
        """Several lines for people, as `covtrace info`."""
        return self._description.summary()

    def __repr__(self) -> str:
        width, height = self.resolution
        return f"<covtrace.Scene {self.name!r}, {width}x{height}>"
