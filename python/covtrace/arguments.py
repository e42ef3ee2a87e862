"""Checks of what callers hand over, before it reaches the renderer."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, NoReturn

import numpy
from numpy.typing import ArrayLike, NDArray

from .errors import UsageError


def refuse(name: str, value: Any, expected: str) -> NoReturn:
    shown = " ".join(repr(value).split())  # of arrays repr has lines, up to thousands
    longest = 120
    if len(shown) > longest:
        shown = shown[:longest] + "…"
    raise UsageError(f"{name} is {shown}; expected {expected}")


# Names in other renderers, and in the program's options, of the arguments of `render`, or what does their work.
_SHOWN = "write the picture by image.write('picture.png', exposure=1, view='agx')"
_FRAMES = "render each frame with its own shutter=(begin, end)"
_OTHER_NAMES = {"samples": "spp", "res": "resolution", "num_samples": "spp", "spp_max": "max_spp", "size": "resolution", "width": "resolution",
                "height": "resolution", "depth": "max_depth", "bounces": "max_depth", "max_bounces": "max_depth",
                "denoise": "denoiser", "lights": "light", "lamp": "light", "world": "environment", "background": "environment",
                "hdri": "environment", "envmap": "environment", "eye": "camera", "target": "camera", "fov": "camera",
                "max_time": "time", "seconds": "time", "noise": "error", "integrator": "method", "search_path": "search_paths",
                "scene_name": "gltf_scene", "shutter_time": "shutter", "focus_distance": "focus", "f_stop": "fstop", "callback": "progress",
                **dict.fromkeys(("output", "png", "exposure", "view", "filename", "ocio_config"), _SHOWN),
                **dict.fromkeys(("frame", "frames", "fps"), _FRAMES)}


def refuse_unknown(function: str, given: Iterable[str], known: Collection[str]) -> None:
    """Raises `TypeError`, as Python does, for names of arguments that a function does not have, and says what is meant."""
    for name in given:
        if name in known:
            continue
        text = f"{function}() has no argument {name!r}"
        meant = _OTHER_NAMES.get(name.lower()) or next(iter(difflib.get_close_matches(name.lower(), known, 1)), None)
        raise TypeError(f"{text}; help(covtrace.render) tells all" if meant is None
                        else f"{text}; did you mean {meant!r}?" if meant in known else f"{text}; {meant}")


def linear_of(name: str, values: ArrayLike) -> NDArray[numpy.float32]:
    """Values in single precision. `UsageError` for integers of a picture, which are not linear and go up
    to 255 or 65535."""
    given = numpy.asarray(values)
    if given.dtype in (numpy.uint8, numpy.uint16) and given.size and given.max() > 1:
        raise UsageError(f"{name} has the type {given.dtype} and numbers up to {given.max()}; expected linear "
                         "values, as covtrace.Image.read gives them of a picture's file")
    return given.astype(numpy.float32, copy=False)


def path_of(name: str, value: str | os.PathLike[str], expected: str = "a file's path",
            may_be_empty: bool = False) -> str:
    """A path that a file system can name: neither a number nor a text with a zero in it. No file has an
    empty one, which among folders is the working one (`may_be_empty`)."""
    try:
        path = os.fspath(value)
        if b"\0" in os.fsencode(path) or not (path or may_be_empty):
            refuse(name, value, expected)
    except (TypeError, UnicodeError):
        refuse(name, value, expected)
    return path


def paths_of(name: str, values: Iterable[str | os.PathLike[str]],
             expected: str = "a list of folders") -> list[str]:
    if isinstance(values, (str, bytes)):  # whose letters would be the folders
        refuse(name, values, expected)
    try:
        return [path_of(name, v, expected, may_be_empty=True) for v in values]
    except TypeError:
        refuse(name, values, expected)


def text_of(name: str, value: str) -> str:
    try:
        if isinstance(value, str):
            value.encode()  # halves of a surrogate pair are no text
        if isinstance(value, (str, bytes)):
            return value
    except UnicodeError:
        pass
    refuse(name, value, "a text")


def shutter_of(value: tuple[float, float] | None) -> tuple[float, float] | None:
    expected = "(begin, end)"
    if value is None:
        return None
    if isinstance(value, (str, bytes)):  # "01" would be one
        refuse("shutter", value, expected)
    try:
        begin, end = value
        return float(begin), float(end)
    except (TypeError, ValueError, OverflowError):
        refuse("shutter", value, expected)


_SECONDS = {"": 1, "s": 1, "m": 60, "h": 3600}


def seconds_of(value: float | str | None, name: str = "time") -> float | None:
    """Seconds, as a number or as a text such as "2.5", "45s", "3m" or "1h30m"."""
    if not isinstance(value, str):
        return value
    parts = re.findall(r"(\d+(?:\.\d+)?)([smh]?)", value.lower())
    # Without a unit only a single number is clear: "1h30" could mean minutes or seconds.
    if "".join(number + unit for number, unit in parts) != value.lower() or (len(parts) != 1 and any(not u for _, u in parts)):
        refuse(name, value, "seconds, or a text such as '45s', '3m' or '1h30m'")
    return sum(float(number) * _SECONDS[unit] for number, unit in parts)


def films_of(film: Any, checkpoint: Any, every: float | str | None, resume: bool,
             shard: tuple[int, int] | None) -> dict[str, Any]:
    """The films of a render, with the rules of the program's options."""
    paths = {name: None if value is None else path_of(name, value)
             for name, value in (("film", film), ("checkpoint", checkpoint))}
    same = None not in paths.values() and os.path.realpath(paths["film"]) == os.path.realpath(paths["checkpoint"])
    if shard is None:
        if same:
            paths["film"] = paths["checkpoint"]
        if checkpoint is None and resume:
            raise UsageError("resume: expected a checkpoint, the film to go on from")
        if checkpoint is None and every is not None:
            raise UsageError("every: expected a checkpoint, the film to keep")
    else:
        if isinstance(shard, (str, bytes)):  # "12" would be one
            refuse("shard", shard, "(k, n) with 1 <= k <= n")
        if film is None:
            raise UsageError("shard: expected a film for the shard's pixels")
        if same:
            raise UsageError("shard: film and checkpoint must differ: the checkpoint is the merged film "
                             "that all shards begin with")
    return {**paths, "every": seconds_of(every, "every"), "resume": resume, "shard": shard}


