"""covtrace.Image.write: the name of a file says its format."""

import os
import tempfile
import unittest

import numpy

import covtrace


class Formats(unittest.TestCase):
    def test_the_name_says_the_format(self):
        rgb = numpy.random.default_rng(1).random((5, 7, 3), dtype=numpy.float32)
        image = covtrace.Image.from_arrays(rgb, layers={"Z": rgb[:, :, 0]})
        with tempfile.TemporaryDirectory() as folder:
            for name, magic, error in (("a.exr", b"\x76\x2f\x31\x01", 0), ("a", b"\x76\x2f\x31\x01", 0), ("a.PNG", b"\x89PNG", 0.01),
                                       ("a.pfm", b"PF", 0), ("a.hdr", b"#?RADIANCE", 0.004)):
                file = os.path.join(folder, name)
                image.write(file)
                with open(file, "rb") as written:
                    self.assertEqual(written.read(len(magic)), magic)
                self.assertLessEqual(numpy.abs(covtrace.Image.read(file).rgb - rgb).max(), error)


if __name__ == "__main__":
    unittest.main()
