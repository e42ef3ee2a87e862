"""--ocio-config: a PNG shown by an OpenColorIO config; the image itself stays as it is."""

import os
import pathlib
import shutil
import subprocess
import unittest
from unittest import mock

import exr
from support import DONE, SCENE, TINY, USAGE, CliTest, place_of, warnings_of
from test_display import SKY, first_pixel

CONFIG = (pathlib.Path(__file__).parents[1] / "ocio" / "config.ocio").read_text()


def crossed(r, g, b):
    """A colour as the view Crossed shows it, in 8 bits, computed here."""
    mixed = (0.75 * r + 0.25 * g, 0.125 * r + 0.75 * g + 0.125 * b, 0.5 * g + 0.5 * b)
    return tuple(255 * v ** (1 / 2.4) for v in mixed)


class OpenColorIO(CliTest):
    def setUp(self):
        super().setUp()
        self.write("config.ocio", CONFIG)

    def picture(self, *arguments, colour=".4 .2 .1"):
        """The colour of a sky's picture, which the config shows."""
        self.rendered("--method", "uniform", "--png", "p.png", "--ocio-config", "config.ocio", *arguments, scene=SKY.format(colour))
        return first_pixel((self.folder / "p.png").read_bytes())

    def assert_shown(self, shown, expected):
        self.assertTrue(all(abs(s - e) < 0.7 for s, e in zip(shown, expected, strict=True)), (shown, expected))

    def test_display_view_and_look(self):
        self.assert_shown(self.picture(), crossed(0.4, 0.2, 0.1))
        self.assert_shown(self.picture("--view", "Crossed", "--exposure", "-1"), crossed(0.2, 0.1, 0.05))
        self.assert_shown(self.picture("--view", "Untouched"), (102, 51, 25.5))
        self.assert_shown(self.picture("--ocio-display", "Projector"), (25.5, 12.75, 6.375))
        self.assert_shown(self.picture("--ocio-look", "warm"), crossed(0.6, 0.2, 0.05))
        self.assert_shown(self.picture("--ocio-source", "dark", colour=".1 .05 .025"), crossed(0.4, 0.2, 0.1))

    def test_the_image_itself_stays(self):
        self.picture(colour=".5 .5 .5")
        self.assertAlmostEqual(exr.read(self.folder / "out.exr").pixels["R"][0], 0.5, places=5)

    def test_a_picture_does_not_claim_to_be_srgb(self):
        self.picture()
        self.assertNotIn(b"sRGB", (self.folder / "p.png").read_bytes())
        self.rendered("--png", "p.png")
        self.assertIn(b"sRGB", (self.folder / "p.png").read_bytes())

    def test_all_that_write_pictures_have_it(self):
        by_config = ("--ocio-config", "config.ocio", "--ocio-look", "warm")
        on_the_ball = ("--crop", "12,8,20,12")
        self.rendered("--film", "a.film", *on_the_ball, *by_config, output="o.png")
        self.rendered("--seed", "2", *on_the_ball, output="b.exr")
        for arguments in (
            ("merge", "a.film", "-o", "a.exr", "--png", "m.png"),
            ("denoise", "a.exr", "b.exr", "-o", "d.exr", "--png", "d.png", "--denoiser", "none"),
        ):
            result = self.run_program(*arguments, *by_config)
            self.assertEqual(result.code, DONE, result)
        for picture, image in (("o.png", "a.exr"), ("m.png", "a.exr"), ("d.png", "d.exr")):
            pixels = exr.read(self.folder / image).pixels
            r, g, b = (pixels[c][0] for c in "RGB")
            self.assertGreater(min(r, g, b), 0.01)
            expected = [min(v, 255) for v in crossed(1.5 * r, g, 0.5 * b)]
            self.assert_shown(first_pixel((self.folder / picture).read_bytes()), expected)

    def test_as_openimageio_shows_it(self):
        self.assertIsNotNone(shutil.which("oiiotool"), "openimageio-tools is missing: scripts/install-dependencies")
        self.rendered("--png", "p.png", "--ocio-config", "config.ocio", "--ocio-look", "warm")
        command = ["oiiotool", "--colorconfig", "config.ocio", "out.exr", "--ch", "R,G,B",
                   "--ociodisplay:from=scene_linear", "Screen", "Warm", "-d", "uint8", "-o", "oiio.png"]
        subprocess.run(command, cwd=self.folder, check=True, capture_output=True)
        told = subprocess.run(["oiiotool", "--fail", "0.006", "--hardfail", "0.006", "p.png", "oiio.png", "--diff"],
                              cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(told.returncode, 0, told)

    def test_the_environment_is_not_asked(self):
        with mock.patch.dict(os.environ, {"OCIO": str(self.folder / "none.ocio")}):
            self.assert_shown(self.picture(), crossed(0.4, 0.2, 0.1))
        with mock.patch.dict(os.environ, {"OCIO": str(self.folder / "config.ocio")}):
            self.rendered("--method", "uniform", "--png", "p.png", scene=SKY.format(".5 .25 .125"))
            self.assertEqual(first_pixel((self.folder / "p.png").read_bytes()), (188, 137, 99))

    def fails(self, code, *fragments, config="config.ocio", arguments=()):
        result = self.render(TINY, "--png", "p.png", "--ocio-config", config, *arguments)
        self.assert_fails(result, code, *fragments)
        self.assert_no_file()
        return result

    def test_no_config(self):
        self.fails(SCENE, "cannot open 'none.ocio': No such file", config="none.ocio")
        self.fails(SCENE, "cannot open '.'", config=".")
        self.fails(USAGE, "--ocio-config", "expected a value", config="")
        broken = self.write("broken.ocio", CONFIG.replace("slope: [1.5, 1, 0.5]}", "slope: much}")).read_text()
        result = self.fails(SCENE, "cannot read 'broken.ocio'", config="broken.ocio")
        self.assertTrue(result.stderr.startswith(f"covtrace: {place_of(broken, 'transform:', 'broken.ocio').rsplit(':', 1)[0]}:"), result)
        self.write("text.ocio", "hello")
        self.assert_fails_at(self.fails(SCENE, config="text.ocio"), "text.ocio:1:1")

    def test_unknown_names(self):
        self.fails(USAGE, "covtrace: --ocio-display: 'Wall' is no display", "it has 'Screen', 'Projector'", arguments=("--ocio-display", "Wall"))
        self.fails(USAGE, "covtrace: --view: 'agx' is no view of the display 'Screen'", "it has 'Crossed', 'Warm', 'Untouched'", arguments=("--view", "agx"))
        self.fails(USAGE, "covtrace: --ocio-look: 'cold' is no look", "it has 'warm', 'dim - half'", arguments=("--ocio-look", "cold"))
        self.fails(USAGE, "covtrace: --ocio-source: 'log' is no colour space", "it has 'linear', 'untouched', 'crossed', 'dark'", arguments=("--ocio-source", "log"))

    def test_names_without_a_config(self):
        for option in ("--ocio-display", "--ocio-look", "--ocio-source"):
            self.assert_fails(self.render(TINY, option, "warm"), USAGE, f"{option}: 'warm'", "config")
        self.assert_fails(self.render(TINY, "--view", "Crossed"), USAGE, "--view", "srgb|filmic|agx")

    def test_the_config_is_not_lost(self):
        self.fails(USAGE, "--stats", arguments=("--stats", "config.ocio"))
        self.assertEqual((self.folder / "config.ocio").read_text(), CONFIG)

    def test_its_tables_are_not_lost(self):
        (self.folder / "luts").mkdir()
        table = self.write("luts/curve.spi1d", "Version 1\nFrom 0 1\nLength 2\nComponents 1\n{\n0\n0.5\n}\n")
        self.write("config.ocio", CONFIG.replace("!<ExponentTransform> {value: [2.4, 2.4, 2.4, 1], direction: inverse}",
                                                 "!<FileTransform> {src: curve.spi1d}"))
        self.rendered("--film", "a.film", output="a.exr")
        self.rendered("--seed", "2", output="b.exr")
        before = table.read_text()
        for command in (("render", "scene.pbrt", "-o", "c.exr", "--stats", "luts/curve.spi1d"),
                        ("merge", "a.film", "--film", "luts/curve.spi1d"),
                        ("denoise", "a.exr", "b.exr", "-o", "luts/curve.spi1d", "--denoiser", "none")):
            result = self.run_program(*command, "--png", "p.png", "--ocio-config", "config.ocio")
            self.assert_fails(result, USAGE, "'luts/curve.spi1d' would take the place of", "which is read")
            self.assertEqual(table.read_text(), before)

    def test_what_is_not_understood_is_told(self):
        text = self.write("odd.ocio", CONFIG.replace("slope: [1.5, 1, 0.5]", "tilt: 2")).read_text()
        result = self.render(TINY, "--png", "p.png", "--ocio-config", "odd.ocio")
        self.assertEqual(result.code, DONE, result)
        place = place_of(text, "transform:", "odd.ocio").rsplit(":", 1)[0]
        self.assertIn(f"warning: {place}: At line {place.rsplit(':')[1]}, unknown key 'tilt'", result.stderr)
        self.assertEqual(len(warnings_of(result)), 1, result)
        self.assertIn("no PNG", warnings_of(self.render(TINY, "--ocio-config", "config.ocio"))[0][1])


if __name__ == "__main__":
    unittest.main()
