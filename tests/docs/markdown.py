"""Reading documents line by line: prose, code, tables, headings. No more of Markdown than our documents use."""

import re
from dataclasses import dataclass

FENCE = re.compile(r" *(```|~~~)")
ITEM = re.compile(r"( *)([-*+]|\d+[.)]) +")
HEADING = re.compile(r"#{1,6} ")


@dataclass
class Line:
    number: int  # from 1
    text: str
    kind: str  # "prose", "code", "fence", "table", "heading", "blank"
    language: str = ""  # of a fence and the code in it


def lines(text):
    """The lines of a document with their kinds. Code may be indented: it follows a blank line by four
    columns more than the item that it could belong to."""
    result, language, fenced, item_indent, after_blank, in_code = [], "", False, 0, True, False
    for number, line in enumerate(text.splitlines(), 1):
        indent = len(line) - len(line.lstrip(" "))
        item = ITEM.match(line)
        if FENCE.match(line):
            fenced = not fenced
            language = line.strip(" `~") if fenced else ""
            kind = "fence"
        elif fenced:
            kind = "code"
        elif not line.strip():
            kind = "blank"
        elif indent >= item_indent + 4 and (after_blank or in_code):
            kind = "code"
        elif HEADING.match(line):
            kind = "heading"
        elif line.lstrip().startswith("|"):
            kind = "table"
        else:
            kind = "prose"
        if kind == "prose" and item:
            item_indent = item.end()
        elif kind in ("heading", "prose", "table") and indent < item_indent and after_blank:
            item_indent = 0
        in_code = kind == "code" and not fenced or kind == "blank" and in_code
        after_blank = kind == "blank"
        result.append(Line(number, line, kind, language))
    return result


def blocks(text):
    """Blocks of code, each as (number of its first line, language, lines without their indent)."""
    result, block = [], None
    for line in lines(text):
        if line.kind == "code":
            if block is None:
                block = (line.number, line.language, [])
                result.append(block)
            block[2].append(line.text)
        elif line.kind == "blank" and block and not block[1]:
            block[2].append("")  # indented code goes on beyond it
        else:
            block = None
    return [(number, language, [l.strip() for l in code]) for number, language, code in result]


def prose(text):
    """The text without code, as one string; lines keep their places."""
    return "\n".join("" if line.kind in ("code", "fence") else line.text for line in lines(text))


def without_code_spans(text):
    return re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.DOTALL)


def code_spans(text):
    """Code in prose, as (number of its line, code in one line)."""
    plain = prose(text)
    return [(plain.count("\n", 0, m.start()) + 1, " ".join(m[2].split()))
            for m in re.finditer(r"(`+)(?!`)(.+?)(?<!`)\1(?!`)", plain, re.DOTALL)]


def links(text):
    """Targets of links and images, as (number of the line, target)."""
    plain = without_code_spans(prose(text))
    found = [(m.start(), m[1]) for m in re.finditer(r"\]\(([^()\s]+(?:\([^()]*\)[^()\s]*)*)\)", plain)]
    return [(plain.count("\n", 0, at) + 1, target) for at, target in found]


def anchors(text):
    """The anchors of headings as GitHub makes them."""
    result, seen = set(), {}
    for line in lines(text):
        if line.kind != "heading":
            continue
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", line.text.lstrip("#").strip())
        slug = re.sub(r"[^\w\- ]", "", title.lower().replace("`", "")).replace(" ", "-")
        count = seen.get(slug, 0)
        seen[slug] = count + 1
        result.add(slug if count == 0 else f"{slug}-{count}")
    return result
