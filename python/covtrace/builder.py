"""Scenes built from Python values and numpy arrays."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy
from numpy.typing import ArrayLike

from .arguments import linear_of, refuse, resolution_of, shutter_of, vector_of
from .builder_calls import BuilderCalls, describe_call
from .closed import Hinting
from .errors import UsageError
from .image import Image

_NAME = re.compile(r"[^\x00-\x1f\"\\]+")


def _quoted(text):
    if not isinstance(text, str) or not _NAME.fullmatch(text):
        raise ValueError(f"{text!r}: expected a text without quotes, backslashes and line ends")
    return f'"{text}"'


def _numbers(values):
    return "[ " + " ".join(repr(float(v)) for v in numpy.ravel(values)) + " ]"


def _texts(value):
    """The value as text where it is a text or a list of texts, None where it is something else."""
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, (list, tuple)) and value and all(isinstance(v, str) for v in value):
        return "[ " + " ".join(_quoted(v) for v in value) + " ]"
    return None


def _parameter(name, value):
    """One parameter as text. `name` may carry pbrt's type, "texture reflectance"; else the value
    tells: a number, a text, a truth value, three numbers for a colour; a few names do, too, of
    which some are colours that one number makes grey."""
    texts = _texts(value)
    if " " not in name and name in _TYPES and texts is None:
        name = f"{_TYPES[name]} {name}"
    if " " in name:
        kind = name.split()[0]
        if isinstance(value, bool):
            return f"{_quoted(name)} {'true' if value else 'false'}"
        if texts is not None:
            return f"{_quoted(name)} {texts}"
        if kind == "integer":
            return f"{_quoted(name)} [ {' '.join(str(int(v)) for v in numpy.ravel(value))} ]"
        return f"{_quoted(name)} {_numbers(value)}"
    if isinstance(value, (bool, numpy.bool_)):
        return f'"bool {name}" {"true" if value else "false"}'
    if texts is not None:
        return f'"string {name}" {texts}'
    if isinstance(value, (int, numpy.integer)) and name in _INTEGERS:
        return f'"integer {name}" {int(value)}'
    if isinstance(value, (int, float, numpy.number)) and name in _COLOURS:
        return f'"rgb {name}" {_numbers([value] * 3)}'
    if isinstance(value, (int, float, numpy.number)):
        return f'"float {name}" {float(value)!r}'
    values = numpy.asarray(value, dtype=float)
    if values.shape == (3,):
        return f'"rgb {name}" {_numbers(values)}'
    raise TypeError(f"parameter {name!r}: give its type as in 'float {name}' or 'spectrum {name}'")


_INTEGERS = {"apertureblades", "degree", "dimension", "levels", "maxdepth", "nsamples", "pixelsamples", "splitdepth",
             "tubesides", "xresolution", "yresolution"}

#: Parameters that are colours in every kind of light, material and medium that has them.
_COLOURS = {"I", "L", "albedo", "color", "coattint", "edgetint", "mfp", "normalreflectance", "reflectance", "sheen", "sigma_a",
            "sigma_s", "transmittance"}

#: Types of parameters whose values are neither colours nor single numbers.
_TYPES = {"from": "point3", "to": "point3", "P": "point3", "p0": "point3", "p1": "point3", "portal": "point3",
          "N": "normal", "S": "vector3", "v1": "vector3", "v2": "vector3", "dir": "vector3", "uv": "point2",
          "indices": "integer", "screenwindow": "float", "longitude": "float", "latitude": "float", "conestretch": "float"}


def _parameters(values):
    return " ".join(_parameter(name, value) for name, value in values.items())


def _matrix(transform):
    """A transform as text: pbrt writes the columns of the matrix that maps column vectors."""
    m = numpy.asarray(transform, dtype=float)
    if m.shape != (4, 4):
        raise ValueError(f"a transform has the shape {m.shape}; expected (4, 4)")
    return "[ " + " ".join(repr(float(v)) for v in m.T.ravel()) + " ]"


def _moved(transform, end_transform):
    lines = []
    if end_transform is None:
        if transform is not None:
            lines.append(f"ConcatTransform {_matrix(transform)}")
    else:
        start = numpy.eye(4) if transform is None else transform
        lines += ["ActiveTransform StartTime", f"ConcatTransform {_matrix(start)}",
                  "ActiveTransform EndTime", f"ConcatTransform {_matrix(end_transform)}",
                  "ActiveTransform All"]
    return lines


class SceneBuilder(Hinting):
    """Collects a scene and renders it, or writes it as a pbrt-v4 file with its meshes and textures.

    >>> scene = covtrace.SceneBuilder()
    >>> scene.camera(eye=(0, 1, 4), target=(0, 0, 0), fov=40, resolution=(320, 180))
    >>> scene.material("red", "diffuse", reflectance=(0.6, 0.1, 0.1))
    >>> scene.mesh(vertices, triangles, material="red")
    >>> scene.light("infinite", L=(1, 1, 1))
    >>> image = covtrace.render(scene, spp=16)

    Parameters of pbrt are keyword arguments. Their type follows from the value (a number, a text, a
    truth value, three numbers for a colour, of which one is grey); others are given with their type:
    `**{"spectrum eta": "metal-Cu-eta"}`, `**{"texture reflectance": "checks"}`.
    Transforms are 4x4 matrices for column vectors; `end_transform` is the one at the shutter's end.
    """

    _other_names = {**dict.fromkeys(("sphere", "add_sphere", "disk", "add_shape"), "shape('sphere', radius=1) adds a shape by pbrt's name"),
                    **dict.fromkeys(("add_mesh", "triangles", "add_triangles"), "mesh(vertices, triangles) adds a mesh"),
                    **dict.fromkeys(("add_light", "environment", "add_lamp"), "light('infinite', L=1) adds a light by pbrt's name"),
                    **dict.fromkeys(("set_camera", "look_at"), "camera(eye=..., target=..., fov=...) sets the camera"),
                    "add_material": "material('red', 'diffuse', reflectance=...) adds a material",
                    "add_texture": "texture('checks', values) adds a texture",
                    "render": "covtrace.render(builder) renders it", "save": "write(folder) writes it"}

    def __init__(self) -> None:
        # Lines of the text, each with the call that it comes from
        self._camera: list[tuple[str, str]] = []
        self._view: list[tuple[str, str]] = []
        self._world: list[tuple[str, str]] = []
        self._meshes: list[tuple[str, list[str], numpy.ndarray, numpy.ndarray]] = []
        self._textures: list[tuple[str, Image]] = []
        self._files: dict[str, str] = {}  # the calls of meshes and textures, by file
        self._shutter = (0, 1)

    def camera(self, eye: Sequence[float] = (0, 0, 0), target: Sequence[float] = (0, 0, 1),
               up: Sequence[float] = (0, 1, 0), kind: str = "perspective",
               resolution: tuple[int, int] | str = (640, 360), shutter: tuple[float, float] = (0, 1),
               **parameters: Any) -> None:
        """Sets the camera, in place of an earlier one; kind and parameters as pbrt's Camera: fov,
        lensradius, focaldistance ..."""
        look_at = [vector_of(name, value, "(x, y, z)") for name, value in (("eye", eye), ("target", target), ("up", up))]
        shutter = shutter_of(shutter) or (0, 1)
        self._shutter = shutter
        size = resolution_of(resolution)
        try:
            size = tuple(size)
            width, height = map(int, size)
            if (width, height) != size:  # 1.5, or "640"
                raise ValueError
        except (TypeError, ValueError, OverflowError):
            refuse("resolution", resolution, "(width, height), or a text such as '640x360'")
        call = describe_call("camera", kind)
        self._camera = [(line, call) for line in [
            "LookAt " + " ".join(repr(v) for vector in look_at for v in vector),
            f"Camera {_quoted(kind)} "
            + _parameters({"float shutteropen": shutter[0], "float shutterclose": shutter[1],
                           **parameters}),
            f'Film "rgb" "integer xresolution" {width} "integer yresolution" {height}'
            # The exposure is the shutter's length; the image should not depend on it.
            + ('' if shutter[1] == shutter[0]
               else f' "float iso" {100 / (shutter[1] - shutter[0])!r}'),
        ]]

    def integrator(self, max_depth: int = 8, spp: int = 16) -> None:
        call = describe_call("integrator", max_depth, spp)
        self._view += [(f'Integrator "volpath" "integer maxdepth" {int(max_depth)}', call),
                       (f'Sampler "zsobol" "integer pixelsamples" {int(spp)}', call)]

    def texture(self, name: str, values: ArrayLike, **parameters: Any) -> None:
        """An image as texture: (height, width) for numbers, (height, width, 3) for colours, linear
        values; rows from the top. Use it as `**{"texture reflectance": name}`."""
        values = _texels(values)
        rgb = values if values.ndim == 3 else numpy.repeat(values[:, :, None], 3, axis=2)
        image = Image.from_arrays(rgb)
        file = f"texture-{len(self._textures)}.exr"
        kind = "spectrum" if values.ndim == 3 else "float"
        self._textures.append((file, image))
        self._files[file] = call = describe_call("texture", name)
        self._world.append((f"Texture {_quoted(name)} \"{kind}\" \"imagemap\" "
                            f"\"string filename\" \"{file}\" " + _parameters(parameters), call))

    def material(self, name: str, kind: str, **parameters: Any) -> None:
        """Adds a named material; kind and parameters as pbrt's MakeNamedMaterial."""
        self._world.append((f"MakeNamedMaterial {_quoted(name)} \"string type\" {_quoted(kind)} "
                            + _parameters(parameters), describe_call("material", name, kind)))

    def light(self, kind: str, transform: ArrayLike | None = None, **parameters: Any) -> None:
        """Adds a light; kind and parameters as pbrt's LightSource."""
        call = describe_call("light", kind)
        self._world += [(line, call) for line in [
            "AttributeBegin", *_moved(transform, None),
            f"LightSource {_quoted(kind)} " + _parameters(parameters), "AttributeEnd"]]

    def mesh(self, vertices: ArrayLike, triangles: ArrayLike, normals: ArrayLike | None = None,
             uv: ArrayLike | None = None, material: str | None = None,
             emission: ArrayLike | None = None, transform: ArrayLike | None = None,
             end_transform: ArrayLike | None = None, two_sided: bool = False) -> None:
        """Adds a mesh: vertices (n, 3), triangles (m, 3) indices; normals (n, 3), uv (n, 2);
        `emission`: radiance."""
        vertices = _array(vertices, 3, "vertices")
        triangles = numpy.asarray(triangles)
        if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
            raise ValueError("triangles: expected an integer array of the shape (m, 3)")
        if triangles.size and (triangles.min() < 0 or triangles.max() >= len(vertices)):
            raise ValueError("triangles: an index is out of range")
        columns = [vertices]
        names = ["x", "y", "z"]
        if normals is not None:
            columns.append(_array(normals, 3, "normals", len(vertices)))
            names += ["nx", "ny", "nz"]
        if uv is not None:
            columns.append(_array(uv, 2, "uv", len(vertices)))
            names += ["u", "v"]
        file = f"mesh-{len(self._meshes)}.ply"
        self._meshes.append((file, names, numpy.concatenate(columns, axis=1),
                             triangles.astype(numpy.int32)))
        self._files[file] = call = describe_call("mesh")
        self._shape(call, f'Shape "plymesh" "string filename" "{file}"', material, emission,
                    transform, end_transform, two_sided)

    def shape(self, kind: str, material: str | None = None, emission: ArrayLike | None = None,
              transform: ArrayLike | None = None, end_transform: ArrayLike | None = None,
              two_sided: bool = False, **parameters: Any) -> None:
        """Adds a shape; kind and parameters as pbrt's Shape: sphere, disk, ..."""
        self._shape(describe_call("shape", kind), f"Shape {_quoted(kind)} " + _parameters(parameters),
                    material, emission, transform, end_transform, two_sided)

    def _shape(self, call, directive, material, emission, transform, end_transform, two_sided):
        lines = ["AttributeBegin", *_moved(transform, end_transform)]
        if material is not None:
            lines.append(f"NamedMaterial {_quoted(material)}")
        if emission is not None:
            lines.append('AreaLightSource "diffuse" '
                         + _parameters({"L": numpy.broadcast_to(emission, 3),
                                        "twosided": bool(two_sided)}))
        self._world += [(line, call) for line in (*lines, directive, "AttributeEnd")]

    def text(self) -> str:
        """The scene as pbrt-v4 text; meshes and textures are files beside it."""
        return "\n".join([*(line for line, _ in self._lines()), ""])

    def _lines(self) -> list[tuple[str, str | None]]:
        if not self._camera:
            raise ValueError("the scene has no camera; call camera()")
        start, end = (float(t) for t in self._shutter)
        # The time of `end_transform` is the shutter's end, not the time 1 that pbrt would give it.
        times = [(f"TransformTimes {start!r} {end!r}", None)] if start < end else []
        return [*times, *self._camera, *self._view, ("WorldBegin", None), *self._world]

    def written(self, folder: str | os.PathLike[str]) -> tuple[str, BuilderCalls]:
        """Writes the scene as `write` does; returns its path, and the calls that it comes from."""
        calls = BuilderCalls()
        calls.text = self.write(folder)
        calls.lines = [call for _, call in self._lines()]
        calls.files = dict(self._files)
        return calls.text, calls

    def write(self, folder: str | os.PathLike[str], name: str = "scene.pbrt") -> str:
        """Writes the scene with its meshes and textures into a folder; returns the scene's path.
        `UsageError` where the scene would take the place of a file that the scene reads."""
        os.makedirs(folder, exist_ok=True)
        text = self.text()
        own = [file for file, *_ in (*self._meshes, *self._textures)]
        _require_distinct(folder, name, own, text)
        for file, names, columns, triangles in self._meshes:
            _write_ply(os.path.join(folder, file), names, columns, triangles)
        for file, image in self._textures:
            image.write(os.path.join(folder, file))
        path = os.path.join(folder, name)
        with open(path, "w", encoding="utf-8") as out:
            out.write(text)
        return path


