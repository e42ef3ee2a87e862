"""The reconstruction of `hybrid` for images of other renderers."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal, Union

import numpy

from . import _covtrace
from .arguments import path_of, refuse
from .errors import UsageError
from .image import Array, Image
from .scene_warnings import warn

Picture = Union[Image, Array, str, "os.PathLike[str]"]
#: A layer's name, one array for all images, or one for each.
Feature = Union[str, Array, Sequence[Array], None]


def _pictures(color: Picture | Sequence[Picture]) -> list[Picture]:
    if isinstance(color, (list, tuple)):
        return list(color)
    if isinstance(color, numpy.ndarray) and color.ndim == 4:
        return list(color)
    return [color]


def _planes(picture: Picture) -> _covtrace.Planes:
    if isinstance(picture, Image):
        return picture._planes
    if isinstance(picture, numpy.ndarray):
        return Image.from_arrays(picture)._planes
    return Image.read(path_of("color", picture, "images, arrays or files"))._planes


def _arrays(name: str, value: Feature, count: int, channels: int) -> list[Array]:
    """One array (height, width, channels) for each image; (height, width) is one channel."""
    expected = (f"a layer's name, or an array (height, width{', 3' if channels == 3 else ''}), "
                "or one for each image")
    dimensions = 3 if channels == 3 else 2
    try:
        each = [numpy.asarray(v, dtype=numpy.float32)
                for v in (value if isinstance(value, (list, tuple)) else [value])]
        if len(each) == 1 and each[0].ndim == dimensions + 1:
            each = list(each[0])
    except (TypeError, ValueError):
        refuse(name, value, expected)
    if len(each) == 1:
        each *= count
    for array in each:
        if array.ndim != dimensions or (channels == 3 and array.shape[2] != 3):
            raise UsageError(f"{name} has the shape {array.shape}; expected {expected}")
    if len(each) != count:
        raise UsageError(f"{name} has {len(each)} arrays for {count} images; expected {expected}")
    return [a[:, :, None] if channels == 1 else a for a in each]


def denoise(color: Picture | Sequence[Picture], albedo: Feature = None, normal: Feature = None,
            depth: Feature = None, variance: Feature = None, *, layer: str | None = None,
            samples: float | None = None,
            denoiser: Literal["auto", "oidn", "none"] | None = None,
            denoiser_quality: Literal["high", "fast"] | None = None,
            denoiser_library: str | os.PathLike[str] | None = None, threads: int = 0) -> Image:
    """Reconstructs a picture that another renderer has made, as `covtrace denoise` does.

    color: two renders of the picture with different seeds, [A, B], or one whose variance is known;
        each an `Image`, a file, or an array (height, width, 3), linear.
    albedo, normal, depth: what is seen, as arrays for all images or as one for each: (height, width,
        3), and (height, width) for depth; or the names of layers in the images. By default the
        layers that renderers are known to write; "none" leaves them out.
    variance: of the colour of each pixel (its samples' mean), likewise.
    layer: the layer with the noisy colour, where it is not known; "root" for R, G, B.
    samples: samples per pixel of each image, where the images do not say.

    The `Image` has the layers "raw", "variance" and "error" (standard error of the luminance), and
    `statistics["error"]`: the root of the estimated mean relative squared error. Raises `UsageError`
    for images that cannot tell their noise; warns where layers are missing or pixels are lost.
    """
    pictures = _pictures(color)
    options: dict[str, Any] = {
        "color": layer, "samples": samples, "denoiser": denoiser, "denoiser_quality": denoiser_quality, "preset": None,
        "denoiser_library": None if denoiser_library is None
        else path_of("denoiser_library", denoiser_library), "threads": threads}
    additions: list[list[tuple[str, Array]]] = [[] for _ in pictures]
    for name, value, suffixes in (("albedo", albedo, "RGB"), ("normal", normal, "XYZ"),
                                  ("depth", depth, "Z"), ("variance", variance, "RGB")):
        options[name] = value
        if value is None or isinstance(value, str):
            continue
        options[name] = f"given {name}"
        for added, array in zip(additions, _arrays(name, value, len(pictures), len(suffixes))):
            added += [(f"given {name}.{s}", numpy.ascontiguousarray(array[:, :, c]))
                      for c, s in enumerate(suffixes)]
    given = [(str(p) if isinstance(p, (str, os.PathLike)) else f"color[{i}]", _planes(p), added)
             for i, (p, added) in enumerate(zip(pictures, additions))]
    planes, error, texts = _covtrace.denoise(given, options)
    for text in texts:
        warn(text)
    return Image(planes, statistics={"error": error})
