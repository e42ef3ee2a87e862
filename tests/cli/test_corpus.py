"""The list of public scene files and the script that opens them: what it counts and when it fails."""

import csv
import json
import os
import pathlib
import subprocess
import sys

from support import PROGRAM, SANITIZED, SLOWER, TINY, CliTest

CORPUS = pathlib.Path(os.environ.get("COVTRACE_SOURCE", pathlib.Path(__file__).resolve().parents[2])) / "bench/corpus"
TRIANGLE = {
    "asset": {"version": "2.0"},
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "buffers": [{"uri": "points.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0]}],
}
FILES = {
    "plain.pbrt": TINY,
    "tube.pbrt": TINY + 'Shape "cylinder"\n',
    "unknown.pbrt": TINY + 'Shape "spehre"\n',
    "old.pbrt": TINY + 'Material "matte"\n',
    "smoke.pbrt": TINY + 'MakeNamedMedium "m" "string type" "nanovdb" "string filename" "old.nvdb"\n',
    "old.nvdb": b"NanoVDB0\x13" + bytes(7),
    "template.pbrt": TINY + 'MakeNamedMedium "m" "string type" "nanovdb" "string filename" [ "__NVDB_PATH__" ]\n',
    "part.pbrt": TINY + 'Include "missing.pbrt" # "comment.ply"\n',
    "pointer.pbrt": TINY + 'Shape "plymesh" "string filename" "large.ply"\n',
    "large.ply": "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n",
    "whole.gltf": json.dumps(TRIANGLE),
    "required.gltf": json.dumps({**TRIANGLE, "extensionsRequired": ["ACME_gizmo"]}),
    "points.bin": bytes(36),
    "folder/part.gltf": json.dumps(TRIANGLE),
    "faulty.gltf": json.dumps({**TRIANGLE, "nodes": [{"mesh": 7}]}),
}
EXPECTED = {
    "plain.pbrt": "native",
    "tube.pbrt": "replaced",
    "unknown.pbrt": "refused",
    "old.pbrt": "other version",
    "smoke.pbrt": "other version",
    "template.pbrt": "incomplete",
    "part.pbrt": "incomplete",
    "pointer.pbrt": "incomplete",
    "nowhere.pbrt": "not at hand",
    "whole.gltf": "native",
    "required.gltf": "needs an extension",
    "folder/part.gltf": "incomplete",
    "faulty.gltf": "invalid, refused",
}


class Corpus(CliTest):
    def open_all(self, names, *arguments):
        """Exit code, outcome by file, and what is said of bars."""
        for name, content in FILES.items():
            self.write(f"snapshots/someone/scenes/{name}", content)
        with open(self.folder / "files.csv", "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(("kind", "repository", "commit", "path", "faults"))
            for name in names:
                writer.writerow((pathlib.Path(name).suffix[1:], "someone/scenes", "0" * 40, name, int(name == "faulty.gltf")))
        memory = 2**20 if SANITIZED else 8
        done = subprocess.run(
            [sys.executable, CORPUS / "open_all", "--program", PROGRAM, "--files", "files.csv", "--snapshots", "snapshots",
             "--json", "found.json", "--memory", str(memory), *arguments],
            cwd=self.folder, capture_output=True, text=True, timeout=SLOWER * 60)
        found = {row["path"]: row for row in json.loads((self.folder / "found.json").read_text())}
        return done.returncode, found, done.stderr, done.stdout

    def test_what_becomes_of_files(self):
        code, found, errors, text = self.open_all(EXPECTED, "--bar", "pbrt=3,30", "--bar", "gltf=2,50", "--render")
        self.assertEqual(EXPECTED, {path: row["outcome"] for path, row in found.items()}, text)
        self.assertEqual(["ACME_gizmo"], found["required.gltf"]["reasons"])
        self.assertIn('shape "cylinder" is rendered as a mesh', found["tube.pbrt"]["reasons"][0])
        self.assertIn("no camera in the file", found["whole.gltf"]["told"])
        self.assertEqual((1, "pbrt: 1 refused; expected none but for extensions\n"), (code, errors))

    def test_bars(self):
        good = ["plain.pbrt", "tube.pbrt", "whole.gltf", "required.gltf", "faulty.gltf"]
        bars = ("--bar", "pbrt=2,50", "--bar", "gltf=2,50")
        self.assertEqual((0, ""), self.open_all(good, *bars)[::2])
        code, _, errors, _ = self.open_all(good, "--bar", "pbrt=3,50", "--bar", "gltf=2,51")
        self.assertEqual(1, code)
        self.assertIn("pbrt: 2 valid, complete files are at hand; expected 3\n", errors)
        self.assertIn("gltf: 50.0 % are native; expected 51 %\n", errors)

    def test_the_list_is_whole(self):
        with open(CORPUS / "files.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len({(row["repository"], row["path"]) for row in rows}))
        for row in rows:
            self.assertRegex(row["repository"], r"^[\w.-]+/[\w.-]+$")
            self.assertRegex(row["commit"], r"^[0-9a-f]{40}$")
            self.assertIn(row["kind"], ("pbrt", "gltf"))
        for kind, files, repositories in (("pbrt", 150, 8), ("gltf", 250, 8)):
            listed = [row for row in rows if row["kind"] == kind]
            self.assertGreaterEqual(len(listed), files)
            self.assertGreaterEqual(len({row["repository"] for row in listed}), repositories)
