"""Films of shards, joined."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, Literal

from . import _covtrace
from .arguments import layers_of, path_of, paths_of
from .errors import UsageError
from .image import Image
from .scene_warnings import warn


def merge(films: Iterable[str | os.PathLike[str]], *, film: str | os.PathLike[str] | None = None,
          image: bool = True, layers: str | Iterable[str] | None = None,
          denoiser: Literal["auto", "oidn", "none"] | None = None,
          denoiser_quality: Literal["high", "fast"] | None = None,
          denoiser_library: str | os.PathLike[str] | None = None, threads: int = 0) -> Image:
    """Joins the films of a render's shards, in any order, and makes their image, as `covtrace merge`.

    films: files that `render(film=...)` and the program wrote; one film alone gives its image.
    film: file that keeps the joined film, the checkpoint from which all shards go on.
    image: False joins the films alone, between rounds: the `Image` has no layers.
    layers, denoiser, denoiser_quality, denoiser_library, threads: as for `render`.

    Where every shard is there the image is the one that a render without shards makes. `complete`
    is False where shards are missing or their rounds have not come to an end, and a warning where
    an image is made;
    `statistics` tells "spp" and, of films of shards in the same round,
    how many "shards" there are and are "present". Raises `UsageError` for films of
    different renders or rounds, and `SceneError` for files that are no films.
    """
    files = paths_of("films", films, "a list of files")
    if not files:
        raise UsageError("films is empty; expected the films of a render's shards")
    if film is not None and os.path.realpath(film) in map(os.path.realpath, files):
        raise UsageError(f"film is {film!r}, one of the films that are read; expected another file")
    options: dict[str, Any] = {
        "film": None if film is None else path_of("film", film), "layers": layers_of(layers),
        "image": image, "denoiser": denoiser, "denoiser_quality": denoiser_quality, "preset": None, "threads": threads,
        "denoiser_library": None if denoiser_library is None
        else path_of("denoiser_library", denoiser_library)}
    planes, complete, statistics, texts = _covtrace.merge(files, options)
    for text in texts:
        warn(text)
    return Image(planes, complete, statistics)
