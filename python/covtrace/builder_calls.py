"""The calls of a SceneBuilder behind the text that it writes, so that messages can name them."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from .errors import Error

_PACKAGE = os.path.dirname(__file__)
#: A message that begins with a place in a scene's file or a mesh, or that quotes the file's path.
_PLACE = re.compile(r"(?P<file>[^\n:]+?):(?:(?P<line>\d+):(?:\d+:)?)? ", re.DOTALL)


def describe_call(method: str, *arguments: object) -> str:
    """"script.py:12: SceneBuilder.material('red', 'diffuse')", of the innermost caller outside of
    this package."""
    frame = sys._getframe(1)
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == _PACKAGE:
        frame = frame.f_back
    given = ", ".join(repr(a) for a in arguments)
    return f"{frame.f_code.co_filename}:{frame.f_lineno}: SceneBuilder.{method}({given})"


class BuilderCalls:
    """The calls that a written scene comes from: those of its text's lines, and of its files."""

    def __init__(self) -> None:
        self.text = ""  #: the file of the scene's text
        self.lines: list[str | None] = []  #: the call of each line
        self.files: dict[str, str] = {}  #: the call of each mesh and texture, by the file's name

    def named(self, message: str) -> str:
        """The message with calls in place of places in the text or in a file that was written."""
        found = _PLACE.match(message)
        if not found:
            return message
        call, name = None, os.path.basename(found["file"])
        if found["line"] and name == os.path.basename(self.text):
            call = self._call_of_line(found["line"])
        elif name in self.files:
            call = self.files[name]
        elif name == os.path.basename(self.text):
            call = "SceneBuilder"
        if call is None:
            return message
        # Places that the message goes on to tell, as that of an earlier definition
        rest = re.sub(re.escape(self.text) + r":(\d+):\d+",
                      lambda place: self._call_of_line(place[1]) or place[0], message[found.end():])
        return f"{call}: {rest}"

    def _call_of_line(self, line: str) -> str | None:
        number = int(line)
        return self.lines[number - 1] if 0 < number <= len(self.lines) else None


@contextmanager
def name_errors(named: Callable[[str], str]) -> Iterator[None]:
    """Puts names into the messages of errors of the block."""
    try:
        yield
    except Error as error:
        message = named(str(error))
        if message == str(error):
            raise
        raise type(error)(message) from None
