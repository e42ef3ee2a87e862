"""Stand-ins for a camera or lights that a file does not have, and the warnings of them."""

import json
import unittest

import exr
from support import DONE, USAGE, CliTest, warnings_of

FILM = 'Film "rgb" "integer xresolution" 16 "integer yresolution" 16\nSampler "zsobol" "integer pixelsamples" 8\n'
VIEW = 'LookAt 0 0 4  0 0 0  0 1 0\nCamera "perspective" "float fov" 40\n' + FILM
BALL = 'WorldBegin\nMaterial "diffuse" "rgb reflectance" [.5 .5 .5]\nShape "sphere" "float radius" 1\n'
TRIANGLE = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
}
# The sine of the elevation in the middle of the first pixel, and the sky there and below the horizon in the last row
SINE = 0.3073
SKY, BELOW = 0.4 * (1.3 - 0.45 * SINE), 0.4 * (1.3 - 1.05 * SINE)


class Defaults(CliTest):
    def lit(self, scene, *arguments):
        """The picture's green, row by row, and the warnings."""
        result = self.render(scene, "--method", "uniform", *arguments)
        self.assertEqual(result.code, DONE, result)
        image = exr.read(self.folder / "out.exr")
        green = image.pixels["G"]
        return [green[y * image.width : (y + 1) * image.width] for y in range(image.height)], [text for _, text in warnings_of(result)]

    def test_a_scene_without_light_gets_some(self):
        rows, warnings = self.lit(VIEW + BALL)
        self.assertEqual(len(warnings), 1, warnings)
        self.assertIn("no lights", warnings[0])
        self.assertAlmostEqual(rows[0][0], SKY, places=3)
        self.assertAlmostEqual(rows[15][0], BELOW, places=3)
        # The key comes from the upper left.
        self.assertGreater(rows[5][5], 1.5 * rows[10][10])
        self.assertLess(max(map(max, rows)), 0.6)

    def test_the_film_does_not_make_it_dark(self):
        rows, _ = self.lit(VIEW.replace('"float fov" 40', '"float fov" 40 "float shutterclose" 0.02') + BALL)
        self.assertAlmostEqual(rows[0][0], SKY, places=3)

    def test_any_light_of_the_file_counts(self):
        for light in (
            'LightSource "point"',
            'LightSource "infinite" "rgb L" [0 0 0]',
            'AreaLightSource "diffuse"\nTranslate 0 9 0\nShape "sphere"',
        ):
            rows, warnings = self.lit(VIEW + BALL + light + "\n")
            self.assertEqual(rows[0][0], 0, light)
            self.assertNotIn("no lights", "".join(warnings), light)

    def test_an_environment_takes_its_place(self):
        for scene in (VIEW + BALL, FILM + BALL):
            rows, warnings = self.lit(scene, "--environment", "0")
            self.assertEqual(max(map(max, rows)), 0)
            self.assertNotIn("no lights", "".join(warnings))
        rows, _ = self.lit(VIEW + BALL, "--environment", "1")
        self.assertAlmostEqual(rows[0][0], 1, places=3)
        rows, warnings = self.lit(VIEW + BALL, "--environment-scale", "2")  # of the sky that stands in
        self.assertAlmostEqual(rows[0][0], 2 * SKY, places=3)
        self.assertIn("no lights", warnings[0])

    def test_a_scene_without_a_camera_is_seen_from_its_origin(self):
        light = 'LightSource "infinite"\n'
        rows, warnings = self.lit(FILM + BALL.replace("WorldBegin", "WorldBegin\nTranslate 0 0 4") + light)
        self.assertEqual(len(warnings), 1, warnings)
        self.assertIn("no Camera", warnings[0])
        self.assertLess(rows[8][8], 0.99)  # the ball before the sky
        _, warnings = self.lit(FILM + BALL + light, "--camera", "eye 0,0,4 target 0,0,0 fov 40")
        self.assertEqual(warnings, [])

    def test_gltf_too(self):
        self.write("a.gltf", json.dumps(TRIANGLE))
        arguments = ["render", "a.gltf", "-o", "a.exr", "--spp", "1", "--resolution", "8x8", "--progress", "none"]
        told = self.run_program(*arguments).stderr
        self.assertIn("no camera", told)
        self.assertIn("no lights", told)
        told = self.run_program(*arguments, "--environment", "1", "--camera", "eye 0,0,3 target 0,0,0 fov 40").stderr
        self.assertNotIn("no camera", told)
        self.assertNotIn("no lights", told)

    def test_info_tells_them(self):
        self.write("s.pbrt", FILM + BALL)
        told = self.run_program("info", "s.pbrt").stdout
        self.assertIn("no Camera", told)
        self.assertIn("no lights", told)
        self.assertIn("lights     2", told)

    def test_nothing_to_turn(self):
        self.assert_fails(self.render(VIEW + BALL + 'LightSource "point"\n', "--environment-scale", "2"), USAGE, "--environment-scale")


if __name__ == "__main__":
    unittest.main()