def layers_of(value: Any) -> str | None:
    """Names of layers as one text with commas."""
    expected = "'all', 'none', or names of layers: a text with commas or a list"
    if value is None:
        return None
    if isinstance(value, str):
        return text_of("layers", value)
    try:
        return ",".join(text_of("layers", name) for name in value) or "none"
    except TypeError:
        refuse("layers", value, expected)


def resolution_of(value: Any) -> Any:
    """(width, height), also from a text such as "640x360"."""
    if not isinstance(value, str):
        return value
    found = re.fullmatch(r"(\d+)[xX](\d+)", value)
    if not found:
        refuse("resolution", value, "(width, height), or a text such as '640x360'")
    return int(found[1]), int(found[2])


def vector_of(name: str, value: Any, expected: str) -> tuple[float, float, float]:
    if isinstance(value, (str, bytes)):  # "012" would be one
        refuse(name, value, expected)
    try:
        x, y, z = value
        return float(x), float(y), float(z)
    except (TypeError, ValueError, OverflowError):
        refuse(name, value, expected)


_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


def vector_in(text: str) -> tuple[float, float, float] | None:
    """The numbers of a text "x,y,z"; None where it is none."""
    if not re.fullmatch(rf"{_NUMBER}(,{_NUMBER}){{2}}", text):
        return None
    x, y, z = map(float, text.split(","))
    return x, y, z


def environment_of(value: Any) -> str | tuple[float, float, float] | None:
    """The path of an image, or a colour."""
    expected = "an image's path, a number or (r, g, b)"
    if value is None:
        return None
    if isinstance(value, str) and not os.path.exists(value):
        # A colour as the program's option takes it
        if re.fullmatch(_NUMBER, value):
            return (float(value),) * 3
        if colour := vector_in(value):
            return colour
    if isinstance(value, (str, bytes, os.PathLike)):
        return path_of("environment", value, expected)
    try:
        return (float(value),) * 3
    except (TypeError, ValueError, OverflowError):
        return vector_of("environment", value, expected)


