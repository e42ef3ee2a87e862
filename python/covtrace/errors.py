"""Exceptions, by the kinds of the command line's exit codes."""

from __future__ import annotations

import re

_WHERE = re.compile(r"(?P<file>[^\n]+?):(?P<line>\d+):(?:(?P<column>\d+):)? (?P<text>.*)", re.DOTALL)


class Error(RuntimeError):
    """Base of all errors of covtrace.

    file, line, column: the place in the scene's files, None where there is none; counted from 1.
    message: what is wrong and what was expected, without the place.
    """

    exit_code = 7

    file: str | None
    line: int | None
    column: int | None
    message: str

    def __init__(self, text: str) -> None:
        super().__init__(text)
        found = _WHERE.match(text)
        self.file = found["file"] if found else None
        self.line = int(found["line"]) if found else None
        self.column = int(found["column"]) if found and found["column"] else None
        self.message = found["text"] if found else text


class UsageError(Error, ValueError):
    """An argument is wrong (exit code 2)."""

    exit_code = 2


class SceneError(Error):
    """The scene or an input that it names is wrong or missing (exit code 3)."""

    exit_code = 3


class LimitError(Error, MemoryError):
    """A limit of memory or size was reached (exit code 4)."""

    exit_code = 4


class FileError(Error, OSError):
    """Reading or writing failed in the middle (exit code 5)."""

    exit_code = 5


class Interrupted(Error):
    """The work was ended before its end (exit code 6)."""

    exit_code = 6


class InternalError(Error):
    """A defect of covtrace (exit code 7)."""


class SceneWarning(UserWarning):
    """A warning: something in a scene is ignored or replaced."""
