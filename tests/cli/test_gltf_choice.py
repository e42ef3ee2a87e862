"""--camera, --gltf-scene and --animation: which of a glTF file's own are rendered."""

import json
import struct
import subprocess
import unittest

import exr
from gltf_file import shining, uri
from support import DONE, PROGRAM, USAGE, CliTest, warnings_of

CORNERS = [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]
CORNERS = struct.pack("<12f", *CORNERS) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
TIMES = struct.pack("<f", 0) + struct.pack("<3f", 0, 50, 0)


def moving(name, node):
    """An animation that has the node far above all the time."""
    return {"name": name, "samplers": [{"input": 2, "output": 3}], "channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}]}


def perspective(name):
    return {"name": name, "type": "perspective", "perspective": {"yfov": 0.3, "znear": 0.1, "aspectRatio": 1}}


# A red square at x = 0, a green one at x = 10, a blue one at x = 20, and a camera before each. The second scene has no red one.
FILE = {
    "asset": {"version": "2.0"},
    "extensionsUsed": ["KHR_materials_emissive_strength"],
    "scene": 0,
    "scenes": [{"name": "Day", "nodes": [0, 1, 2, 3, 4, 5]}, {"name": "Night", "nodes": [1, 2, 3, 4, 5]}],
    "nodes": [
        {"name": "red", "mesh": 0},
        {"name": "green", "mesh": 1, "translation": [10, 0, 0]},
        {"name": "blue", "mesh": 2, "translation": [20, 0, 0]},
        {"name": "Front", "camera": 0, "translation": [0, 0, 4]},
        {"name": "Side", "camera": 0, "translation": [10, 0, 4]},
        {"camera": 1, "translation": [20, 0, 4]},
    ],
    "cameras": [perspective("Lens"), perspective("Top")],
    "materials": [shining([1, 0, 0]), shining([0, 1, 0]), shining([0, 0, 1])],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": m}]} for m in range(3)],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
        {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        {"bufferView": 2, "componentType": 5126, "count": 1, "type": "SCALAR", "min": [0], "max": [0]},
        {"bufferView": 3, "componentType": 5126, "count": 1, "type": "VEC3"},
    ],
    "bufferViews": [
        {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        {"buffer": 0, "byteOffset": 60, "byteLength": 4}, {"buffer": 0, "byteOffset": 64, "byteLength": 12},
    ],
    "buffers": [{"byteLength": 76, "uri": uri(CORNERS + TIMES)}],
}
ANIMATED = FILE | {"animations": [moving("Up", 0), moving("Away", 1)]}
RENDER = ["--method", "uniform", "--spp", "1", "--resolution", "4x4", "--progress", "none"]


class GltfChoice(CliTest):
    def colour(self, *arguments, file=FILE):
        """The colour in the middle of the picture, as a letter."""
        self.write("a.gltf", json.dumps(file))
        result = self.run_program("render", "a.gltf", "-o", "a.exr", *RENDER, *arguments)
        self.assertEqual(result.code, DONE, result)
        pixels = exr.read(self.folder / "a.exr").pixels
        return "".join(c for c in "RGB" if pixels[c][5] > 1), [text for _, text in warnings_of(result)]

    def refused(self, *arguments, file=FILE):
        (self.folder / "a.exr").unlink(missing_ok=True)
        self.write("a.gltf", json.dumps(file))
        result = self.run_program("render", "a.gltf", "-o", "a.exr", *RENDER, *arguments)
        self.assert_no_file("a.exr")
        return result

    def test_cameras_by_name_and_number(self):
        seen, warnings = self.colour()
        self.assertEqual(seen, "R")
        self.assertTrue([w for w in warnings if w.endswith('the first of 3 cameras is used, 0 "Front"; the others are 1 "Side", 2 "Top"')], warnings)
        for camera, expected in (("Front", "R"), ("0", "R"), ("Side", "G"), ("1", "G"), ("Top", "B"), ("2", "B")):
            seen, warnings = self.colour("--camera", camera)
            self.assertEqual(seen, expected, camera)
            self.assertNotIn("cameras", "".join(warnings))
        # The last one holds, whether it is one of the file's or not.
        pinhole = "eye 10,0,4 target 10,0,0 fov 20"
        self.assertEqual(self.colour("--camera", pinhole)[0], "G")
        self.assertEqual(self.colour("--camera", pinhole, "--camera", "Top")[0], "B")
        self.assertEqual(self.colour("--camera", "Top", "--camera", pinhole)[0], "G")

    def test_a_name_goes_before_a_number(self):
        named = json.loads(json.dumps(FILE))
        named["nodes"][3]["name"] = "1"
        named["nodes"][4]["name"] = "eye"
        self.assertEqual(self.colour("--camera", "1", file=named)[0], "R")
        self.assertEqual(self.colour("--camera", "eye", file=named)[0], "G")

    def test_scenes(self):
        seen, warnings = self.colour()
        self.assertTrue([w for w in warnings if w.endswith('one of 2 scenes is read, 0 "Day"; the others are 1 "Night"')], warnings)
        for scene, expected in (("Day", "R"), ("0", "R"), ("Night", ""), ("1", "")):
            seen, warnings = self.colour("--gltf-scene", scene)
            self.assertEqual(seen, expected, scene)
            self.assertNotIn("scenes", "".join(warnings))
        self.assertEqual(self.colour("--gltf-scene", "Night", "--camera", "Side")[0], "G")

    def test_animations(self):
        seen, warnings = self.colour(file=ANIMATED)
        self.assertEqual(seen, "")
        self.assertTrue([w for w in warnings if w.endswith('the first of 2 animations is played, 0 "Up"; the others are 1 "Away"')], warnings)
        for animation, expected in (("Up", ""), ("0", ""), ("Away", "R"), ("1", "R"), ("none", "R"), ("all", "")):
            seen, warnings = self.colour("--animation", animation, file=ANIMATED)
            self.assertEqual(seen, expected, animation)
            self.assertNotIn("played", "".join(warnings))

    def test_errors_list_what_there_is(self):
        self.assert_fails(self.refused("--camera", "Sied"), USAGE, '--camera: there is no camera "Sied"; the file has 0 "Front", 1 "Side", 2 "Top"', 'did you mean "Side"')
        self.assert_fails(self.refused("--camera", "3"), USAGE, '--camera: there is no camera "3"')
        self.assert_fails(self.refused("--camera", "Lens"), USAGE, '--camera: "Lens" is the name of several, 0, 1;')
        self.assert_fails(self.refused("--gltf-scene", "Noon"), USAGE, '--gltf-scene: there is no scene "Noon"; the file has 0 "Day", 1 "Night"')
        self.assert_fails(self.refused("--animation", "Down"), USAGE, '--animation: there is no animation "Down"; the file has none')
        self.assert_fails(self.refused("--animation", "-1", file=ANIMATED), USAGE, '0 "Up", 1 "Away"')
        without = json.loads(json.dumps(FILE))
        for thing in without["nodes"] + without["cameras"]:
            thing.pop("name", None)
        self.assert_fails(self.refused("--camera", "Front", file=without), USAGE, "the file has numbers 0, 1, 2")
        without["scenes"][0]["nodes"] = [3]
        self.assert_fails(self.refused("--camera", "1", file=without), USAGE, "the file has number 0")
        without["scenes"][0]["nodes"] = [0]
        self.assert_fails(self.refused("--camera", "Front", file=without), USAGE, '--camera: there is no camera "Front"; the file has none')
        for option in ("--camera", "--gltf-scene", "--animation"):
            self.assert_fails(self.refused(option, ""), USAGE, option)

    def test_pbrt_files_have_no_choice(self):
        self.assert_fails(self.render("WorldBegin\n", "--camera", "Front"), USAGE, "--camera", '"Front" names a camera', "pbrt files have one", "eye 0,1,6")
        self.assert_fails(self.render("WorldBegin\n", "--gltf-scene", "0"), USAGE, "--gltf-scene", "pbrt files have one scene")
        self.assert_fails(self.render("WorldBegin\n", "--animation", "all"), USAGE, "--animation", "pbrt files have no animations")

    def test_variants(self):
        painted = json.loads(json.dumps(FILE))
        painted["extensions"] = {"KHR_materials_variants": {"variants": [{"name": "Green"}, {"name": "Blue"}]}}
        mappings = [{"material": 1, "variants": [0]}, {"material": 2, "variants": [1]}]
        painted["meshes"][0]["primitives"][0]["extensions"] = {"KHR_materials_variants": {"mappings": mappings}}
        seen, warnings = self.colour(file=painted)
        self.assertEqual(seen, "R")
        self.assertTrue([w for w in warnings if w.endswith('the file has the variants 0 "Green", 1 "Blue"')], warnings)
        for variant, expected in (("Green", "G"), ("0", "G"), ("Blue", "B"), ("1", "B")):
            self.assertEqual(self.colour("--variant", variant, file=painted)[0], expected, variant)
        self.assert_fails(self.refused("--variant", "Bleu", file=painted), USAGE, '--variant: there is no variant "Bleu"', 'did you mean "Blue"')
        self.assert_fails(self.refused("--variant", "Blue"), USAGE, "the file has none")
        self.assert_fails(self.render("WorldBegin\n", "--variant", "0"), USAGE, "--variant", "pbrt files have no variants")
        render = ["render", "a.gltf", "-o", "a.exr", *RENDER, "--quiet", "--checkpoint", "a.film"]
        self.write("a.gltf", json.dumps(painted))
        self.assertEqual(self.run_program(*render, "--variant", "Blue").code, DONE)
        self.assert_fails(self.run_program(*render, "--resume"), USAGE, "--variant")

    def test_films_know_them(self):
        self.write("a.gltf", json.dumps(ANIMATED))
        render = ["render", "a.gltf", "-o", "a.exr", *RENDER, "--quiet", "--checkpoint", "a.film"]
        for choice, other in (
            (["--camera", "Side"], ["--camera", "Top"]), (["--camera", "Side"], []), ([], ["--camera", "1"]),
            (["--gltf-scene", "Night"], []), ([], ["--gltf-scene", "1"]),
            (["--animation", "Away"], ["--animation", "Up"]), (["--animation", "none"], []), ([], ["--animation", "none"]),
        ):
            self.assertEqual(self.run_program(*render, *choice).code, DONE)
            self.assertEqual(self.run_program(*render, *choice, "--resume").code, DONE)
            self.assert_fails(self.run_program(*render, *other, "--resume"), USAGE, (choice or other)[0])
        # The same ones by other words.
        self.assertEqual(self.run_program(*render, "--camera", "0", "--gltf-scene", "Day", "--animation", "all").code, DONE)
        self.assertEqual(self.run_program(*render, "--camera", "Front", "--resume").code, DONE)

    def test_info_and_measure_choose_too(self):
        self.write("a.gltf", json.dumps(ANIMATED))
        told = self.run_program("info", "a.gltf").stdout
        for text in ('1 "Side", 2 "Top"', '1 "Night"', '1 "Away"'):
            self.assertIn(text, told)
        self.assertIn("shapes     2 ", self.run_program("info", "a.gltf", "--gltf-scene", "Night").stdout)
        self.assertNotIn("cameras", self.run_program("info", "a.gltf", "--camera", "Side").stdout)
        self.assertNotIn("at rest", self.run_program("info", "a.gltf", "--animation", "none").stdout)
        self.assert_fails(self.run_program("info", "a.gltf", "--camera", "Back"), USAGE, '0 "Front"')
        measure = ["measure", "a.gltf", "--pixel", "2,2", "--resolution", "4x4", "--samples", "4096", "--paths", "1", "--quiet", "--json"]
        for choice, light in ((["--camera", "Front", "--animation", "none"], True), (["--camera", "Front"], False), (["--camera", "Top"], True)):
            measured = json.loads(self.run_program(*measure, *choice).stdout)
            self.assertEqual(measured["luminance_measured"] > 0, light, choice)

    def test_standard_input_too(self):
        done = subprocess.run([PROGRAM, "render", "-", "-o", "a.exr", *RENDER, "--camera", "Side"],
                              cwd=self.folder, input=json.dumps(FILE).encode(), capture_output=True)
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertGreater(exr.read(self.folder / "a.exr").pixels["G"][5], 1)


if __name__ == "__main__":
    unittest.main()
