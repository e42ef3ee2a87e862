"""Images with named layers, as numpy arrays."""

from __future__ import annotations

import os
import tempfile
from collections.abc import ItemsView, Iterator, KeysView, Mapping, ValuesView
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _covtrace
from .arguments import linear_of, path_of, refuse, text_of
from .closed import Closed
from .scene_warnings import warn

Array = NDArray[numpy.float32]

#: The channels of our own layers that are no colours, in the order of their arrays.
_CHANNELS = {**dict.fromkeys(("N", "Ng", "P", "featureN"), ("X", "Y", "Z")), **dict.fromkeys(("uv", "dz"), ("X", "Y")),
             **dict.fromkeys(("filter", "spectrum", "inviewfilter"), ("xx", "xy", "yy")),
             **dict.fromkeys(("cov", "scatteredcov"), tuple(f"{i}{j}" for i in range(5) for j in range(i, 5)))}


def _layer_channels(name: str, values: ArrayLike) -> list[tuple[str, NDArray[Any]]]:
    """The channels of a layer by their full names: of an array of more than one the letters of that layer,
    or else those of a colour."""
    values = numpy.asarray(values)
    letters = _CHANNELS.get(name, ("R", "G", "B", "A"))
    count = values.shape[2] if values.ndim == 3 else 0
    if count and (count == len(letters) or (count == 3 and name not in _CHANNELS)):
        return [(f"{name}.{letters[c]}" if name else letters[c], values[:, :, c]) for c in range(count)]
    return [(name, values)]


def _plain(value: Any) -> Any:
    """A value of metadata without numpy's types, which would lose what is behind the point."""
    if isinstance(value, numpy.generic):
        return value.item()
    return value.tolist() if isinstance(value, numpy.ndarray) else value


class _Metadata(dict[str, Any]):
    """The metadata of planes. What is changed here is theirs, too."""

    def __init__(self, planes: _covtrace.Planes) -> None:
        super().__init__(planes.metadata)
        self._planes = planes

    def _replace(self, entries: Mapping[str, Any]) -> None:
        plain = {name: _plain(value) for name, value in entries.items()}
        try:
            self._planes.metadata = plain
        except TypeError:
            refuse("metadata", plain, "names with numbers, texts and lists of numbers")
        super().clear()
        super().update(self._planes.metadata)

    def __setitem__(self, name: str, value: Any) -> None:
        self._replace({**self, name: value})

    def __delitem__(self, name: str) -> None:
        rest = dict(self)
        del rest[name]
        self._replace(rest)

    def update(self, *entries: Any, **more: Any) -> None:
        self._replace({**self, **dict(*entries, **more)})

    def __ior__(self, entries: Any) -> _Metadata:
        self.update(entries)
        return self

    def setdefault(self, name: str, default: Any = None) -> Any:
        if name not in self:
            self[name] = default
        return self[name]

    def pop(self, name: str, *default: Any) -> Any:
        value = dict(self).pop(name, *default)
        if name in self:
            del self[name]
        return value

    def popitem(self) -> tuple[str, Any]:
        rest = dict(self)
        last = rest.popitem()
        self._replace(rest)
        return last

    def clear(self) -> None:
        self._replace({})

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)


# Layers by names in other programs
_LAYER_NAMES = {**dict.fromkeys(("rgb", "RGB", "rgba", "color", "colour", "beauty", "Combined"), "image.rgb is the delivered image"),
                **dict.fromkeys(("normal", "normals", "Normal"), "'N' has normals"), **dict.fromkeys(("depth", "z", "Depth"), "'Z' is the depth"),
                "noisy": "'raw' is what no filter has seen"}
_WRITE = "write('picture.png') and write('image.exr') write it"