def choice_of(name: str, value: str | int | None) -> str:
    """One of the file's: its name, or its number from 0; empty for the file's own choice."""
    if value is None:
        return ""
    if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
        return str(value)
    if not isinstance(value, str) or not text_of(name, value):
        refuse(name, value, "a name or a number from 0")
    return value


def is_camera_choice(value: Any) -> bool:
    """Whether it names one of the file's cameras, and is no view such as "eye 0,1,6 target 0,0,0 fov 40"."""
    return isinstance(value, int) or isinstance(value, str) and not value.split()[:1] == ["eye"]


def _camera_in(text: str) -> dict[str, Any] | None:
    """The values of a view as the program's option and `Scene.summary` have it; None where it is none."""
    words = text.split()
    camera: dict[str, Any] = dict(zip(words[::2], words[1::2]))
    if len(words) % 2 or len(camera) * 2 < len(words):
        return None
    for name in camera.keys() - {"fov"}:
        camera[name] = vector_in(camera[name])
        if camera[name] is None:
            return None
    return camera


def camera_of(value: Any) -> dict[str, Any] | None:
    """eye, target, fov and, where it is given, up."""
    expected = ("{'eye': (x, y, z), 'target': (x, y, z), 'fov': degrees}, 'up': (x, y, z) if need be, "
                "a text 'eye x,y,z target x,y,z fov N', or the name or number of one of the file's")
    if value is None:
        return None
    if isinstance(value, str):
        text, value = value, _camera_in(value)
        if value is None:
            refuse("camera", text, "a view such as 'eye 0,1,6 target 0,0,0 fov 40'")
    if not isinstance(value, Mapping) or not value.keys() <= {"eye", "target", "fov", "up"}:
        refuse("camera", value, expected)
    if missing := [name for name in ("eye", "target", "fov") if name not in value]:
        refuse("camera", value, f"{' and '.join(map(repr, missing))}, too: {expected}")
    camera: dict[str, Any] = {"up": None}
    for name, part in value.items():
        if name == "fov":
            try:
                camera[name] = float(part)
            except (TypeError, ValueError, OverflowError):
                refuse("camera", value, expected)
        elif name != "up" or part is not None:
            camera[name] = vector_of("camera", part, expected)
    return camera


_LAMP = ("'camera' or '0,2.5,1', with 'power 40', 'radius 0.1' or 'colour 1,0.9,0.8' after it, or a list of such texts")


def _lamp_in(text: str) -> tuple[Any, float, tuple[float, float, float], float | None]:
    """Place or None for the camera's, radius, colour and power or None, as the program's option has them."""
    words = text.lower().split()
    if len(words) % 2 == 0:
        refuse("light", text, _LAMP)
    at = None if words[0] == "camera" else vector_in(words[0])
    names = words[1::2]
    given = dict(zip(names, words[2::2]))
    colour = vector_in(given.pop("colour", "1,1,1"))
    numbers = {name: float(value) if re.fullmatch(_NUMBER, value) else 0 for name, value in given.items()}
    if (at is None and (words[0] != "camera" or "radius" in given) or len(set(names)) != len(names)
            or not numbers.keys() <= {"power", "radius"} or not all(1e-37 <= v <= 1e20 for v in numbers.values())
            or at is not None and not all(abs(c) <= 1e20 for c in at)
            or colour is None or not all(0 <= c <= 1e20 for c in colour)
            or not 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2] > 1e-6):
        refuse("light", text, _LAMP)
    return at, numbers.get("radius", 0.0), colour, numbers.get("power")


def lamps_of(value: Any) -> list[tuple[Any, float, tuple[float, float, float], float | None]]:
    """Lamps to be added, of one text or of several."""
    if value is None:
        return []
    try:
        texts = [value] if isinstance(value, str) else list(value)
    except TypeError:
        refuse("light", value, _LAMP)
    if not all(isinstance(text, str) for text in texts):  # such as a place in numbers
        refuse("light", value, _LAMP)
    return [_lamp_in(text) for text in texts]


def function_of(name: str, value: Callable[..., Any] | None) -> Callable[..., Any] | None:
    if value is not None and not callable(value):
        refuse(name, value, "a function")
    return value


def cancel_of(value: Any) -> Any:
    if value is not None and not callable(getattr(value, "is_set", None)):
        refuse("cancel", value, "what has is_set(), such as a threading.Event")
    return value
