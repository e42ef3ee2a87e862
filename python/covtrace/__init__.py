"""covtrace: a path tracer that predicts the samples and the filter of every pixel.

>>> import covtrace
>>> image = covtrace.render("scene.pbrt", spp=16)
>>> image.rgb.shape, image["samples"].mean(), image.complete
>>> image.write("scene.exr")

`render` takes the path of a scene, a `Scene` (from a file or a string) or a `SceneBuilder` (from
numpy arrays). Layers are numpy views of the renderer's own memory. `covtrace.covariance` holds the
operators of the covariance library on arrays.
"""

try:
    import numpy as _numpy  # that all modules need
    from ._processor import missing_instructions as _missing_instructions
    if _missing_instructions is not None:
        raise ImportError(f"covtrace: {_missing_instructions}")
    from ._covtrace import __version__
except ModuleNotFoundError as missing:
    import pathlib as _pathlib
    import sys as _sys

    if missing.name and not missing.name.startswith("covtrace"):
        raise ImportError(f"covtrace: {missing}; {_sys.executable} needs it: pip install {missing.name}, or on Debian "
                          f"/usr/bin/python3 and its package python3-{missing.name}") from missing
    _built = ", ".join(p.name for p in _pathlib.Path(__file__).parent.glob("_covtrace.*.so"))
    raise ImportError(f"covtrace: {missing}; this is {_sys.executable}, the package was built for "
                      f"another Python ({_built}), on Debian /usr/bin/python3") from missing

from typing import NoReturn as _NoReturn

from . import covariance
from .builder import SceneBuilder
from .denoising import denoise
from .errors import (Error, FileError, InternalError, Interrupted, LimitError, SceneError,
                     SceneWarning, UsageError)
from .films import merge
from .image import Comparison, Image, compare
from .progress import Progress
from .rendering import render
from .running import RunningRender, start
from .scene import Scene

_SCENE = "covtrace.Scene(file) reads a scene"
_IMAGE = "covtrace.Image.read(file) reads an image"
_OTHER_NAMES = {**dict.fromkeys(("load", "open", "read"), f"{_SCENE}, {_IMAGE}"),
                **dict.fromkeys(("load_scene", "read_scene", "load_file", "load_gltf", "load_pbrt"), _SCENE),
                **dict.fromkeys(("load_image", "read_image", "imread"), _IMAGE),
                **dict.fromkeys(("render_file", "trace"), "covtrace.render(file) renders a scene"),
                **dict.fromkeys(("save", "write", "imwrite", "save_image", "write_image"), "image.write('picture.png') writes an image"),
                "version": "covtrace.__version__ is it"}


def __getattr__(name: str) -> _NoReturn:
    meant = _OTHER_NAMES.get(name, "")
    raise AttributeError(f"module 'covtrace' has no attribute {name!r}{meant and '; '}{meant}")


__all__ = ["Comparison", "Error", "FileError", "Image", "InternalError", "Interrupted",
           "LimitError", "Progress", "RunningRender", "Scene", "SceneBuilder", "SceneError", "SceneWarning",
           "UsageError", "__version__", "compare", "covariance", "denoise", "merge", "render", "start"]
