#!/usr/bin/env python3
"""Wraps the prose of documents at 100 columns; tables, code and headings stay as they are.

    tests/docs/wrap_prose.py FILE.md ..."""

import pathlib
import re
import sys

import markdown

WIDTH = 100
LONGEST_CODE = 70  # that is not broken
# Words that would begin a list, a quotation, a heading or a table at the start of a line.
BEGINS_A_BLOCK = re.compile(r"([-*+]|\d+[.)]|#+|>.*|\|.*)$")


def words(text):
    """Words, with code of up to LONGEST_CODE columns in one piece."""
    pieces, glued = [], False
    for piece in re.findall(r"`[^`]*`|[^\s`]+|`|\s+", text):
        if piece.isspace():
            glued = False
            continue
        parts = piece.split(" ") if len(piece) > LONGEST_CODE else [piece]
        if glued:
            pieces[-1] += parts.pop(0)
        pieces += parts
        glued = True
    return pieces


def tokens(text):
    """Words that are kept together: a word that would begin a block stays with the word before it."""
    kept = []
    for word in words(" ".join(text.split())):
        if kept and BEGINS_A_BLOCK.match(word):
            kept[-1] += " " + word
        else:
            kept.append(word)
    return kept


def wrapped(paragraph):
    """The lines of one paragraph or item. A picture is one line."""
    if paragraph[0].startswith("!["):
        return [" ".join(paragraph)]
    item = markdown.ITEM.match(paragraph[0])
    indent = len(paragraph[0]) - len(paragraph[0].lstrip(" "))
    first, rest = (item[0], " " * item.end()) if item else (" " * indent, " " * indent)
    result, line = [], first
    for token in tokens(" ".join([paragraph[0][len(first):], *paragraph[1:]])):
        if line.strip() and line not in (first, rest) and len(line) + 1 + len(token) > WIDTH:
            result.append(line)
            line = rest
        line += ("" if line in (first, rest) else " ") + token
    return result + [line]


def wrap(text):
    result, paragraph = [], []

    def end():
        if paragraph:
            result.extend(wrapped(paragraph))
            paragraph.clear()

    for line in markdown.lines(text):
        if line.kind != "prose":
            end()
            result.append(line.text)
            continue
        if markdown.ITEM.match(line.text) or line.text.startswith("!["):
            end()
        paragraph.append(line.text)
        if line.text.endswith("  ") or paragraph[0].startswith("![") and line.text.endswith(")"):
            end()
    end()
    return "\n".join(result) + "\n"


def main():
    for name in sys.argv[1:]:
        file = pathlib.Path(name)
        file.write_text(wrap(file.read_text()))


if __name__ == "__main__":
    main()
