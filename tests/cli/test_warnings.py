"""Features that pbrt-v4 has and this program lacks: a warning with its place, a substitute, exit code 0."""

import unittest

from support import DONE, HEADER, TINY, WORLD, CliTest, warnings_of


class Warnings(CliTest):
    def assert_warns(self, scene, line, fragment):
        result = self.render(scene)
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(result.stdout, "", result)
        self.assertTrue((self.folder / "out.exr").exists(), result)
        places = [place for place, text in warnings_of(result) if fragment in text]
        self.assertEqual(len(places), 1, f"no single warning with {fragment!r}: {result}")
        self.assertRegex(places[0] or "", rf"^scene\.pbrt:{line}:\d+$", result)

    def test_a_plain_scene_has_none(self):
        result = self.render(TINY)
        self.assertEqual((result.code, warnings_of(result)), (DONE, []), result)

    def test_substitutes_in_the_world(self):
        points = '"point3 P" [0 0 0  0 1 0  0 2 0  0 3 0]'
        sphere = '\nShape "sphere"'
        for directive, fragment in [
            ('Material "measured" "string filename" "paint.bsdf"' + sphere, "measured"),
            (f'Shape "curve" {points}', "curve"),
            ('Shape "cylinder"', "cylinder"),
            ('LightSource "goniometric" "spectrum I" "stdillum-D65"', "goniometric"),
            ('Texture "t" "spectrum" "ptex"\nMaterial "diffuse" "texture reflectance" "t"' + sphere, "ptex"),
            ('MakeNamedMedium "m" "string type" "rgbgrid" "rgb sigma_a" [ 1 2 3 ]', "one colour"),
            ('AttributeBegin\nAreaLightSource "diffuse" "rgb L" [1 1 1]\nAttributeEnd', "no shape"),
            ('Shape "sphere" "float raduis" 2', "raduis"),
            ("AttributeEnd", "AttributeEnd"),
        ]:
            with self.subTest(directive=directive):
                # The line is that of the directive that is substituted: the first, or the second
                # after AttributeBegin.
                line = TINY.count("\n") + (2 if directive.startswith("AttributeBegin") else 1)
                self.assert_warns(TINY + directive + "\n", line, fragment)

    def test_substitutes_of_the_view(self):
        for directive, fragment in [
            ('Camera "realistic" "string lensfile" "lens.dat"', "realistic"),
            ('Film "spectral"\n"integer xresolution" 16 "integer yresolution" 8', "spectral"),
            ('Integrator "bdpt"', "without caustics of point, spot and distant lights"),
            ('Integrator "sppm"', "sppm"),
            ('Integrator "path" "integer maxdeth" 3', "maxdeth"),
            ('Accelerator "octree"', "octree"),
        ]:
            with self.subTest(directive=directive):
                line = HEADER.count("\n") + 1
                self.assert_warns(HEADER + directive + "\n" + WORLD, line, fragment)

    def test_the_same_warning_is_told_once(self):
        many = "\n".join(['Shape "sphere" "float raduis" 2'] * 50)
        result = self.render(TINY + many + "\n")
        self.assertEqual(len(warnings_of(result)), 1, result)
        self.assertIn("49 more places", result.stderr)

    def test_options_that_change_nothing(self):
        for options, fragment in [
            (["--method", "hybrid", "--density", "thesis"], "--density changes nothing: it is for the method covariance, and this is hybrid"),
            (["--method", "hybrid", "--filter", "thesis"], "--filter"),
            (["--method", "uniform", "--progressive"], "--progressive"),
            (["--method", "covariance", "--even-counts"], "--even-counts"),
            (["--method", "covariance", "--denoiser", "oidn"], "--denoiser changes nothing"),
            (["--method", "uniform", "--cov-spp", "1"], "--cov-spp"),
            (["--method", "uniform", "--occlusion", "none"], "--occlusion"),
            (["--method", "uniform", "--brdf-covariance", "global"], "--brdf-covariance"),
            (["--method", "uniform", "--texture-bandwidth", "highest"], "--texture-bandwidth"),
            (["--voxels", "20"], "--voxels changes nothing"),
            (["-o", "out.png", "--layer-names", "pbrt"], "--layer-names changes nothing: 'out.png'"),
            (["--debug-pixel", "1,1,0", "--png", "out.png"], "--debug-pixel: no file is written"),
        ]:
            with self.subTest(options=options):
                result = self.render(TINY, "--spp", "1", *options)
                self.assertEqual(result.code, DONE, result)
                texts = [text for _, text in warnings_of(result)]
                self.assertEqual([fragment in text for text in texts], [True], result)
                self.assertEqual(warnings_of(self.render(TINY, "--spp", "1", *options, "--quiet")), [])
        for options in (["--method", "covariance", "--density", "thesis", "--filter", "matched", "--progressive", "--max-spp", "9"],
                        ["--even-counts", "--occlusion", "grid", "--voxels", "20", "--cov-spp", "1"],
                        ["--method", "uniform", "--max-spp", "3"]):
            self.assertEqual(warnings_of(self.render(TINY, "--spp", "1", *options)), [], options)

    def test_options_of_merge_and_measure_that_change_nothing(self):
        self.render(TINY, "--method", "uniform", "--spp", "1", "--film", "u.film")
        merged = self.run_program("merge", "u.film", "-o", "m.exr", "--denoiser", "oidn")
        self.assertIn("--denoiser changes nothing: it is for the method hybrid, and this is uniform", merged.stderr)
        measured = self.run_program("measure", "scene.pbrt", "--pixel", "9,9", "--samples", "4096", "--voxels", "20")
        self.assertIn("--voxels changes nothing", measured.stderr)
        for result in merged, measured:
            self.assertEqual((result.code, len(warnings_of(result))), (DONE, 1), result)

    def test_quiet_says_nothing(self):
        result = self.render(TINY + 'Shape "sphere" "float raduis" 2\n', "--quiet")
        self.assertEqual((result.code, result.stdout, result.stderr), (DONE, "", ""))

    def test_info_tells_them_too(self):
        self.write("scene.pbrt", TINY + 'Shape "cylinder"\n')
        result = self.run_program("info", "scene.pbrt")
        self.assertEqual(result.code, DONE, result)
        self.assertIn("cylinder", result.stdout)


if __name__ == "__main__":
    unittest.main()
