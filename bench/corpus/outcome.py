"""Outcomes of opening a scene file: native, with something replaced, refused, not counted."""
import re

NATIVE, REPLACED = "native", "replaced"
REFUSED_EXTENSION, REFUSED = "needs an extension", "refused"
INVALID_OPENED, INVALID_REFUSED = "invalid, opened", "invalid, refused"
INCOMPLETE, OTHER_VERSION, NOT_AT_HAND = "incomplete", "other version", "not at hand"
COUNTED = (NATIVE, REPLACED, REFUSED_EXTENSION, REFUSED)
ALL = (*COUNTED, INVALID_OPENED, INVALID_REFUSED, INCOMPLETE, OTHER_VERSION, NOT_AT_HAND)

# Warnings after which the picture is still the one that the file describes, by a part of their text: what the file
# leaves open, what it says twice or in vain, what pbrt-v4 and glTF viewers do alike, and ways to the same image.
# Every other warning counts as a replacement.
NOTHING_REPLACED = {
    "no camera in the file": ("the scene has no camera", "no Camera"),
    "no light in the file": ("the scene has no lights", "walls keep the sky"),
    "nothing in the file to be seen": ("the scene has no shapes",),
    "an animation, shown at one moment": ("the scene is rendered at rest",),
    "several cameras, the first is taken": (" cameras is used",),
    "several animations or variants, told with how to choose": ("animations is played", "the primitives' own materials are rendered"),
    "light in physical units": ("candela and lux are divided",),
    "nodes listed as roots that are none": ("are no roots", "is no root", "beside its parent", "beside their parents"),
    "values of the file that mean nothing": (
        "is not known to", "is given twice", "without AttributeBegin", "is not a multiple of", "has another number of values",
        "moves the same property", "has no faces", "has no shape", "reach beyond the image", "the latter counts",
        "the compressed mesh has", "expected a number", "a scale of zero hides", "has textures but no TEXCOORD",
        "normals that are not finite"),
    "points and lines, drawn": ("points are shown as", "lines are shown as"),
    "as in pbrt-v4 and viewers": ("as in pbrt", "is cut to 1", "cut to 1"),
    "another way to the same image": ("path tracing takes its place", "is ignored: accelerator", "accelerator"),
    "files outside of the scene's folder": ("outside of the scene's folder",),
    "the image in linear Rec.709": ("written in linear Rec.709",),
    "options of pbrt's own measurements": ('option "seed"', 'option "msereference'),
}
# Integrators whose image is another one than that of path tracing.
OTHER_IMAGES = re.compile(r'integrator "(?:ambientocclusion|function|randomwalk)" is not supported')

EXTENSION = re.compile(r"can't be read without the extensions? (.+?), which (?:is|are) not supported")
OTHER_VERSIONS = re.compile(r"belongs to pbrt-v3|glTF \"[^\"]*\" is not supported|binary glTF of version|this is no glTF 2\.0"
                            r"|it is of version [\d.]+ of the format")
PLACE = re.compile(r"^.*?\.(?:pbrt|gltf|glb|vrm|ply)(?: \(JSON chunk\))?(?::\d+)*: (?:[\w.\[\]]+: )?", re.IGNORECASE)
NAMED = re.compile(r'\b(medium|option) "[^"]*"')
COUNT = re.compile(r" \(and in \d+ more places?\)$")


def kind_of(warning):
    """The group of a warning that replaces nothing, else None."""
    if OTHER_IMAGES.search(warning):
        return None
    return next((kind for kind, parts in NOTHING_REPLACED.items() if any(part in warning for part in parts)), None)


def text_of(message):
    """A message without its place, with N for numbers and without names that differ from file to file."""
    text = NAMED.sub(r"\1", COUNT.sub("", PLACE.sub("", message.removeprefix("covtrace: ").strip())))
    return re.sub(r"(?<![\w.-])\d+(?:\.\d+)?(?![\w.])", "N", text)


def outcome(exit_code, errors, warnings):
    """The outcome of a file and its reasons, by the exit code, error message and warnings of the program.

    The reasons of a replacement are its warnings; those of a refusal the message or the extensions.
    """
    if exit_code == 0:
        replaced = sorted({text_of(w) for w in warnings if kind_of(w) is None})
        return (REPLACED, replaced) if replaced else (NATIVE, [])
    if match := EXTENSION.search(errors):
        return REFUSED_EXTENSION, match[1].split(", ")
    if OTHER_VERSIONS.search(errors):
        return OTHER_VERSION, []
    return REFUSED, [text_of(errors) or f"exit code {exit_code}"]


def of_invalid(found):
    """The outcome of a file that breaks the rules of its format, which no bar counts."""
    if found not in COUNTED:
        return found
    return INVALID_OPENED if found in (NATIVE, REPLACED) else INVALID_REFUSED
