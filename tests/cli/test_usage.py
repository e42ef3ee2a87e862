"""Help, version, and command lines that are wrong."""

import json
import re
import unittest

import exr
from support import DONE, HEADER, USAGE, TINY, CliTest


class Help(CliTest):
    def assert_fits(self, text, lines):
        self.assertLessEqual(len(text.splitlines()), lines)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 80, line)

    def test_help_goes_to_stdout_and_fits_a_screen(self):
        for arguments in (["--help"], ["-h"], ["render", "--help"], ["compare", "--help"], ["inspect", "--help"], ["info", "--help"], ["merge", "--help"], ["reproduce", "--help"]):
            with self.subTest(arguments=arguments):
                result = self.run_program(*arguments)
                self.assertEqual(result.code, DONE, result)
                self.assertEqual(result.stderr, "")
                self.assert_fits(result.stdout, 80 if arguments[0] == "render" else 24)

    def test_help_names_commands_and_options(self):
        overview = self.run_program("--help").stdout
        for command in ("render", "merge", "compare", "inspect", "info", "reproduce", "completion"):
            self.assertIn(command, overview)
        options = self.run_program("render", "--help").stdout
        for option in (
            "--output --preset --method --spp --time --guides --cov-spp --density --k --max-spp --filter --resolution --crop --max-depth --seed "
            "--threads --isa --shutter --focus --fstop --camera --environment --environment-rotation --environment-scale --png --exposure --view --ocio-config --ocio-display --ocio-look --ocio-source --layers --layer-names --tev --tev-layers --progress --texture-memory --stats --reproducible "
            "--film --checkpoint --every --resume --shard --max-memory --debug-pixel"
        ).split():
            self.assertIn(option, options)

    def test_version(self):
        result = self.run_program("--version")
        self.assertEqual(result.code, DONE, result)
        self.assertRegex(result.stdout, r"^covtrace \d+\.\d+\.\d+ \(\S+\)\n$")
        self.assertEqual(result.stderr, "")


