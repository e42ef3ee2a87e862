"""Warnings that differ in a name alone, as one for all of them: files of others lack a hundred images at once."""

import re

_OF_ONE = re.compile(r"(material|object|lamp) '([^']*)'(.*)", re.DOTALL)
_IMAGE = re.compile(r"the image '([^']*)' has no pixels \(is its file '[^']*' missing\?\); it is magenta, as in Cycles")
_WITHOUT_VERB = re.compile(r"^(: | is | )")  # "objects 'a', 'b': grease pencil, which is not rendered"
MOST_NAMES = 3


def _named(names):
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(f"'{name}'" for name in names[:MOST_NAMES]) + more


def together(warnings):
    """The warnings in their order; those of the same words are where the first of them was."""
    groups = {}
    for text in warnings:
        image, one = _IMAGE.fullmatch(text), _OF_ONE.fullmatch(text)
        if image:
            key, name = ("image", ""), image[1]
        elif one:
            key, name = (one[1], one[3]), one[2]
        else:
            key, name = (None, text), None
        groups.setdefault(key, []).append((name, text))
    told = []
    for (kind, rest), members in groups.items():
        names = [name for name, _ in members]
        if len(members) == 1:
            told.append(members[0][1])
        elif kind == "image":
            told.append(f"{len(names)} images have no pixels (are their files missing?), which are magenta, as in Cycles: {_named(names)}")
        else:
            told.append(f"{kind}s {_named(names)}: {_WITHOUT_VERB.sub('', rest)}")
    return told
