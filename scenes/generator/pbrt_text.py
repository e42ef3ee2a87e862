"""Text of a pbrt-v4 scene file, directive by directive."""

from contextlib import contextmanager
from pathlib import Path


def number(value):
    """Shortest text that keeps seven digits, which is what a 32-bit float holds."""
    text = f"{value:.7g}"
    return "0" if text == "-0" else text


def _values(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, (list, tuple)):
        return "[ " + " ".join(_values(item) for item in value) + " ]"
    return number(value)


class SceneText:
    """Collects the directives of one scene; `parameters` map "type name" to values."""

    def __init__(self, header):
        self._lines = [f"# {line}".rstrip() for line in header.strip().splitlines()]
        self._indent = ""

    def comment(self, text):
        """Adds an empty line and a comment."""
        self._lines += ["", f"{self._indent}# {text}"]

    def plain(self, directive, *numbers):
        """Adds a directive that takes bare numbers or words: Translate, Rotate, WorldBegin."""
        words = [item if isinstance(item, str) else number(item) for item in numbers]
        self._lines.append(self._indent + " ".join([directive, *words]))

    def entity(self, directive, names, parameters=None):
        """Adds a directive with quoted names (a string or several) and a parameter list."""
        names = [names] if isinstance(names, str) else names
        line = " ".join([directive] + [f'"{name}"' for name in names])
        self._lines.append(self._indent + line)
        for key, value in (parameters or {}).items():
            self._lines.append(f'{self._indent}    "{key}" {_values(value)}')

    @contextmanager
    def attributes(self):
        """AttributeBegin ... AttributeEnd around what is added inside."""
        self.plain("AttributeBegin")
        self._indent += "    "
        yield
        self._indent = self._indent[:-4]
        self.plain("AttributeEnd")

    def moving(self, start, end):
        """A transform given at the two ends of the shutter.

        `start` and `end` are lists of (directive, numbers...) tuples.
        """
        for name, steps in (("StartTime", start), ("EndTime", end)):
            self.plain("ActiveTransform", name)
            for step in steps:
                self.plain(*step)
        self.plain("ActiveTransform", "All")

    def write(self, path):
        """Writes the file with a final line end."""
        Path(path).write_text("\n".join(self._lines) + "\n", encoding="ascii")
