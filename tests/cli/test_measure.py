"""covtrace measure: its output, the units, and its failures."""

import json
import math
import unittest

from support import DONE, HEADER, SCENE, TINY, USAGE, CliTest

AXES = ["pixel_x", "pixel_y", "lens_x", "lens_y", "shutter"]
FAST = ["--samples", "32768", "--paths", "64"]

# A textured plane, four units away, through a lens that is focused nearer.
PLANE = """\
LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 20 "float lensradius" 0.2 "float focaldistance" 3
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
Integrator "path" "integer maxdepth" 1
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [50 50 50]
Translate 0.5 0 -1
Shape "disk" "float radius" 0.1
AttributeEnd
Material "diffuse" "rgb reflectance" [.5 .5 .5]
Shape "trianglemesh" "point3 P" [-9 -9 0  9 -9 0  9 9 0  -9 9 0] "integer indices" [0 2 1 0 3 2]
"""


class Measure(CliTest):
    def measure(self, *arguments, scene=TINY):
        self.write("scene.pbrt", scene)
        return self.run_program("measure", "scene.pbrt", *arguments)

    def measured(self, *arguments, **options):
        result = self.measure(*arguments, "--json", *FAST, **options)
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(result.stderr, "", result)
        return json.loads(result.stdout)

    def test_json_holds_both_matrices_and_the_ratios(self):
        j = self.measured("--pixel", "12,8")
        self.assertEqual(j["pixel"], [12, 8])
        self.assertEqual(j["resolution"], [24, 16])
        self.assertEqual(j["axes"], AXES)
        for name in ("predicted", "measured"):
            matrix = j[name]
            self.assertEqual([len(row) for row in matrix], [5] * 5)
            for i in range(5):
                for k in range(5):
                    self.assertTrue(math.isfinite(matrix[i][k]))
                    self.assertEqual(matrix[i][k], matrix[k][i])
                self.assertAlmostEqual(j[f"bandwidth_{name}"][i] ** 2, max(0, matrix[i][i]))
        for name in ("filter_predicted", "filter_measured"):
            longer, shorter = j[name]["deviations"]
            self.assertTrue(0.49 < shorter <= longer < 15.01, j[name])
            self.assertTrue(0 <= j[name]["change"] < 1 and 0 <= j[name]["noise"] < 1, j[name])
        for name in ("ratio", "bandwidth_error", "window"):
            self.assertEqual(len(j[name]), 5)
        for ratio, predicted, found in zip(
            j["ratio"], j["bandwidth_predicted"], j["bandwidth_measured"]
        ):
            if ratio is not None:
                self.assertAlmostEqual(ratio, predicted / found)

    def test_a_pinhole_at_rest_varies_over_pixels_alone(self):
        j = self.measured("--pixel", "12,12")
        for axis in (2, 3, 4):
            self.assertEqual(j["bandwidth_measured"][axis], 0)
            self.assertIsNone(j["ratio"][axis])

    def test_a_lamp_before_a_wall_is_measured_as_predicted(self):
        j = self.measured("--pixel", "16,16", scene=PLANE)
        for axis in (0, 1):
            self.assertLess(abs(j["ratio"][axis] - 1), 0.25)

    def test_the_bandwidth_per_pixel_halves_with_twice_the_pixels(self):
        few = self.measured("--pixel", "16,16", scene=PLANE)
        many = self.measured("--pixel", "32,32", "--resolution", "64x64", scene=PLANE)
        for name in ("bandwidth_predicted", "bandwidth_measured"):
            for axis in (0, 1):
                self.assertAlmostEqual(many[name][axis] / few[name][axis], 0.5, delta=0.1)

    def test_same_numbers_for_any_number_of_threads(self):
        one = self.measured("--pixel", "12,8", "--threads", "1", "--seed", "3")
        self.assertEqual(one, self.measured("--pixel", "12,8", "--threads", "3", "--seed", "3"))
        self.assertNotEqual(one, self.measured("--pixel", "12,8", "--seed", "4"))

    def test_the_table_names_every_axis(self):
        result = self.measure("--pixel", "12,8", *FAST)
        self.assertEqual(result.code, DONE, result)
        for text in AXES + ["predicted covariance", "measured covariance", "predicted/measured"]:
            self.assertIn(text, result.stdout)

    def test_darkness_is_said(self):
        dark = HEADER + "WorldBegin\nShape \"sphere\" \"float radius\" 1\n"
        result = self.measure("--pixel", "12,8", "--environment", "0", *FAST, scene=dark)
        self.assertEqual(result.code, DONE, result)
        self.assertIn("no light reaches pixel 12,8", result.stderr)

    def test_wrong_options(self):
        for arguments, fragment in (
            ([], "--pixel"),
            (["--pixel", "12"], "--pixel: '12' is not a pixel x,y"),
            (["--pixel", "24,8"], "--pixel: 24,8 is outside the frame of 24x16"),
            (["--pixel=-1,8"], "--pixel: -1,8 is outside the frame"),
            (["--pixel", "1,1", "--occlusion", "some"], "--occlusion: 'some' is none of"),
            (["--pixel", "1,1", "--samples", "7"], "--samples"),
        ):
            with self.subTest(arguments=arguments):
                self.assert_fails(self.measure(*arguments), USAGE, fragment)

    def test_a_missing_scene(self):
        self.assert_fails(
            self.run_program("measure", "none.pbrt", "--pixel", "1,1"), SCENE, "none.pbrt"
        )


if __name__ == "__main__":
    unittest.main()