class Image(Closed):
    """A rendered or loaded image.

    Layers and channels are float32 views of the image's own memory: no copy is made, writing into
    them changes the image. Rows run from the top, so `image.rgb[y, x]`. `image[name]`, `keys`,
    `items` and iteration are over layers, as of a dictionary; `numpy.asarray(image)` is `rgb`.
    Images can be pickled and copied, and notebooks show them.

    rgb: (height, width, 3), the delivered image.
    layers: name -> (height, width, n), or (height, width) for layers of one channel such as "Z",
        "samples", "error"; the delivered image is layer "".
    channels: name -> (height, width): "R", "raw.R", "cov.00", ...
    metadata: the entries of the file's header, a dictionary; what is set there is written.
    complete: False where the render was stopped before its end.
    statistics: counters, seconds per phase, memory; empty for images that were read.
    """

    _other_names = {**dict.fromkeys(("save", "savefig", "to_file", "export", "write_png", "write_exr", "to_png", "to_exr"), _WRITE),
                    **dict.fromkeys(("show", "plot", "display"), f"a notebook shows it where it is the last line of a cell; {_WRITE}"),
                    **dict.fromkeys(("pixels", "data", "array", "numpy", "to_numpy", "asarray", "dtype", "mean", "max", "min", "astype", "copy"),
                                    "rgb is its array, and layers and channels have the rest"),
                    **dict.fromkeys(("stats", "time", "seconds", "spp"), "statistics and metadata tell of the render"),
                    **dict.fromkeys(("exposure", "tonemap", "view", "gamma", "srgb"), "write('picture.png', exposure=1, view='agx') shows it so"),
                    **dict.fromkeys(("to_pil", "pil", "__array_interface__"),
                                    "rgb is linear and float32; write('picture.png') makes the file of 8 bits that other libraries open"),
                    **dict.fromkeys(("depth", "z"), "its layers are items, such as ['Z']"),
                    **dict.fromkeys(("normal", "normals"), "its layers are items, such as ['N']"),
                    "denoise": "covtrace.denoise(image) makes another",
                    **dict.fromkeys(("compare", "psnr", "mse", "flip"), "covtrace.compare(image, reference) measures it")}

    _set_by = {"rgb": "image.rgb[:] = values writes into it, and Image.from_arrays(values) makes an image"}

    layers: Mapping[str, Array]
    channels: Mapping[str, Array]
    complete: bool
    statistics: dict[str, Any]

    def __init__(self, planes: _covtrace.Planes, complete: bool | None = None,
                 statistics: dict[str, Any] | None = None) -> None:
        if not isinstance(planes, _covtrace.Planes):
            raise TypeError("Image() makes no images; Image.read(file) reads one, and Image.from_arrays(rgb) takes arrays")
        self._planes = planes
        self._metadata = _Metadata(planes)
        self.layers = MappingProxyType(planes.layers())
        self.channels = MappingProxyType(planes.channels())
        self.statistics = statistics or {}
        if complete is None:
            complete = bool(planes.metadata.get("complete", 1))
        self.complete = complete

    @classmethod
    def read(cls, file: str | os.PathLike[str]) -> Image:
        """Reads an EXR, PNG, JPEG, TGA, HDR, PFM, PGM, PPM, QOI or WebP file; integer colours become
        linear."""
        return cls(_covtrace.Planes.read(os.fspath(file)))

    @classmethod
    def from_arrays(cls, rgb: ArrayLike | None = None,
                    layers: Mapping[str, ArrayLike | Mapping[str, ArrayLike]] | None = None,
                    metadata: Mapping[str, Any] | None = None) -> Image:
        """Makes an image of arrays (copied): `rgb` (height, width, 3), `layers` name -> (height,
        width), (height, width, 3) or {channel name: (height, width)} such as {"N": {"X": x, "Y": y,
        "Z": z}}. Channels of arrays are X, Y, Z in "N", "Ng" and "P", and R, G, B in layers that are
        not known."""
        channels = []
        if rgb is not None:
            rgb = linear_of("rgb", rgb)
            if rgb.ndim != 3 or rgb.shape[2] not in (3, 4):
                raise ValueError(f"rgb has the shape {rgb.shape}; expected (height, width, 3)")
            channels += [("RGBA"[c], rgb[:, :, c]) for c in range(rgb.shape[2])]
        for name, values in (layers or {}).items():
            if isinstance(values, Mapping):
                channels += [(f"{name}.{c}", numpy.asarray(v)) for c, v in values.items()]
            else:
                channels += _layer_channels(name, values)
        planes = _covtrace.Planes.from_channels(channels)
        _Metadata(planes).update(metadata or {})
        return cls(planes)

    def __getitem__(self, name: str) -> Array:
        """A layer, or a single channel by its full name."""
        if name in self.layers:
            return self.layers[name]
        if name in self.channels:
            return self.channels[name]
        meant = _LAYER_NAMES.get(name) if isinstance(name, str) else "image.rgb[y, x] for a pixel"
        raise KeyError(f"no layer or channel {name!r}; there are " + ", ".join(repr(k) for k in self.layers)
                       + (f"; {meant}" if meant else ""))

    def __contains__(self, name: object) -> bool:
        return name in self.layers or name in self.channels

    def __iter__(self) -> Iterator[str]:
        return iter(self.layers)

    def __len__(self) -> int:
        return len(self.layers)

    def keys(self) -> KeysView[str]:
        """The names of the layers, "" of the delivered image."""
        return self.layers.keys()

    def values(self) -> ValuesView[Array]:
        return self.layers.values()

    def items(self) -> ItemsView[str, Array]:
        return self.layers.items()

    def get(self, name: str, default: Any = None) -> Any:
        """A layer or channel, or else `default`."""
        return self[name] if name in self else default

    def __array__(self, dtype: DTypeLike = None, copy: bool | None = None) -> NDArray[Any]:
        """The delivered image, (height, width, 3): a view, unless another type or a copy is asked
        for."""
        rgb = self.rgb if dtype is None else self.rgb.astype(dtype, copy=False)
        return rgb.copy() if copy else rgb

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (list(self.channels.items()), self.data_window, self.display_window,
                           dict(self.metadata), self.complete, self.statistics)

    def _repr_png_(self) -> bytes:
        """The picture that notebooks show: sRGB, without exposure."""
        with tempfile.TemporaryDirectory(prefix="covtrace-") as folder:
            file = os.path.join(folder, "image.png")
            self.write(file)
            with open(file, "rb") as picture:
                return picture.read()

    @property
    def rgb(self) -> Array:
        root = self.layers.get("")
        if root is None:
            raise KeyError("the image has no root layer")
        return root[:, :, :3]

    def matrices(self, name: str) -> Array:
        """A layer of symmetric matrices written out (a copy): "filter" and "spectrum" as
        (height, width, 2, 2), "cov" as (height, width, 5, 5) over pixel x, pixel y, lens u, lens v,
        shutter t."""
        values = self.layers[name]
        n = {3: 2, 15: 5}.get(values.shape[2] if values.ndim == 3 else 1)
        if n is None:
            raise ValueError(f"layer {name!r} holds no symmetric matrices")
        rows, columns = numpy.triu_indices(n)
        full = numpy.empty(values.shape[:2] + (n, n), dtype=values.dtype)
        full[:, :, rows, columns] = values
        full[:, :, columns, rows] = values
        return full

    @property
    def metadata(self) -> dict[str, Any]:
        return self._metadata

    @metadata.setter
    def metadata(self, entries: Mapping[str, Any]) -> None:
        self._metadata._replace(entries)

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) of the stored pixels."""
        return self._planes.size

    @property
    def width(self) -> int:
        return self.size[0]

    @property
    def height(self) -> int:
        return self.size[1]

    @property
    def shape(self) -> tuple[int, int, int]:
        """That of `rgb`: (height, width, 3)."""
        return self.height, self.width, 3

    def _meant_by(self, name: str) -> str:
        if name in self.__dict__.get("layers", ()):
            return f"its layers are items, such as [{name!r}]"
        return super()._meant_by(name)

    @property
    def data_window(self) -> tuple[int, int, int, int]:
        """(x0, y0, x1, y1), end exclusive, of the stored pixels inside the display window."""
        return self._planes.data_window

    @property
    def display_window(self) -> tuple[int, int, int, int]:
        return self._planes.display_window

    def write(self, file: str | os.PathLike[str], *, exposure: float = 0,
              view: str | None = None, ocio_config: str | os.PathLike[str] | None = None,
              ocio_display: str | None = None, ocio_look: str | None = None,
              ocio_source: str | None = None) -> None:
        """Writes the format that the name says: all layers (.exr, or no ending), the sRGB picture
        (.png), or the linear colour (.pfm, .hdr); beside and renamed. The picture alone is
        brightened by `exposure` stops and shown by `view`: "srgb" (default), "filmic", "agx", or
        one of the OpenColorIO config `ocio_config`, for one of its displays, with a look in place
        of the view's own, from one of its colour spaces: all as by the options of `covtrace
        render`. `UsageError`, a `ValueError`, for other endings and names that the config does not
        have; `SceneError` for a config that cannot be read."""
        try:
            stops = float(exposure)
        except (TypeError, ValueError, OverflowError):
            refuse("exposure", exposure, "a number of stops")
        names = {"view": view, "ocio_display": ocio_display, "ocio_look": ocio_look, "ocio_source": ocio_source}
        for name, value in names.items():
            if value in ("", b""):  # as of a variable that is not set
                refuse(name, value, "a name")
        texts = {name: "" if value is None else text_of(name, value) for name, value in names.items()}
        config = "" if ocio_config is None else path_of("ocio_config", ocio_config)
        for text in self._planes.write(os.fspath(file), stops, texts["view"], config, texts["ocio_display"],
                                       texts["ocio_look"], texts["ocio_source"]):
            warn(text)

    def describe(self) -> str:
        """Several lines for people: windows, channels with their ranges, metadata."""
        return self._planes.describe()

    def __repr__(self) -> str:
        width, height = self.size
        return f"<covtrace.Image {width}x{height}, layers {', '.join(map(repr, self.layers))}>"


def _restored(channels: list[tuple[str, Array]], data: tuple[int, int, int, int],
              display: tuple[int, int, int, int], metadata: dict[str, Any], complete: bool,
              statistics: dict[str, Any]) -> Image:
    """The image that was pickled."""
    planes = _covtrace.Planes.from_channels(channels, data, display)
    planes.metadata = metadata
    return Image(planes, complete, statistics)


@dataclass(frozen=True)
class Comparison:
    """The measures of `covtrace compare`; decile_ratio has ten numbers, the darkest decile's first,
    NaN where one is empty or black; flip_map is (height, width)."""

    mse: float
    relmse: float
    relmse_trimmed: float
    relmse_median: float
    psnr: float
    flip: float
    mean_ratio: tuple[float, float, float]
    decile_ratio: tuple[float, ...]
    nonfinite: int
    identical: bool
    flip_map: Array


def _planes(image: Image | Array | str | os.PathLike[str]) -> _covtrace.Planes:
    if isinstance(image, Image):
        return image._planes
    if isinstance(image, numpy.ndarray):
        return Image.from_arrays(image)._planes
    return Image.read(image)._planes


def compare(image: Image | Array | str | os.PathLike[str],
            reference: Image | Array | str | os.PathLike[str]) -> Comparison:
    """Measures how far `image` is from `reference`: images, (height, width, 3) arrays or files."""
    return Comparison(**_planes(image).compare(_planes(reference)))
