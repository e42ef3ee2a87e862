"""--exposure and --view: how a PNG shows the image, which itself stays as it is."""

import struct
import unittest
import zlib

import exr
from support import DONE, TINY, USAGE, CliTest, warnings_of

# Nothing but a sky, as bright as the text says.
SKY = """\
Camera "perspective"
Film "rgb" "integer xresolution" 4 "integer yresolution" 4
Sampler "zsobol" "integer pixelsamples" 1
WorldBegin
LightSource "infinite" "rgb L" [{0}]
Translate 0 0 -9
Shape "sphere"
"""


def first_pixel(data):
    """The colour of the first pixel of an 8-bit RGB PNG."""
    at, body = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        if kind == b"IDAT":
            body += data[at + 8 : at + 8 + length]
        at += 12 + length
    row = zlib.decompress(body)
    assert row[0] in (0, 1, 2, 3, 4)  # the first pixel is the same under every filter of the first row
    return tuple(row[1:4])


class Display(CliTest):
    def picture(self, colour, *arguments):
        self.rendered("--method", "uniform", "--png", "p.png", *arguments, scene=SKY.format(colour))
        return first_pixel((self.folder / "p.png").read_bytes())

    def test_exposure(self):
        self.assertEqual(self.picture(".5 .25 .125"), (188, 137, 99))
        self.assertEqual(self.picture(".25 .125 .0625", "--exposure", "1"), (188, 137, 99))
        self.assertEqual(self.picture("2 1 .5", "--exposure=-2"), (188, 137, 99))
        self.assertEqual(self.picture(".25 .125 .0625", "--exposure", "+1"), (188, 137, 99))
        self.assertEqual(self.picture(".5 .25 .125", "--exposure", "0", "--view", "srgb"), (188, 137, 99))

    def test_views(self):
        self.assertEqual(self.picture("4 4 4"), (255, 255, 255))
        filmic = self.picture("4 4 4", "--view", "filmic")
        agx = self.picture("4 4 4", "--view", "agx")
        self.assertTrue(all(180 < v < 250 for v in filmic + agx), (filmic, agx))
        # Grey of 18 % is in the middle of AgX.
        self.assertTrue(all(abs(v - 127) <= 2 for v in self.picture(".18 .18 .18", "--view", "agx")))
        self.assertEqual(self.picture("1 1 1", "--view", "filmic", "--exposure", "2"), filmic)

    def test_the_image_itself_stays(self):
        self.picture(".5 .5 .5", "--exposure", "3", "--view", "agx")
        self.assertAlmostEqual(exr.read(self.folder / "out.exr").pixels["R"][0], 0.5, places=5)

    def test_the_output_may_be_the_picture(self):
        self.rendered("--method", "uniform", "--exposure", "1", output="o.png", scene=SKY.format(".25 .125 .0625"))
        self.assertEqual(first_pixel((self.folder / "o.png").read_bytes()), (188, 137, 99))

    def test_merge_has_them(self):
        self.rendered("--method", "uniform", "--film", "a.film", scene=SKY.format(".25 .125 .0625"))
        result = self.run_program("merge", "a.film", "--png", "m.png", "--exposure", "1")
        self.assertEqual(result.code, DONE, result)
        self.assertEqual(first_pixel((self.folder / "m.png").read_bytes()), (188, 137, 99))

    def test_without_a_picture_they_are_told_of(self):
        for arguments in (["--exposure", "1"], ["--view", "agx"]):
            result = self.render(TINY, "--spp", "1", *arguments)
            self.assertEqual(result.code, DONE, result)
            self.assertIn("no PNG", warnings_of(result)[0][1])
        self.assertEqual(warnings_of(self.render(TINY, "--spp", "1", "--exposure", "0")), [])

    def test_errors(self):
        for wrong in ("", "x", "nan", "inf", "1e9", "1,2"):
            self.assert_fails(self.render(TINY, f"--exposure={wrong}"), USAGE, "--exposure")
        self.assert_fails(self.render(TINY, "--view", "raw"), USAGE, "--view", "srgb|filmic|agx")


if __name__ == "__main__":
    unittest.main()
