"""Files under two names: a command that reads or writes one twice would lose it, and is refused, however the names
are spelled."""

import json
import os
import struct
import unittest

import exr
from films import textured_glb
from support import DONE, TINY, USAGE, CliTest

LONG = ["--spp", "1000000"]  # a render that nobody waits for: the error must come before it
LIBRARY = os.environ.get("COVTRACE_IGNORE_CASE", "")
PRELOAD = f"{os.environ.get('COVTRACE_PRELOAD', '')} {LIBRARY}"  # the address sanitizer wants to be loaded first
OUTPUTS = ("-o", "--png", "--stats", "--film", "--checkpoint")
TRIANGLE = """\
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""


class Spellings(CliTest):
    """Spellings of one name, in two outputs."""

    def assert_refused(self, first, second, name, spelled):
        result = self.render(TINY, *LONG, first, name, second, spelled, output=None, timeout=10)
        self.assert_fails(result, USAGE, f"'{spelled}' is the file of", second.lstrip("-"))

    def test_of_a_file_that_is_not_there_yet(self):
        (self.folder / "sub").mkdir()
        (self.folder / "linked").symlink_to("sub")
        (self.folder / "link").symlink_to("sub/out.exr")
        for name, spelled in (
            ("out.exr", "out.exr"),
            ("out.exr", "./out.exr"),
            ("out.exr", self.folder / "out.exr"),
            ("out.exr", "sub/../out.exr"),
            (self.folder / "out.exr", ".//out.exr"),
            ("sub/out.exr", "linked/out.exr"),
            ("sub/out.exr", "link"),
            ("link", self.folder / "linked/out.exr"),
        ):
            for option in ("--stats", "--film", "--checkpoint"):
                with self.subTest(name=name, spelled=spelled, option=option):
                    self.assert_refused("-o", option, name, spelled)
                    self.assertFalse((self.folder / name).exists())

    def test_of_a_file_that_is_there(self):
        self.write("out.exr", "old")
        (self.folder / "hard.exr").hardlink_to(self.folder / "out.exr")
        (self.folder / "soft.exr").symlink_to("out.exr")
        for spelled in ("./out.exr", self.folder / "out.exr", "hard.exr", "soft.exr"):
            with self.subTest(spelled=spelled):
                self.assert_refused("-o", "--film", "out.exr", spelled)
                self.assertEqual((self.folder / "out.exr").read_text(), "old")

    def test_every_pair(self):
        for i, first in enumerate(OUTPUTS):
            for second in OUTPUTS[:i]:
                if {first, second} == {"--film", "--checkpoint"}:
                    continue
                with self.subTest(first=first, second=second):
                    name = "both.png" if "--png" in (first, second) else "both"
                    self.assert_fails(
                        self.render(TINY, *LONG, first, name, second, f"./{name}", output=None, timeout=10),
                        USAGE, name, "already",
                    )

    def test_names_that_differ_pass(self):
        self.rendered("--png", "out.png", "--stats", "out.json", "--film", "out.film", "--checkpoint", "out.check")
        exr.read(self.folder / "out.exr")
        self.assertEqual(self.render(TINY, "--stats", "/dev/null", output="/dev/null").code, DONE)

    def test_the_final_film_may_be_the_checkpoint(self):
        self.rendered("--spp", "1", "--film", "a.film", "--checkpoint", "./a.film")
        self.assertFalse((self.folder / "a.film.prev").exists(), "it was written twice")

    def test_the_earlier_film(self):
        """A film that is replaced lives on under another name, which is taken, too."""
        for arguments in (["--stats", "a.film.prev", "--film", "a.film"], ["--film", "a.film.prev", "--checkpoint", "a.film"]):
            with self.subTest(arguments=arguments):
                self.assert_fails(self.render(TINY, *LONG, *arguments, timeout=10), USAGE, "a.film.prev")


@unittest.skipUnless(os.path.exists(LIBRARY), "the library that ignores case is not built")
class Capitals(CliTest):
    def render_to(self, folder, *arguments, **options):
        (self.folder / folder).mkdir(exist_ok=True)
        return self.render(
            TINY, *arguments, output=f"{folder}/out.exr", before=lambda: os.environ.update({"LD_PRELOAD": PRELOAD}), **options
        )

    def test_where_the_file_system_ignores_them(self):
        for folder in ("folding", self.folder / "folding"):
            for there in (False, True):
                with self.subTest(folder=folder, there=there):
                    if there:
                        self.write("folding/out.exr", "old")
                    result = self.render_to("folding", *LONG, "--film", f"{folder}/OUT.exr", timeout=10)
                    self.assert_fails(result, USAGE, "OUT.exr", "--output already")
                    self.assertEqual([p.name for p in (self.folder / "folding").iterdir()], ["out.exr"] if there else [])
                    (self.folder / "folding/out.exr").unlink(missing_ok=True)

    def test_elsewhere_they_make_two_names(self):
        result = self.render_to("other", "--spp", "1", "--film", "other/OUT.exr")
        self.assertEqual(result.code, DONE, result)
        self.assertEqual({p.name for p in (self.folder / "other").iterdir()}, {"out.exr", "OUT.exr"})


class WhatTheSceneReads(CliTest):
    def assert_protected(self, scene, targets):
        self.write("scene.pbrt" if isinstance(scene, str) else "scene.gltf", scene if isinstance(scene, str) else json.dumps(scene))
        name = "scene.pbrt" if isinstance(scene, str) else "scene.gltf"
        for target in targets:
            before = (self.folder / target).read_bytes()
            for option in OUTPUTS:
                with self.subTest(target=target, option=option):
                    # The link has the ending of the option: an ending that is refused by itself
                    # would prove nothing.
                    spelled = self.folder / ("link.png" if option == "--png" else "link")
                    spelled.symlink_to(target)
                    result = self.run_program("render", name, *LONG, "--quiet", option, spelled, timeout=10)
                    self.assert_fails(result, USAGE, target.rpartition("/")[2], "which is read")
                    self.assertEqual((self.folder / target).read_bytes(), before)
                    spelled.unlink()
            self.assertFalse((self.folder / (target + ".prev")).exists())

    def test_the_scene(self):
        self.assert_protected(TINY, ["scene.pbrt"])

    def test_its_text_and_numbers(self):
        self.write("m.ply", TRIANGLE)
        self.write("parts/part.pbrt", 'Include "deep.pbrt"\n')
        self.write("deep.pbrt", "# nothing\n")
        self.write("eta.spd", "400 1.5\n700 1.5\n")
        self.write("lens.dat", "50 5 1.5 20\n0 5 0 10\n-50 0 0 20\n")
        scene = TINY.replace('Camera "perspective" "float fov" 40', 'Camera "realistic" "string lensfile" "lens.dat"')
        self.assertNotEqual(scene, TINY)
        scene += 'Include "parts/part.pbrt"\nShape "plymesh" "string filename" "m.ply"\nMaterial "conductor" "spectrum eta" "eta.spd"\n'
        self.assert_protected(scene, ["m.ply", "parts/part.pbrt", "deep.pbrt", "eta.spd", "lens.dat"])

    def test_its_images(self):
        for name in ("wood.exr", "sky.exr"):
            self.rendered("--resolution", "8x8", "--spp", "1", output=name)
        scene = TINY + 'LightSource "infinite" "string filename" "sky.exr"\n'
        scene += 'Texture "t" "spectrum" "imagemap" "string filename" "wood.exr"\n'
        self.assert_protected(scene, ["wood.exr", "sky.exr"])

    def test_a_name_of_the_film(self):
        self.rendered("--resolution", "8x8", output="film.exr")
        before = (self.folder / "film.exr").read_bytes()
        sky = TINY.replace("WorldBegin", 'WorldBegin LightSource "infinite" "string filename" "film.exr"', 1)
        self.assert_fails(self.render(sky, output=None), USAGE, "film.exr")
        self.assertEqual((self.folder / "film.exr").read_bytes(), before)

    def test_buffers_and_images_of_gltf(self):
        self.rendered("--png", "wood.png", "--resolution", "8x8", "--spp", "1")
        glb = textured_glb((self.folder / "wood.png").read_bytes())
        length = struct.unpack_from("<I", glb, 12)[0]
        scene, binary = json.loads(glb[20 : 20 + length]), glb[28 + length :]
        self.write("data.bin", binary)
        scene["buffers"][0]["uri"] = "data.bin"
        scene["images"] = [{"uri": "wood.png"}]
        self.assert_protected(scene, ["scene.gltf", "data.bin", "wood.png"])


class OtherCommands(CliTest):
    def test_merge(self):
        for k in (1, 2):
            self.render(TINY, "--method", "uniform", "--spp", "2", "--shard", f"{k}/2", "--film", f"p{k}.film", output=None)
        before = (self.folder / "p1.film").read_bytes()
        for arguments in (
            ["-o", "link"], ["--png", "link.png"], ["--film", "./p1.film"], ["--film", "new.film", "-o", "./new.film.prev/../new.film"],
            ["-o", "a.exr", "--png", "x/../a.exr"],
        ):
            for name in ("link", "link.png"):
                (self.folder / name).unlink(missing_ok=True)
                (self.folder / name).symlink_to("p1.film")
            with self.subTest(arguments=arguments):
                self.assert_fails(self.run_program("merge", "p1.film", "p2.film", *arguments), USAGE)
                self.assertEqual((self.folder / "p1.film").read_bytes(), before)
        # The earlier film of the new one is an input of the merge.
        os.rename(self.folder / "p1.film", self.folder / "p2.film.prev")
        self.assert_fails(self.run_program("merge", "p2.film", "p2.film.prev", "--film", "p2.film"), USAGE, "p2.film")
        result = self.run_program("merge", "p2.film", "p2.film.prev", "--film", "all.film", "-o", "all.exr")
        self.assertEqual(result.code, DONE, result)

    def test_reports(self):
        image = self.rendered("--spp", "1").read_bytes()
        self.write("other.exr", image)
        (self.folder / "hard.html").hardlink_to(self.folder / "out.exr")
        for command in (["compare", "out.exr", "other.exr"], ["compare", "other.exr", "out.exr"], ["inspect", "out.exr"]):
            for report in (self.folder / "out.exr", "./out.exr", "hard.html"):
                with self.subTest(command=command, report=report):
                    self.assert_fails(self.run_program(*command, "--report", report), USAGE, "which is read")
                    self.assertEqual((self.folder / "out.exr").read_bytes(), image)


if __name__ == "__main__":
    unittest.main()
