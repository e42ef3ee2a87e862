#!/usr/bin/env python3
"""Writes the project's own scenes. Needs Python 3 and its standard library, nothing else.

    scenes/generate.py                   all scenes, into scenes/generated/NAME/scene.pbrt
    scenes/generate.py snooker motion    these scenes
    scenes/generate.py --check           writes them again elsewhere and compares
"""

import argparse
import hashlib
import os
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True

from generator import (  # noqa: E402
    bulbs,
    defocus_checker,
    foliage,
    glossy_lens,
    helicopter,
    mirror_motion,
    motion,
    shininess,
    snooker,
    snooker_frame,
    textured_plane,
)

_WRITERS = (
    snooker,
    snooker_frame,
    helicopter,
    defocus_checker,
    motion,
    mirror_motion,
    glossy_lens,
    bulbs,
    foliage,
    shininess,
    textured_plane.Lens,
    textured_plane.Moving,
)
_SCENES = {writer.NAME: writer for writer in _WRITERS}


def _write_scene(name, output):
    """Writes the scene beside its folder, then moves what changed into it, the scene file last.

    So another process that reads the scene, or writes it too, never meets a part of a file.
    """
    folder = output / name
    if folder.exists() and any(folder.iterdir()) and not (folder / "scene.pbrt").is_file():
        sys.exit(f"{folder}: is in the way, and is not a generated scene")
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=output, prefix=f".{name}-") as scratch:
        fresh = Path(scratch) / name
        fresh.mkdir()
        _SCENES[name].write(fresh)
        new, old = _hashes(fresh), _hashes(folder)
        for file in sorted(new, key=lambda file: (file == "scene.pbrt", file)):
            if new[file] != old.get(file):
                (folder / file).parent.mkdir(parents=True, exist_ok=True)
                os.replace(fresh / file, folder / file)
        for file in old.keys() - new.keys():
            (folder / file).unlink(missing_ok=True)


def _hashes(folder):
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in files
    }


def _differences(name, output):
    """Names of the scene's files that are missing, left over or different in `output`."""
    with tempfile.TemporaryDirectory() as scratch:
        _write_scene(name, Path(scratch))
        expected = _hashes(Path(scratch) / name)
    found = _hashes(output / name)
    return sorted(f"{name}/{file}" for file, _ in set(expected.items()) ^ set(found.items()))


def main():
    """Returns the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    default = Path(__file__).resolve().parent / "generated"
    parser.add_argument(
        "--output", type=Path, default=default, metavar="DIR", help="where to write"
    )
    parser.add_argument("--check", action="store_true", help="compare with what is in DIR")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of: {', '.join(_SCENES)}")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.names if name not in _SCENES]
    if unknown:
        parser.error(f"unknown scene {unknown[0]!r}; known: {', '.join(_SCENES)}")
    names = arguments.names or list(_SCENES)
    if not arguments.check:
        for name in names:
            _write_scene(name, arguments.output)
            print(arguments.output / name / "scene.pbrt")
        return 0
    different = sorted({file for name in names for file in _differences(name, arguments.output)})
    for file in different:
        print(f"differs: {file}", file=sys.stderr)
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
