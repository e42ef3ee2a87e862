"""Which files a scene file asks for, found without the renderer: whether a copy of a repository is complete."""
import gzip
import json
import os
import re
import struct
import urllib.parse

LARGE_FILE_POINTER = b"version https://git-lfs"  # a Git repository has this text in place of a file that lies elsewhere

# Strings of a pbrt file that name a file, by their ending; the name of the film is one that a render writes.
PBRT_FILE = re.compile(
    rb'"([^"\n]+\.(?:pbrt|ply|exr|png|jpe?g|tga|hdr|pfm|pgm|ppm|qoi|webp|bmp|tiff?|spd|dat|bsdf|nvdb|ptx|ptex|csv|txt)'
    rb'(?:\.gz)?)"', re.IGNORECASE)
# Templates have words like __FILE__ where a script puts a file's name.
PLACEHOLDER = re.compile(rb'"string \w+"\s*\[?\s*"(__\w+__)"')
VALUE = rb'(?:\[[^\]]*\]|"[^"\n]*"|[-+.\deE]+|true|false)'
FILM = re.compile(rb'\bFilm\s+"[^"\n]*"(?:\s*"[^"\n]*"\s*' + VALUE + rb")*")
COMMENT = re.compile(rb'"[^"\n]*"|#[^\n\r]*')
INCLUDED = re.compile(rb'\b(?:Include|Import)\s+"([^"\n]+)"')

JSON_CHUNK = 0x4E4F534A


class Unreadable(Exception):
    """The file is none of its kind."""


def without_comments(text):
    return COMMENT.sub(lambda match: match[0] if match[0].startswith(b'"') else b"", text)


def content(path):
    with open(path, "rb") as file:
        data = file.read()
    try:
        return gzip.decompress(data) if data.startswith(b"\x1f\x8b") else data
    except (OSError, EOFError) as error:
        raise Unreadable(f"{path.name}: {error}") from error


def is_at_hand(path):
    """Whether the file is there, with its bytes."""
    if not path.is_file():
        return False
    with open(path, "rb") as file:
        return not file.read(len(LARGE_FILE_POINTER)) == LARGE_FILE_POINTER


def pbrt_text(path):
    """A pbrt file without comments and film."""
    return FILM.sub(b"", without_comments(content(path)))


def missing_of_pbrt(path):
    """Names that a pbrt file or what it includes asks for and that are not there, beside the first file."""
    missing, seen, waiting = [], set(), [path]
    while waiting:
        text = pbrt_text(waiting.pop())
        included = set(INCLUDED.findall(text))
        for name in {match[1] for match in PBRT_FILE.finditer(text)} | included | set(PLACEHOLDER.findall(text)):
            file = path.parent / os.fsdecode(name)
            if file in seen:
                continue
            seen.add(file)
            if not is_at_hand(file):
                missing.append(os.fsdecode(name))
            elif name in included:
                waiting.append(file)
    return missing


def gltf_document(path):
    """The JSON of a .gltf or binary file."""
    data = path.read_bytes()
    try:
        if data[:4] == b"glTF":
            length, kind = struct.unpack_from("<II", data, 12)
            if kind != JSON_CHUNK:
                raise Unreadable("no JSON chunk")
            data = data[20:20 + length]
        return json.loads(data.decode("utf-8-sig"))
    except (ValueError, struct.error) as error:
        raise Unreadable(str(error)) from error


def missing_of_gltf(path):
    """Names that a glTF file asks for and that are not there, or are shorter than it says."""
    document = gltf_document(path)
    missing = []
    for kind in ("buffers", "images"):
        for entry in document.get(kind, []):
            name = entry.get("uri", "")
            if not name or name.startswith("data:"):
                continue
            file = path.parent / urllib.parse.unquote(name)
            if not is_at_hand(file) or file.stat().st_size < (entry.get("byteLength", 0) if kind == "buffers" else 1):
                missing.append(name)
    return missing


def missing_files(kind, path):
    """Names of files that the scene file at `path` of the kind "pbrt" or "gltf" needs and that are not at hand."""
    return missing_of_pbrt(path) if kind == "pbrt" else missing_of_gltf(path)
