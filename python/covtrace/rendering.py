"""The one function that renders."""

from __future__ import annotations

import functools
import inspect
import os
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal, ParamSpec, Protocol, TypeVar

from . import _covtrace
from .arguments import (camera_of, cancel_of, environment_of, films_of, function_of, is_camera_choice, lamps_of, layers_of, path_of, refuse_unknown,
                        resolution_of, seconds_of, shutter_of)
from .builder import SceneBuilder
from .builder_calls import name_errors
from .errors import UsageError
from .image import Image
from .progress import Progress
from .scene import Scene
from .scene_warnings import warn

_UNITS = {"": 1, "k": 1 << 10, "m": 1 << 20, "g": 1 << 30, "t": 1 << 40}


def _bytes(size: int | str | None) -> int | None:
    """A number of bytes, or a text such as "500M" or "2G"."""
    if not isinstance(size, str):
        return size
    found = re.fullmatch(r"(\d+(?:\.\d+)?)([kmgt]?)(?:(?<=[kmgt])i?b)?", size.strip().lower())
    if not found:
        raise UsageError(f"texture_memory is {size!r}; expected a size such as '500M' or '2G'")
    return int(float(found[1]) * _UNITS[found[2]])


class Cancel(Protocol):
    """The interface of `cancel`, which a threading.Event has."""

    def is_set(self) -> bool: ...


_P = ParamSpec("_P")
_R = TypeVar("_R")


