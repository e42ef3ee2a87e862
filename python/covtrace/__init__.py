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

__all__ = ["Comparison", "Error", "FileError", "Image", "InternalError", "Interrupted",
           "LimitError", "Progress", "RunningRender", "Scene", "SceneBuilder", "SceneError", "SceneWarning",
           "UsageError", "__version__", "compare", "covariance", "denoise", "merge", "render", "start"]
