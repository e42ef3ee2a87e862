"""The parts of a scene that can be changed between renders: camera, materials, lights, shapes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _covtrace
from .closed import Closed, Hinting
from .errors import UsageError

Matrix = NDArray[numpy.float64]


class Part(Closed):
    """A part of a scene. Its values have the names of pbrt's parameters: `part["roughness"] = 0.2`.

    A value is a number or a colour (r, g, b), linear Rec.709; None where a texture varies it, or
    where it has none. Setting it replaces the texture. Changes are seen by the next render.
    """

    _kind: str
    _elsewhere = ""  # what else of it can be changed, for messages

    def __init__(self, description: _covtrace.SceneDescription, index: int = 0) -> None:
        self._description = description
        self._index = index

    def _values(self) -> dict[str, float | tuple[float, float, float] | None]:
        return dict(self._description.values(self._kind, self._index))

    def keys(self) -> list[str]:
        return list(self._values())

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __getitem__(self, name: str) -> float | tuple[float, float, float] | None:
        values = self._values()
        if name not in values:
            raise KeyError(f"there is no value {name!r}; there are {', '.join(values) or 'none'}{self._elsewhere}")
        return values[name]

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        self._description.set_value(self._kind, self._index, name, value)

    def _meant_by(self, name: str) -> str:
        if not name.startswith("_") and name in self._values():
            return f"its values are items, such as [{name!r}]"
        return super()._meant_by(name)

    def __repr__(self) -> str:
        return f"<{self._title()} {self._values()}>"

    def _title(self) -> str:
        return self._kind.replace("_", " ")


class Placed(Closed):
    """A part with a place: `to_world` is its (4, 4) matrix for column vectors; `end_to_world` that at
    the shutter's end, None where it rests."""

    _kind: str
    _index: int
    _description: _covtrace.SceneDescription

    @property
    def to_world(self) -> Matrix:
        return self._description.transforms(self._kind, self._index)[0]

    @to_world.setter
    def to_world(self, matrix: ArrayLike) -> None:
        self.place(matrix)

    @property
    def end_to_world(self) -> Matrix | None:
        return self._description.transforms(self._kind, self._index)[1]

    def place(self, start: ArrayLike, end: ArrayLike | None = None) -> None:
        """Places it; with `end` it moves from one matrix to the other while the shutter is open."""
        self._description.set_transforms(self._kind, self._index, start, end)


class Camera(Part, Placed):
    """The camera: "fov" (degrees: of the shorter side, of a fisheye's circle), "lensradius", "focaldistance", as far as its kind has
    them; x is right, y up and z forward in its own space."""

    _kind = "camera"
    _elsewhere = "; look_at(eye, target) places it"
    _items = "fov"
    _other_names = {**dict.fromkeys(("eye", "position", "origin", "location"),
                                    "look_at(eye, target) places it, and to_world[:3, 3] is where it stands"),
                    **dict.fromkeys(("target", "direction", "up", "rotation"), "look_at(eye, target, up) places it")}

    def look_at(self, eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0, 1, 0)) -> None:
        """Places it at `eye`. `UsageError` where `target` is the same point, or straight above or
        below."""
        eye, target, up = (numpy.asarray(v, dtype=float) for v in (eye, target, up))
        forward = target - eye
        right = numpy.cross(up, forward)
        if not numpy.linalg.norm(right) > 1e-12 * numpy.linalg.norm(up) * numpy.linalg.norm(forward):
            raise UsageError(f"target is {target.tolist()}; expected a point apart from the eye, neither above nor below it")
        # A pbrt camera is left-handed; a mirrored one keeps its handedness
        hand = numpy.sign(numpy.linalg.det(self.to_world[:3, :3]))
        forward, right = forward / numpy.linalg.norm(forward), right / numpy.linalg.norm(right)
        matrix = numpy.eye(4)
        matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = hand * right, numpy.cross(forward, right), forward, eye
        self.place(matrix)