def _with_names_told(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """The function, which tells what is meant by an argument that it does not have."""
    known = list(inspect.signature(function).parameters)

    @functools.wraps(function)
    def told(*arguments: _P.args, **options: _P.kwargs) -> _R:
        refuse_unknown(function.__name__, options, known)
        return function(*arguments, **options)

    return told


@_with_names_told
def render(scene: str | os.PathLike[str] | Scene | SceneBuilder, *,
           preset: Literal["draft", "preview", "final"] | None = None,
           method: Literal["uniform", "covariance", "hybrid"] = "hybrid",
           spp: float | None = None, time: float | str | None = None, error: float | None = None,
           cov_spp: float | None = None, max_spp: int | None = None, max_depth: int | None = None,
           density: Literal["verified", "tempered", "thesis"] = "verified", k: float | None = None,
           occlusion: Literal["grid", "voxels", "query", "none"] = "query", voxels: int = 200,
           brdf_covariance: Literal["local", "global"] = "local",
           texture_bandwidth: Literal["own", "highest"] = "own",
           filter: Literal["verified", "predicted", "matched", "thesis"] = "verified", progressive: bool = False,
           even_counts: bool = False,
           denoiser: Literal["auto", "oidn", "none"] | None = None,
           denoiser_quality: Literal["high", "fast"] | None = None,
           denoiser_library: str | os.PathLike[str] | None = None,
           guides: Literal["auto", "none"] = "auto",
           resolution: tuple[int, int] | str | None = None,
           crop: tuple[int, int, int, int] | None = None,
           shutter: tuple[float, float] | None = None, focus: float | None = None,
           fstop: float | None = None,
           camera: Mapping[str, Any] | str | int | None = None,
           gltf_scene: str | int | None = None, animation: str | int | None = None,
           variant: str | int | None = None,
           environment: str | os.PathLike[str] | float | tuple[float, float, float] | None = None,
           environment_rotation: float | None = None, environment_scale: float | None = None,
           light: str | Iterable[str] | None = None,
           seed: int = 0, threads: int = 0,
           isa: Literal["sse2", "avx", "avx2", "avx512"] | None = None,
           texture_memory: int | str | None = None,
           search_paths: Iterable[str | os.PathLike[str]] = (),
           layers: str | Iterable[str] | None = None,
           film: str | os.PathLike[str] | None = None,
           checkpoint: str | os.PathLike[str] | None = None, every: float | str | None = None,
           resume: bool = False, shard: tuple[int, int] | None = None,
           progress: Callable[[Progress], Any] | None = None,
           preview: Callable[[Image], Any] | None = None,
           cancel: Cancel | None = None) -> Image:
    """Renders a scene into an `Image`.

    scene: path of a pbrt-v4 or glTF 2.0 file, `Scene`, or `SceneBuilder`.
    preset: "draft" (4 samples, a depth of at most 4, denoised fast), "preview" (32 samples, a depth of
        at most 8) or "final" (512 samples), where the other arguments leave these open.
    method: "uniform" (the plain path tracer), "covariance" (the method of Belcour
        2012, section 5.1) or "hybrid".
    spp, time, error: budgets: average samples per pixel (default: the scene's), seconds, estimated
        sqrt(relMSE); of several the first one stops. A time may be a text: "45s", "3m", "1h30m".
    k: with density "thesis", one more budget: k sqrt|S| samples in each pixel, whatever their mean;
        `image.statistics["k"]` tells it where another budget decided.
    denoiser, denoiser_library: whether "hybrid" has Open Image Denoise as one more filter, "auto" (the
        default) where it is found; `image.statistics["denoiser"]` tells. A warning where it is there but unusable.
    denoiser_quality: "high", or "fast": the denoiser alone, in a sixth of its time; by default "high", but
        where `time` is short "fast".
    resolution (w, h) or "640x360", crop (x0, y0, x1, y1), shutter (t0, t1), focus, fstop: in place of the scene's.
        The nodes of a glTF file are placed when it is read: give `shutter` with the file's path, or
        to `Scene`.
    camera: {"eye": (x, y, z), "target": (x, y, z), "fov": degrees of the shorter side}, a pinhole in
        place of the scene's; "up" where it is not what is up in the scene. The same as a text, as
        `Scene.summary` tells it: "eye x,y,z target x,y,z fov N". Or one of a glTF file's cameras,
        by its name or its number from 0.
    gltf_scene, animation, variant: one of a glTF file's scenes, animations and variants of materials,
        by its name or its number from 0; animations also "none" and "all", else the first. They and the camera are chosen when the file is read: give
        them with its path, or to `Scene`.
    environment, environment_rotation, environment_scale: an image's path, a number or (r, g, b), in
        place of the scene's infinite lights; degrees about what is up; a factor. The last two change
        the scene's own where no environment is given.
    light: a lamp beside the scene's lights, or a list of them: "camera", or a place "x,y,z", with
        "power N", "radius N" and "colour r,g,b" after it where they are not to be the renderer's.
    threads: 0 for all cores; holds for the process while the render runs.
    layers: which layers the image has beside R, G, B and A: "all" and "none" as in the program, names
        as a text with commas or a list, such as ["raw", "featurealbedo"]; by default all that are
        made anyway. A warning for a layer that the method does not make.
    film, checkpoint, every, resume: files that keep the render's state, as in the program: `film` at
        the end, `checkpoint` also every so many seconds (default 60); with `resume` the render goes
        on from the checkpoint where there is one, to the same image as if it had never ended.
    shard: (k, n), the k-th of n shares of the image, kept in `film`; `merge` makes the image of all.
        The `Image` that comes back has no layers. With `checkpoint` and `resume` all shards go on
        from that merged film.
    progress: called with a `Progress` about ten times a second, in the calling thread.
    preview: called between rounds with the `Image` of the samples so far, in the calling thread;
        of images that come faster than it returns the latest.
    cancel: anything with `is_set()`, for example a threading.Event; the image that is there when it
        is set comes back with `complete` False.
    All other arguments are the options of `covtrace render`.

    Python's lock is released while it renders. An exception from `progress`, and Ctrl-C, end the
    render and come out of this call. Raises the classes of `covtrace.errors`.
    """
    is_choice = is_camera_choice(camera)
    choices: dict[str, Any] = {"camera": camera if is_choice else None, "gltf_scene": gltf_scene,
                               "animation": animation, "variant": variant}
    options = {"preset": preset, "method": method, "spp": spp, "time": seconds_of(time), "error": error, "cov_spp": cov_spp,
               "max_spp": max_spp, "max_depth": max_depth, "density": density, "k": k,
               "occlusion": occlusion, "voxels": voxels, "brdf_covariance": brdf_covariance,
               "texture_bandwidth": texture_bandwidth, "filter": filter,
               "progressive": progressive, "even_counts": even_counts, "denoiser": denoiser, "denoiser_quality": denoiser_quality,
               "guides": guides,
               "denoiser_library": None if denoiser_library is None
               else path_of("denoiser_library", denoiser_library),
               "resolution": resolution_of(resolution),
               "crop": crop, "shutter": shutter_of(shutter), "focus": focus, "fstop": fstop,
               "camera": camera_of(None if is_choice else camera), "environment": environment_of(environment),
               "environment_rotation": environment_rotation, "environment_scale": environment_scale,
               "light": lamps_of(light),
               "seed": seed,
               "layers": layers_of(layers), **films_of(film, checkpoint, every, resume, shard),
               "threads": threads, "isa": isa, "texture_memory": _bytes(texture_memory),
               "progress": function_of("progress", progress),
               "preview": _with_images(function_of("preview", preview)), "cancel": cancel_of(cancel)}
    if isinstance(scene, SceneBuilder):
        return _render(Scene(scene, search_paths, **choices), options)
    if not isinstance(scene, Scene):
        scene = Scene(path_of("scene", scene, "a file's path, a Scene or a SceneBuilder"),
                      search_paths, shutter, **choices)
    else:
        for name, value in choices.items():
            if value is not None:
                raise UsageError(f"{name} is {value!r}, but the choice is made when the file is read; "
                                 f"expected Scene(file, {name}={value!r})")
        if not isinstance(search_paths, (list, tuple)) or search_paths:
            raise UsageError(f"search_paths is {search_paths!r}, but the files of a scene are found when it "
                             f"is read; expected Scene(file, search_paths={search_paths!r})")
        if scene._is_placed and shutter is not None and options["shutter"] != scene._shutter:
            raise UsageError(f"shutter is {shutter!r}, but the nodes of a glTF scene are placed when "
                             f"it is read; expected Scene(file, shutter={shutter!r})")
    return _render(scene, options)


def _with_images(preview: Callable[[Image], Any] | None) -> Callable[[_covtrace.Planes], Any] | None:
    """The function for the renderer's own planes."""
    return None if preview is None else lambda planes: preview(_image_so_far(planes))


def _image_so_far(planes: _covtrace.Planes) -> Image:
    image = Image(planes, complete=False)
    image.metadata["complete"] = 0
    if "samples" in image:
        image.metadata["spp"] = float(image["samples"].mean())
    return image


def _render(scene: Scene, options: dict[str, Any]) -> Image:
    with name_errors(scene._named):
        planes, complete, statistics, texts = _covtrace.render(scene._description, options)
    for text in texts:
        warn(scene._named(text))
    return Image(planes, complete, statistics)
