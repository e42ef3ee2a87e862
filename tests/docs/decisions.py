#!/usr/bin/env python3
"""The index of the decisions: docs/decisions/README.md, made from the records themselves.

    tests/docs/decisions.py          prints it
    tests/docs/decisions.py --write  writes it"""

import pathlib
import re
import sys

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs/decisions"
STATUS = re.compile(r"Status: ((in force|living|superseded by|folded into)\b.*)\. Area: ([\w ]+)\.")
HEAD = """# Decisions

One record for each choice between real alternatives: what was asked, what was decided, what was
measured, what was tried and left out. Records that are *living* say what holds now of a chain of
records that are folded into them; those, and the ones that a later one superseded, are in the
[archive](archive), as they were. Figures in records are of the program of their day; the newest
ones are in the [results](../results/README.md). Which thesis is meant stands in the
[glossary](../internals/glossary.md#whose).

A new record gets the next number and this form:

    # NNNN: What was decided

    Status: in force. Area: one or two words.

    ## Question
    ## Decision
    ## Evidence
    ## Alternatives
    ## What is left

The first two sections always, others where there is something to say.
`tests/docs/decisions.py --write` makes this index, `tests/docs/wrap_prose.py` wraps the text.
"""


class Record:
    def __init__(self, file):
        self.file = file
        text = file.read_text()
        self.sections = re.findall(r"(?m)^## (.+)$", text)
        paragraphs = [" ".join(paragraph.split("\n")) for paragraph in text.split("\n\n", 2)[:2]]
        title = re.fullmatch(r"# (\d{4}): (.+)", paragraphs[0])
        status = STATUS.fullmatch(paragraphs[-1])
        self.number, self.title = title.groups() if title else (None, None)
        self.status, self.area = (status[1], status[3]) if status else (None, None)
        self.archived = file.parent.name == "archive"

    def later(self):
        """The records that took this record's place, as links of the index."""
        return [f"[{number}]({found.relative_to(FOLDER)})" for number in re.findall(r"\[(\d{4})\]", self.status)
                for found in FOLDER.rglob(f"{number}-*.md")]

    def kind(self):
        words = re.sub(r"\[|\]\([^)]*\)", "", self.status)
        return re.sub(r":? ?(superseded by|folded into) [\d, ]+$", "", words) or re.match(r"superseded|folded", words)[0]


def records():
    return sorted((Record(file) for file in FOLDER.rglob("[0-9]*.md")), key=lambda record: record.file.name)


def index():
    rows = ["| number | decision | status | superseded by | area |", "| --- | --- | --- | --- | --- |"]
    for record in records():
        link = record.file.relative_to(FOLDER)
        rows.append(f"| [{record.number}]({link}) | {record.title} | {record.kind()} | {', '.join(record.later())} | {record.area} |")
    return HEAD + "\n" + "\n".join(rows) + "\n"


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        (FOLDER / "README.md").write_text(index())
    else:
        print(index(), end="")