def _require_distinct(folder, name, own, text):
    """Raises UsageError where a file that is written is another one, or one that the scene names."""
    def same(a, b):
        a, b = os.path.join(folder, a), os.path.join(folder, b)
        if os.path.exists(a) and os.path.exists(b):
            return os.path.samefile(a, b)
        return os.path.realpath(a) == os.path.realpath(b)

    # A name that the text has more often than the scene has own files of it is a file that it
    # reads.
    named = Counter(re.findall(r'"(?:string|spectrum) \w+" "([^"\n]*)"', text))
    read = [value for value in (named - Counter(own)) if os.path.isfile(os.path.join(folder, value))]
    for target in (name, *own):
        for file in read:
            if same(target, file):
                raise UsageError(f"{os.path.join(folder, target)!r} would take the place of {file!r}, "
                                 "which the scene reads; expected another folder or name")
    for file in own:
        if same(name, file):
            raise UsageError(f"name: {name!r} is the file of a mesh or texture of the scene already; "
                             "expected another one, such as scene.pbrt")


def _texels(values):
    """The values of a texture in single precision. `UsageError` for those that are none."""
    if isinstance(values, (str, os.PathLike)):
        raise UsageError(f"values is {values!r}; expected an array, such as covtrace.Image.read({values!r}).rgb")
    given = numpy.asarray(values)
    if given.ndim not in (2, 3) or not given.size or (given.ndim == 3 and given.shape[2] not in (3, 4)):
        raise UsageError(f"values has the shape {given.shape}; expected (height, width) or (height, width, 3)")
    values = linear_of("values", given)
    if not numpy.isfinite(values).all():
        raise UsageError("values has numbers that are not finite; expected finite ones")
    return values


def _array(values, width, what, length=None):
    values = numpy.asarray(values, dtype=numpy.float32)
    if values.ndim != 2 or values.shape[1] != width or (length is not None and len(values) != length):
        expected = f"({'n' if length is None else length}, {width})"
        raise ValueError(f"{what} has the shape {values.shape}; expected {expected}")
    return values


def _write_ply(path, names, columns, triangles):
    header = "\n".join(["ply", "format binary_little_endian 1.0", f"element vertex {len(columns)}",
                        *(f"property float {n}" for n in names), f"element face {len(triangles)}",
                        "property list uchar int vertex_indices", "end_header", ""])
    faces = numpy.empty(len(triangles), dtype=[("n", "u1"), ("i", "<i4", 3)])
    faces["n"] = 3
    faces["i"] = triangles
    with open(path, "wb") as out:
        out.write(header.encode())
        columns.astype("<f4").tofile(out)
        faces.tofile(out)
