"""The experiments of Belcour 2012, section 5.1, at a tiny size: that they run, the claims that they make, and the
page that shows them."""

import json
import re
import shlex
import shutil
from pathlib import Path

from support import DONE, HEADER, SCENE, USAGE, WORLD, CliTest


class Reproduce(CliTest):
    def results(self, folder):
        return json.loads((Path(self.folder) / folder / "results.json").read_text())

    def test_claims_that_are_numbers(self):
        result = self.run_program("reproduce", "lens", "motion", "shininess", "--tiny", "-o", "out", timeout=200)
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(result.stdout, "")
        results = self.results("out")
        self.assertTrue(results["complete"])
        found = {name: e["data"] for name, e in results["experiments"].items()}
        self.assertEqual(set(found), {"lens", "motion", "shininess"})
        # Width grows with the lens and with the speed as the closed form says.
        for view in ("lens-small", "lens-large"):
            self.assertAlmostEqual(found["lens"][view]["closed_form_ratio_median"], 1, delta=0.05, msg=view)
        self.assertGreater(found["lens"]["lens-large"]["width_at_top"], 2 * found["lens"]["lens-small"]["width_at_top"])
        # Deviations that the motion adds, V / (sqrt(12) c) with c = 2.
        for case in ("motion-slow", "motion-medium", "motion-fast"):
            self.assertAlmostEqual(found["motion"][case]["stretch_median"], found["motion"][case]["pixels"] / 48**0.5, delta=0.01, msg=case)
        for case in ("motion-slow", "motion-medium", "motion-fast", "motion-slanted"):
            self.assertAlmostEqual(found["motion"][case]["closed_form_ratio_median"], 1, delta=0.05, msg=case)
            # Axes follow the direction of the blur.
            self.assertLess(found["motion"][case]["angle_95"], 10, case)
        # Area falls with the exponent.
        for kind in ("metal_local", "metal_global", "coated_local", "coated_global"):
            area = found["shininess"]["area"][kind]
            if kind.startswith("coated"):
                area = area[1:]  # below 64 the coat's highlight hardly stands out from the diffuse base
            # At this size the sharpest highlights are smaller than a pixel; filters of less than half a pixel are in no order.
            for broad, sharp in zip(area, area[1:]):
                self.assertLess(sharp, max(broad, 0.5), (kind, area))
            self.assertLess(area[-1], area[0] / 2, kind)

    def test_space_and_time_before_and_behind_the_shutter(self):
        self.assertEqual(self.run_program("reproduce", "slice", "--tiny", "-o", "out", timeout=100).code, DONE)
        experiment = self.results("out")["experiments"]["slice"]
        self.assertEqual(experiment["resolution"], [64, 36])
        data = experiment["data"]
        predicted, measured = data["predicted"], data["measured"]
        for covariance in (predicted, measured):
            self.assertAlmostEqual(-covariance["xt"] / covariance["xx"] / data["way"], 1, delta=0.03)
            self.assertLess(covariance["behind"], covariance["xx"])
        for part in ("xx", "behind"):
            self.assertAlmostEqual((predicted[part] / measured[part]) ** 0.5, 1, delta=0.3, msg=part)
        self.assertLess(data["image_difference"], 0.1)  # 16 samples a pixel

    def test_page_is_self_contained_and_safe(self):
        folder = "a <b>&'\" c"
        self.assertEqual(self.run_program("reproduce", "motion", "--tiny", "--quiet", "-o", folder).code, DONE)
        page = (Path(self.folder) / folder / "index.html").read_text()
        self.assertIn("a &lt;b&gt;&amp;&#39;&quot; c", page)
        self.assertNotIn("<b>", page)
        self.assertNotIn("<script", page)
        self.assertIn("default-src 'none'", page)
        # The page loads nothing: images are data, links are to files beside the page.
        for reference in re.findall(r"(?:src|href)=\"([^\"]*)\"", page):
            self.assertRegex(reference, r"^(data:image/png;base64,|figures/|#|[a-z]+\.html)")
        self.assertNotIn("url(", page)
        for claim in self.results(folder)["experiments"]["motion"]["claims"].values():
            self.assertRegex(claim["command"], r"^covtrace (render|reproduce) ")
        # Commands can be given to a shell as they are.
        for command in self.results(folder)["experiments"]["motion"]["figures"][0]["commands"]:
            self.assertTrue((Path(self.folder) / shlex.split(command)[2]).is_file(), command)
        for name in ("motion.png", "motion.svg"):
            self.assertTrue((Path(self.folder) / folder / "figures" / name).is_file())

    def test_all_on_scenes_of_ones_own(self):
        options = HEADER.replace('"float fov" 40', '"float fov" 40 "float lensradius" 0.2 "float focaldistance" 5')
        for name in ("snooker-frame", "helicopter", "foliage"):
            self.write(f"scenes/{name}/scene.pbrt", options + WORLD)
        result = self.run_program("reproduce", "--tiny", "--scenes", "scenes", "-o", "out", timeout=280)
        self.assertEqual(result.code, DONE, result)
        results = self.results("out")
        self.assertTrue(results["complete"])
        self.assertEqual(
            set(results["experiments"]),
            {"pipeline", "slice", "sampling", "lens", "motion", "shininess", "snooker", "helicopter", "table", "voxels", "progressive"},
        )
        page = (Path(self.folder) / "out/index.html").read_text()
        for name, experiment in results["experiments"].items():
            self.assertNotIn("failure", experiment, name)
            self.assertIn("seed", experiment["counts"], name)
            self.assertIn(f'<section id="{name}">', page)
            for claim in experiment["claims"].values():
                self.assertIn("covtrace re", claim["command"])
            for figure in experiment["figures"]:
                self.assertTrue(figure["commands"], figure)
                self.assertTrue((Path(self.folder) / "out" / figure["file"]).is_file())
        study = results["experiments"]["snooker"]["data"]
        self.assertEqual(set(study["methods"]), {"covariance", "covariance on demand", "hybrid"})
        commands = [c for t in results["experiments"]["snooker"]["tables"] for c in t["commands"] if "--progressive" in c]
        self.assertEqual(len(commands), 1, commands)
        # From ours towards Belcour's choices, which take every voxel and, once, the samples he had time for.
        variants = study["variants"]
        self.assertEqual(set(variants), {"predicted", "thesis_printed", "thesis_matched", "thesis_predicted", "thesis_verified",
                                         "budget_matched", "budget_predicted"})
        self.assertEqual([v["filter"] for v in variants.values()],
                         ["matched", "predicted", "predicted", "matched", "predicted", "thesis", "verified"])
        self.assertEqual((variants["thesis_matched"]["spp"], variants["budget_matched"]["spp"]), (19, 29))
        voxels = [c for c in results["experiments"]["snooker"]["tables"][0]["commands"] if "--occlusion voxels" in c and "--brdf-covariance global" in c]
        self.assertEqual(len(voxels), 6, voxels)
        for method in study["methods"].values():
            self.assertGreater(method["breakdown"]["total"], 0)
        # The references are kept for the next run.
        self.assertEqual(len(list((Path(self.folder) / "out/references").glob("*.exr"))), 6)

    def test_a_missing_scene_stops_only_its_experiment(self):
        Path(self.folder, "empty").mkdir()
        result = self.run_program("reproduce", "voxels", "motion", "--tiny", "--scenes", "empty", "-o", "out")
        self.assertEqual(result.code, SCENE, result)
        self.assertIn("empty/foliage/scene.pbrt", result.stderr)
        experiments = self.results("out")["experiments"]
        self.assertIn("foliage", experiments["voxels"]["failure"])
        self.assertNotIn("failure", experiments["motion"])
        self.assertIn("Not run", (Path(self.folder) / "out/index.html").read_text())

    def test_usage(self):
        self.assert_fails(self.run_program("reproduce", "-o", "out", "fig5"), USAGE, "'fig5'")
        self.assert_fails(self.run_program("reproduce", "lens"), USAGE, "--output")
        self.write("file", "")
        self.assert_fails(self.run_program("reproduce", "lens", "-o", "file/out"), USAGE, "file/out")
        shutil.rmtree(Path(self.folder) / "out", ignore_errors=True)


if __name__ == "__main__":
    import unittest

    unittest.main()
