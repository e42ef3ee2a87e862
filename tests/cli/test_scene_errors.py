"""Scenes that are wrong: exit code 3, and one line with the place and what is wrong."""

import gzip
import os
import struct
import unittest

from support import DONE, HEADER, LIMIT, SANITIZED, SCENE, TINY, WORLD, CliTest, limits, place_of

TRIANGLE = [(-1, 0, 0), (1, 0, 0), (0, 1, 0)]


def binary_ply(vertices=TRIANGLE, faces=((0, 1, 2),), count=None):
    count = len(vertices) if count is None else count
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    body = b"".join(struct.pack("<3f", *v) for v in vertices)
    body += b"".join(struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces)
    return header.encode() + body


class SceneErrorTest(CliTest):
    def assert_scene_fails_at(self, scene, at, *fragments):
        """Asserts an error at the first place of the text `at`."""
        self.assert_fails_at(self.render(scene), place_of(scene, at), *fragments)
        self.assert_no_file()


class Text(SceneErrorTest):
    def test_missing_scene(self):
        result = self.run_program("render", "nowhere/missing.pbrt")
        self.assert_fails(result, SCENE, "nowhere/missing.pbrt")

    def test_scene_is_a_folder(self):
        self.assert_fails(self.run_program("render", self.folder), SCENE, str(self.folder))

    def test_files_that_are_no_scene(self):
        everything = bytes(range(256)) * 16
        for name, content in {
            "empty": b"",
            "blank": b" \n\t\n",
            "comment": b"# nothing but a comment\n",
            "zeros": bytes(4096),
            "bytes": everything,
            "png": b"\x89PNG\r\n\x1a\n" + everything,
            "exr": b"\x76\x2f\x31\x01" + everything,
            "utf-16": TINY.encode("utf-16"),
            "one long line": b"a" * 1_000_000,
            "deep": b"[" * 100_000,
        }.items():
            with self.subTest(content=name):
                self.assert_fails(self.render(content), SCENE, "scene.pbrt:")
                self.assert_no_file()

    def test_compressed_scene(self):
        good = gzip.compress(TINY.encode())
        self.write("good.pbrt.gz", good)
        done = self.run_program("render", "good.pbrt.gz", "-o", "out.exr", "--quiet")
        self.assertEqual((done.code, done.stderr), (DONE, ""))
        self.write("short.pbrt.gz", good[: len(good) // 2])
        self.assert_fails(self.run_program("render", "short.pbrt.gz"), SCENE, "short.pbrt.gz")

    def test_unknown_names(self):
        for line, at, fragments in [
            ("Frobnicate 1 2 3", "Frobnicate", ["Frobnicate"]),
            ("AtributeBegin", "AtributeBegin", ["AttributeBegin"]),  # the suggestion
            ('Shape "shpere"', 'Shape "shpere"', ["shpere", "sphere"]),
            ('Material "velvet"', "Material \"velvet\"", ["velvet"]),
            ('LightSource "glow"', 'LightSource "glow"', ["glow"]),
            ('AreaLightSource "glow"', 'AreaLightSource "glow"', ["glow"]),
            ('Texture "t" "spectrum" "plaid"', 'Texture "t"', ["plaid"]),
            ('MakeNamedMedium "m" "string type" "fog"', '"string type"', ["fog"]),
            ('ColorSpace "cmyk"', "ColorSpace", ["cmyk"]),
            ("WorldEnd", "WorldEnd", ["pbrt-v3"]),
            ('Material "matte"', 'Material "matte"', ["pbrt-v3"]),
        ]:
            with self.subTest(line=line):
                self.assert_scene_fails_at(TINY + line + "\n", at, *fragments)

    def test_unknown_names_before_the_world(self):
        for line, fragment in [
            ('Camera "fisheye"', "fisheye"),
            ('Film "canvas"', "canvas"),
            ('Sampler "dice"', "dice"),
            ('Integrator "oracle"', "oracle"),
            ('PixelFilter "sharp"', "sharp"),
        ]:
            with self.subTest(line=line):
                self.assert_scene_fails_at(line + "\nWorldBegin\n", line, fragment)

    def test_undefined_references(self):
        for line, at, fragment in [
            ('NamedMaterial "gold"', "NamedMaterial", "gold"),
            ('ObjectInstance "tree"', "ObjectInstance", "tree"),
            ('CoordSysTransform "there"', "CoordSysTransform", "there"),
            ('Material "diffuse" "texture reflectance" "wood"', '"texture reflectance"', "wood"),
            ('Material "conductor" "texture roughness" "rust"', '"texture roughness"', "rust"),
        ]:
            with self.subTest(line=line):
                self.assert_scene_fails_at(TINY + line + '\nShape "sphere"\n', at, fragment)

    def test_wrong_tokens(self):
        for line, at in [
            ("Translate 1 two 3", "two"),
            ("Translate 1 2 nan", "nan"),
            ("Scale 1 inf 1", "inf"),
            ("Shape sphere", "sphere\n"),
            ('"sphere"', '"sphere"\n'),
            ('Shape "sphere" "float radius" "wide"', '"wide"'),
            ('Shape "sphere" "float radius" [1 nan]', "nan"),
            ('Shape "sphere" "float radius" true', "true"),
            ('Shape "sphere" "radius" 1', '"radius" 1'),
            ('Shape "sphere" "flaot radius" 1', '"flaot radius"'),
            ("]", "]\n"),
            ("Transform [1 0 0 0]", "]\n"),
        ]:
            with self.subTest(line=line):
                scene = HEADER + "WorldBegin\n" + line + "\n"
                self.assert_scene_fails_at(scene, at)

    def test_text_that_ends_too_early(self):
        for tail in ('Shape "sph', "Shape", 'Shape "sphere" "float radius"', 'Shape "sphere" "float radius" [1', "Translate 1"):
            with self.subTest(tail=tail):
                result = self.render(TINY + tail)
                self.assert_fails(result, SCENE)
                self.assertRegex(result.stderr, r"^covtrace: scene\.pbrt:\d+:\d+: ")

    def test_structure(self):
        before = HEADER + "WorldBegin\nReverseOrientation\n"
        here = f"scene.pbrt:{before.count(chr(10)) + 1}:1"
        for tail in ("AttributeBegin", 'ObjectBegin "o"', "ObjectEnd", "WorldBegin", 'Camera "perspective"'):
            with self.subTest(tail=tail):
                self.assert_fails_at(self.render(before + tail), here, tail.split()[0])
        self.assert_fails(self.render(HEADER), SCENE, "WorldBegin")

    def test_degenerate_transforms(self):
        for line in (
            "Scale 1 0 1",
            "Rotate 90 0 0 0",
            "LookAt 0 0 0  0 0 0  0 1 0",
            "LookAt 0 0 0  0 1 0  0 2 0",
            "Transform [1 0 0 0  0 1 0 0  0 0 0 0  0 0 0 1]",
            "ConcatTransform [1 2 3 0  2 4 6 0  0 0 1 0  0 0 0 1]",
        ):
            with self.subTest(line=line):
                self.assert_scene_fails_at(line + '\nCamera "perspective"\nWorldBegin\n', line)

    def test_resolution_without_pixels(self):
        for film in ('"integer xresolution" 0', '"integer yresolution" 0', '"integer xresolution" -5'):
            with self.subTest(film=film):
                self.assert_scene_fails_at(f'Film "rgb" {film}\nWorldBegin\n', film)

    def test_numbers_out_of_range(self):
        for line, at in [
            ('Camera "perspective" "float fov" 180', '"float fov"'),
            ('Camera "perspective" "float shutteropen" 1 "float shutterclose" 1', '"float shutterclose"'),
            ('Camera "perspective" "float lensradius" -1', '"float lensradius"'),
            ('Sampler "zsobol" "integer pixelsamples" 0', '"integer pixelsamples"'),
            ('Integrator "path" "integer maxdepth" -1', '"integer maxdepth"'),
            ('Film "rgb" "float iso" 0', '"float iso"'),
        ]:
            with self.subTest(line=line):
                self.assert_scene_fails_at(line + "\nWorldBegin\n", at)

    def test_info_reports_the_same(self):
        self.write("scene.pbrt", HEADER + "WorldBegin\nFrobnicate\n")
        self.assert_fails_at(self.run_program("info", "scene.pbrt"), "scene.pbrt:7:1", "Frobnicate")


class OtherFiles(SceneErrorTest):
    def test_missing_files(self):
        for line, at, name in [
            ('Include "parts.pbrt"', '"parts.pbrt"', "parts.pbrt"),
            ('Import "parts.pbrt"', 'Import', "parts.pbrt"),
            ('Shape "plymesh" "string filename" "mesh.ply"', '"string filename" "mesh', "mesh.ply"),
            ('Texture "t" "spectrum" "imagemap" "string filename" "wood.png"', '"string filename" "wood', "wood.png"),
            ('LightSource "infinite" "string filename" "sky.exr"', '"string filename" "sky', "sky.exr"),
        ]:
            with self.subTest(line=line):
                scene = TINY + line + "\n"
                result = self.render(scene)
                self.assert_fails(result, SCENE, name, "not found")
                line_number = scene.count("\n")
                self.assertRegex(result.stderr, rf"^covtrace: scene\.pbrt:{line_number}:\d+: ")
                self.assert_no_file()

    def test_include_cycles(self):
        self.assert_fails(self.render(TINY + 'Include "scene.pbrt"\n'), SCENE, "includes itself")
        self.write("a.pbrt", 'Include "b.pbrt"\n')
        self.write("b.pbrt", '\n  Include "a.pbrt"\n')
        result = self.render(TINY + 'Include "a.pbrt"\n')
        self.assert_fails(result, SCENE, "b.pbrt:2:", "a.pbrt")

    def test_error_in_an_include_names_that_file(self):
        self.write("parts/one.pbrt", '\n\n   Shape "shpere"\n')
        result = self.render(TINY + 'Include "parts/one.pbrt"\n')
        self.assert_fails_at(result, "parts/one.pbrt:3:4", "shpere")

    def test_damaged_pictures(self):
        for name, content in {"empty.png": b"", "short.png": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "no.exr": b"\x76\x2f\x31\x01\x02"}.items():
            with self.subTest(file=name):
                self.write(name, content)
                scene = (
                    TINY + f'Texture "t" "spectrum" "imagemap" "string filename" "{name}"\n'
                    'Material "diffuse" "texture reflectance" "t"\nShape "sphere"\n'
                )
                result = self.render(scene)
                self.assert_fails(result, SCENE, name)
                self.assertRegex(result.stderr, r"^covtrace: scene\.pbrt:\d+:\d+: ")


class Meshes(SceneErrorTest):
    SCENE = TINY + 'Shape "plymesh" "string filename" "mesh.ply"\n'

    def assert_mesh_fails(self, content, *fragments):
        self.write("mesh.ply", content)
        self.assert_fails(self.render(self.SCENE), SCENE, "mesh.ply", *fragments)

    def test_whole_mesh_renders(self):
        self.write("mesh.ply", binary_ply())
        self.assertEqual(self.render(self.SCENE).code, DONE)

    def test_mesh_cut_at_every_eighth_byte(self):
        whole = binary_ply()
        for length in [*range(0, len(whole) - 1, 8), len(whole) - 1]:
            with self.subTest(length=length):
                self.assert_mesh_fails(whole[:length])

    def test_index_out_of_range(self):
        self.assert_mesh_fails(binary_ply(faces=[(0, 1, 3)]))
        self.assert_mesh_fails(binary_ply(faces=[(0, -1, 2)]))

    def test_vertices_that_are_no_numbers(self):
        for bad in (float("nan"), float("inf")):
            self.assert_mesh_fails(binary_ply([(0, 0, 0), (1, bad, 0), (0, 1, 0)]))

    def test_more_vertices_claimed_than_there_are(self):
        for claimed in (5, 10**6, 2**31 - 1, 2**40, -1):
            with self.subTest(claimed=claimed):
                self.write("mesh.ply", binary_ply(count=claimed))
                result = self.render(self.SCENE, before=limits(AS=2 << 30))
                self.assertIn(result.code, (SCENE, LIMIT), result)
                self.assert_fails(result, result.code, "mesh.ply")

    def test_triangle_mesh_in_the_scene(self):
        points = '"point3 P" [0 0 0  1 0 0  0 1 0]'
        for indices, fragment in [("[0 1 3]", "3"), ("[0 1 -1]", "-1")]:
            with self.subTest(indices=indices):
                scene = TINY + f'Shape "trianglemesh" {points} "integer indices" {indices}\n'
                self.assert_fails(self.render(scene), SCENE, "scene.pbrt:", fragment)


class Limits(SceneErrorTest):
    """A size beyond reach is refused fast, before memory is taken."""

    def test_huge_resolution_in_the_scene(self):
        for size in ((100_000, 100_000), (2_000_000_000, 2_000_000_000), (65_536, 65_536)):
            with self.subTest(size=size):
                film = f'Film "rgb" "integer xresolution" {size[0]} "integer yresolution" {size[1]}\n'
                result = self.render(film + WORLD, before=limits(AS=2 << 30), timeout=10)
                self.assert_fails_at(result, place_of(film, '"integer xresolution"'), f"{size[0]}x{size[1]}", code=LIMIT)

    def test_huge_resolution_on_the_command_line(self):
        for size in ("2000000000x2000000000", "100000x100000", "30000x30000"):
            with self.subTest(size=size):
                result = self.render(TINY, "--resolution", size, before=limits(AS=2 << 30), timeout=10)
                self.assert_fails(result, LIMIT, size)
                self.assert_no_file()

    def test_more_pixels_than_memory_without_any_limit_set(self):
        bytes_of_memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        side = int((bytes_of_memory / 64) ** 0.5)  # every buffer alone would fit, all together do not
        if side > 60_000:
            self.skipTest("more memory than the largest image needs")
        result = self.render(TINY, "--resolution", f"{side}x{side}", timeout=10)
        self.assert_fails(result, LIMIT, f"{side}x{side}")

    def test_little_memory_is_enough_for_a_little_scene(self):
        result = self.render(TINY, before=limits(AS=2 << 30))
        self.assertEqual(result.code, DONE, result)

    @unittest.skipIf(SANITIZED, "a sanitizer needs more address space")
    def test_too_little_memory_for_any_scene(self):
        for megabytes in (120, 150):
            result = self.render(TINY, before=limits(AS=megabytes << 20))
            self.assert_fails(result, LIMIT, "not enough memory")

    def test_many_includes_end(self):
        for i in range(300):
            self.write(f"{i}.pbrt", f'Include "{i + 1}.pbrt"\n')
        self.write("300.pbrt", "")
        result = self.render(TINY + 'Include "0.pbrt"\n')
        self.assertIn(result.code, (DONE, SCENE, LIMIT), result)


if __name__ == "__main__":
    unittest.main()