class Material(Part):
    """A material. `kind` is pbrt's name of its model. By its name one of glTF may be several: a metal,
    the rest, and their mixture by "amount". A value is then that of the first that has it, and is set
    in all that have it; `kind` is the first one's."""

    _kind = "material"
    _items = "reflectance"

    def __init__(self, description: _covtrace.SceneDescription, *indices: int) -> None:
        super().__init__(description, indices[0])
        self._indices = indices

    def _values(self) -> dict[str, float | tuple[float, float, float] | None]:
        values: dict[str, float | tuple[float, float, float] | None] = {}
        for i in self._indices:
            for name, value in self._description.values(self._kind, i).items():
                values.setdefault(name, value)
        return values

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        having = [i for i in self._indices if name in self._description.values(self._kind, i)]
        for i in having or [self._index]:  # the first tells that there is none
            self._description.set_value(self._kind, i, name, value)

    @property
    def name(self) -> str:
        return self._description.parts()["materials"][self._index][0]

    @property
    def kind(self) -> str:
        return self._description.parts()["materials"][self._index][1]

    def _title(self) -> str:
        kinds = [self._description.parts()["materials"][i][1] for i in self._indices]
        return f"material {self.name!r} ({', '.join(kinds)})"


class Light(Part, Placed):
    """A light that is no shape: "I" (radiant intensity) or "L" (radiance) by its kind."""

    _kind = "light"
    _items = "I"

    @property
    def kind(self) -> str:
        return self._description.parts()["lights"][self._index]

    def _title(self) -> str:
        return f"light ({self.kind})"


class AreaLight(Part):
    """The light of one or more shapes: "L", its radiance."""

    _kind = "area_light"
    _items = "L"


class Shape(Placed):
    """A shape, in the order of the file. `material` is the index of its material, -1 for none."""

    _kind = "shape"

    def __init__(self, description: _covtrace.SceneDescription, index: int) -> None:
        self._description, self._index = description, index

    @property
    def material(self) -> int:
        return self._description.material_of_shape(self._index)

    @material.setter
    def material(self, index: int) -> None:
        self._description.set_material(self._index, index)

    def __repr__(self) -> str:
        return f"<shape {self._index}, material {self.material}>"


class Instance(Placed):
    """An instance of an object."""

    _kind = "instance"

    def __init__(self, description: _covtrace.SceneDescription, index: int) -> None:
        self._description, self._index = description, index

    def __repr__(self) -> str:
        return f"<instance {self._index}>"


class Parts(Hinting, Sequence[Any]):
    """All parts of one kind; those with names are found by their names, too. `kind`: what messages
    call one of them. `joins`: whether `make` takes all indices of a name, or else the first."""

    _other_names = {**dict.fromkeys(("names", "keys", "items", "values"), "[part.name for part in scene.materials] has the names of materials"),
                    **dict.fromkeys(("append", "add", "remove", "insert"), "scene.remove_light(index) removes a light, a SceneBuilder makes scenes")}
    _ELSEWHERE = {"light": " of its own; `environment` and `light` of render take the place of what lights it instead"}

    def __init__(self, kind: str, make: Callable[..., Any], names: Sequence[str] | int, joins: bool = False) -> None:
        self._kind, self._make, self._joins = kind, make, joins
        self._names = [""] * names if isinstance(names, int) else list(names)

    def __len__(self) -> int:
        return len(self._names)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            if not key or key not in self._names:
                names = dict.fromkeys(n for n in self._names if n)
                known = f"the {self._kind}s are {', '.join(map(repr, names))}" if names else f"the {self._kind}s have no names"
                raise KeyError(f"there is no {self._kind} {key!r}; {known}")
            found = [i for i, name in enumerate(self._names) if name == key]
            return self._make(*(found if self._joins else found[:1]))
        if isinstance(key, slice):
            return [self._make(i) for i in range(*key.indices(len(self)))]
        try:
            index = range(len(self))[key]  # checks it, and counts from the end
        except IndexError:
            elsewhere = "" if self._names else self._ELSEWHERE.get(self._kind, "")
            raise IndexError(f"there is no {self._kind} {key}; the scene has {len(self) or 'none'}{elsewhere}") from None
        return self._make(index)

    def __repr__(self) -> str:
        names = ", ".join(repr(n) for n in dict.fromkeys(self._names) if n)
        return f"<{len(self)} {self._kind}{'' if len(self) == 1 else 's'}{names and ': '}{names}>"