class WrongCommandLines(CliTest):
    def test_the_least_blur_is_none(self):
        image = self.rendered("--spp", "1")
        self.assert_fails(self.run_program("compare", image, image, "--smooth", "1e-20"), USAGE, "--smooth", "from 0.001")
        result = self.run_program("compare", image, image, "--smooth", "0.001")
        self.assertIn("identical       yes", result.stdout, result)

    def test_only_colours_are_smoothed(self):
        self.write("grey.pgm", b"P5 2 2 255\n" + bytes(4))
        self.assert_fails(self.run_program("compare", "grey.pgm", "grey.pgm", "--smooth", "1"), USAGE, "--smooth")

    def test_no_command_or_an_unknown_one(self):
        self.assert_fails(self.run_program(), USAGE)
        self.assert_fails(self.run_program("paint"), USAGE, 'unknown command "paint"')
        self.assert_fails(self.run_program("rendr"), USAGE, 'did you mean "render"?')
        self.assert_fails(self.run_program("--frobnicate"), USAGE, 'unknown option "--frobnicate"')
        self.assert_fails(self.run_program("help", "paint"), USAGE, 'unknown command "paint"')
        self.write("scene.pbrt", TINY)
        self.assert_fails(self.run_program("scene.pbrt"), USAGE, "\"scene.pbrt\" is no command; 'covtrace render FILE' renders a scene")

    def test_help_is_a_word_too(self):
        for words, option in (((), ()), (("render",), ("render",)), (("compare", "a.exr"), ("compare",)), (("help",), ())):
            with self.subTest(words=words):
                self.assertEqual(self.run_program("help", *words).stdout, self.run_program(*option, "--help").stdout)

    def test_units_and_names_may_have_other_capitals(self):
        self.rendered("--spp", 1, "--time", "1M30S", "--resolution", "8X6", "--max-memory", "2gb",
                      "--texture-memory", "50MiB", "--layers", "SAMPLES,n")
        channels = self.run_program("info", "out.exr").stdout
        for part in ("8x6", r"\n  samples\n", r"\n  N\n"):
            self.assertRegex(channels, part)

    def test_beginnings_of_options_are_recognised(self):
        self.assert_fails(self.run_program("render", "scene.pbrt", "--env", "1"), USAGE,
                          'unknown option "--env"; did you mean "--environment" or "--environment-rotation"?')

    def test_missing_and_superfluous_arguments(self):
        self.write("scene.pbrt", TINY)
        self.assert_fails(self.run_program("render"), USAGE, "SCENE")
        self.assert_fails(self.run_program("compare", "a.exr"), USAGE, "REFERENCE")
        self.assert_fails(self.run_program("info"), USAGE, "FILE")
        self.assert_fails(self.run_program("render", "scene.pbrt", "other.pbrt"), USAGE, "other.pbrt")
        self.assert_fails(self.run_program("render", "scene.pbrt", "--spp"), USAGE, "--spp")

    def test_every_bad_value_names_its_option(self):
        bad = {
            "--spp": ["0", "-1", "many", "nan", "inf", "1e300", ""],
            "--time": ["garbage", "0", "-3", "5x", "3m5", "1h30", "1m-3s", "s", "nan", "inf", "1e400", "m", ""],
            "--method": ["magic", "Uniforme", "0"],
            "--cov-spp": ["0", "-2", "x", "1.5", "2 ", "9999999999999999999", ""],
            "--error": ["0", "-1", "x", "nan"],
            "--max-spp": ["0", "x", "0x10", "1e3", "1073741825"],
            "--density": ["even"],
            "--k": ["0", "-1", "x", "nan", "inf", "1e13", "", "3"],  # the last one: not with hybrid
            "--filter": ["none"],
            "--resolution": ["0x5", "5x0", "-4x4", "640", "640x", "640x360x2", "axb", "640y360", " 64x64", "99999999999x1", ""],
            "--crop": ["0,0,8", "0,0,8,8,8", "a,b,c,d", "4,4,4,8", "8,0,4,8", "0,0,25,16", "-1,0,8,8", "0,0,8,17", ""],
            "--max-depth": ["-1", "x", "2147483648", ""],
            "--seed": ["-1", "x", "1.5", "18446744073709551616"],
            "--threads": ["0", "-1", "x", "5000", ""],
            "--voxels": ["0", "2049", "0x10", "wide"],
            "--isa": ["mmx"],
            "--texture-memory": ["", "x", "-1", "5X", "5MX", "5B", "5MBB", "nan", "inf", "1e30"],
            "--every": ["0", "soon"],
            "--shard": ["0/4", "5/4", "1", "1/0", "a/b", "1/4/4", "-1/4"],
            "--max-memory": ["x", "-1", "5X"],
            "--debug-pixel": ["1,2", "a,b,c", "1,2,-3", "24,0,0"],
            "--shutter": ["1,0", "0,0", "0", "nan,1", "0,inf", "a,b", ""],
            "--focus": ["0", "-1", "nan", "1e-50", "1e-20"],
            "--fstop": ["0", "-1", "nan", "inf", "1e-50", "1e-38", "1e31"],
            "--progress": ["loud"],
            "--layers": ["nope", "raw,nope", "raw,", "raw.R", "all,none", "none,raw"],
        }
        self.write("scene.pbrt", TINY)
        for option, values in bad.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    result = self.run_program("render", "scene.pbrt", "-o", "out.exr", f"{option}={value}")
                    self.assert_fails(result, USAGE, option)
                    self.assert_no_file()

    def test_leading_zeros_are_decimal(self):
        image = exr.read(self.rendered("--spp", "9", "--max-spp", "0010", "--cov-spp", "010", "--voxels", "08", "--threads", "01", "--layers", "samples"))
        self.assertGreater(max(image.pixels["samples.Y"]), 8)
        self.assertLessEqual(max(image.pixels["samples.Y"]), 10)
        self.assertEqual(self.render(TINY, "--max-depth", "09", "--seed", "010", "--resolution", "010x09", "--crop", "00,00,010,09").code, DONE)
        self.assertEqual(exr.read(self.folder / "out.exr").value("covtrace:seed"), "10")
        result = self.run_program("measure", "scene.pbrt", "--pixel", "010,08", "--samples", "004096", "--paths", "010", "--json")
        self.assertEqual(result.code, DONE, result)
        told = json.loads(result.stdout)
        self.assertEqual((told["samples"], told["paths"]), (4096, 10))

    def test_an_image_has_one_sample_at_least(self):
        for method in ("uniform", "covariance", "hybrid"):
            image = self.rendered("--resolution", "8x8", "--spp", "0.01", "--method", method)
            self.assertAlmostEqual(exr.read(image).value("spp"), 1 / 64)
            few = self.render(TINY, "--resolution", "8x8", "--spp", "0.001", "--method", method)
            self.assert_fails(few, USAGE, "0.001 samples per pixel", "64 pixels")

    def test_the_last_one_of_an_option_holds(self):
        image = exr.read(self.rendered("--spp", "1", "--seed", "7", "--spp=2", "--layers", "all", "--layers", "none"))
        self.assertEqual(image.value("spp"), 2)
        self.assertNotIn("raw.R", image.pixels)
        self.write("parts/ball.pbrt", 'Shape "sphere"')
        (self.folder / "empty").mkdir()
        self.write("scene.pbrt", HEADER + "WorldBegin\nInclude \"ball.pbrt\"\n")
        result = self.run_program("render", "scene.pbrt", "--search-path", "parts", "--search-path", "empty")
        self.assertEqual(result.code, DONE, result)

    def test_every_option_may_be_given_twice(self):
        # Missing files are told after the command line was understood.
        values = {"WxH": "8x8", "x,y": "1,1", "x0,y0,x1,y1": "0,0,4,4", "T0,T1": "0,1", "LIST": "none", "DIR": ".", "HOST:PORT": "localhost:1",
                  "SIZE": "1G", "FILE|COLOUR": "1", "TEXT": "eye 0,0,0 target 0,0,1 fov 40", "STOPS": "1", "DEGREES": "1", "K/N": "1/2", "x,y,sample": "1,1,0", "N": "1", "T": "1s", "FILE": "f"}
        given = {"--samples": "4096"}
        for command, files in (("render", ["none.pbrt"]), ("measure", ["none.pbrt"]), ("inspect", ["none.exr"]), ("compare", ["a.exr", "b.exr"]), ("merge", ["none.film"])):
            text = self.run_program(command, "--help").stdout
            for name, kind in re.findall(r"^ +(?:-\w,)?(--[\w-]+)(?: ([\w|:/,]+))?", text, re.MULTILINE):
                if name == "--help":
                    continue
                value = given.get(name) or values.get(kind) or kind.split("|")[0]
                argument = [f"{name}={value}"] if kind else [name]
                needed = {"measure": ["--pixel=1,1"], "merge": ["--output=o.exr"]}.get(command, [])
                with self.subTest(command=command, option=name):
                    result = self.run_program(command, *files, *needed, *argument, *argument)
                    self.assertNotIn("at most", result.stderr, result)
                    self.assertNotIn("--help", result.stderr, result)

    def test_unknown_option(self):
        self.assert_fails(self.render(TINY, "--frobnicate"), USAGE, 'unknown option "--frobnicate"')
        # The option is the one to be named, and not the scene behind its value.
        result = self.run_program("render", "--sppp", "3", "scene.pbrt")
        self.assert_fails(result, USAGE, 'unknown option "--sppp"; did you mean "--spp"?')
        self.assertNotIn("scene.pbrt", result.stderr)

    def test_options_of_other_renderers_are_known(self):
        for name, ours in (("--samples", "--spp"), ("-s", "--spp"), ("--outfile=a.exr", "--output"), ("--width", "--resolution"),
                           ("--hdri", "--environment"), ("--nthreads", "--threads")):
            self.assert_fails(self.run_program("render", name, "3", "scene.pbrt"), USAGE, f'did you mean "{ours}"?')
        # Commands suggest their own options alone
        self.assert_fails(self.run_program("denoise", "--spp", "3", "a.exr"), USAGE, 'did you mean "--samples"?')
        self.assertNotIn("environment", self.run_program("merge", "--hdri", "a.exr").stderr)

    def test_usage_is_checked_before_the_scene_is_read(self):
        result = self.run_program("render", "missing.pbrt", "--time", "soon")
        self.assert_fails(result, USAGE, "--time")

    def test_compare_checks_its_options(self):
        image = self.rendered("--spp", "1")
        for crop in ("1,2,3", "5,5,5,5", "100,100,120,120", "x"):
            with self.subTest(crop=crop):
                self.assert_fails(self.run_program("compare", image, image, "--crop", crop), USAGE)

    def test_durations(self):
        # Durations are only to be understood: the spp limit ends the render long before.
        for time in ("2.5", "45s", "3m", "1h30m", "0.5h", "1h0m30.5s"):
            with self.subTest(time=time):
                self.assertEqual(self.render(TINY, "--spp", "1", "--time", time).code, DONE)


if __name__ == "__main__":
    unittest.main()
