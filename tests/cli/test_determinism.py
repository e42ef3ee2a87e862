"""The same command gives the same bits, whatever the number of threads."""

import json
import unittest

import exr
from support import DONE, TINY, CliTest

MOVING = TINY + """\
AttributeBegin
  ActiveTransform EndTime
  Translate 0.5 0 0
  ActiveTransform All
  Material "conductor" "float roughness" 0.2
  Translate 1.5 0 1
  Shape "sphere" "float radius" 0.4
AttributeEnd
"""


# Ways in which a render decides on its samples, all of them.
WAYS = {
    "uniform": ["--method", "uniform"],
    "covariance": ["--method", "covariance"],
    "on-demand": ["--method", "covariance", "--progressive", "--density", "thesis"],
    "hybrid": ["--method", "hybrid"],
}


class Determinism(CliTest):
    def compare(self, a, b):
        result = self.run_program("compare", a, b, "--json")
        self.assertEqual(result.code, DONE, result)
        return json.loads(result.stdout)

    def test_threads_do_not_matter(self):
        for name, way in WAYS.items():
            images = [
                self.rendered(
                    *way, "--threads", threads, "--resolution", "48x36", "--spp", "12", "--reproducible",
                    output=f"{name}-{threads}.exr", scene=MOVING,
                )
                for threads in (1, 2, 3)
            ]
            for other in images[1:]:
                with self.subTest(way=name, other=other.name):
                    self.assertIs(self.compare(images[0], other)["identical"], True)
                    self.assertEqual(images[0].read_bytes(), other.read_bytes())

    def test_two_runs_give_the_same_file(self):
        for method in ("uniform", "covariance", "hybrid"):
            with self.subTest(method=method):
                first = self.rendered("--method", method, "--reproducible", output="1.exr")
                second = self.rendered("--method", method, "--reproducible", output="2.exr")
                self.assertEqual(first.read_bytes(), second.read_bytes())

    def test_metadata_do_not_count_as_different(self):
        first = self.rendered("--seed", "1", output="1.exr")
        second = self.rendered("--seed", "1", "--reproducible", output="2.exr")
        self.assertNotEqual(first.read_bytes(), second.read_bytes())
        self.assertIs(self.compare(first, second)["identical"], True)

    def test_the_seed_changes_the_noise(self):
        for method in ("uniform", "covariance", "hybrid"):
            with self.subTest(method=method):
                first = self.rendered("--method", method, "--seed", "1", output="1.exr")
                second = self.rendered("--method", method, "--seed", "2", output="2.exr")
                self.assertIs(self.compare(first, second)["identical"], False)
                largest = self.rendered("--method", method, "--seed", str(2**64 - 1), output="3.exr")
                self.assertIs(self.compare(first, largest)["identical"], False)

    def test_seed_zero_is_the_default(self):
        self.assertIs(
            self.compare(self.rendered(output="1.exr"), self.rendered("--seed", "0", output="2.exr"))["identical"], True
        )

    def test_methods_share_their_first_samples(self):
        """Covariance paths are ordinary paths: where both methods took the same samples they found the same."""
        uniform = exr.read(self.rendered("--method", "uniform", "--spp", "4", output="1.exr"))
        adaptive = exr.read(self.rendered("--method", "covariance", "--spp", "4", output="2.exr"))
        same = [
            i for i, (a, b) in enumerate(zip(uniform.pixels["samples.Y"], adaptive.pixels["samples.Y"])) if a == b
        ]
        self.assertGreater(len(same), 0)
        for i in same:
            self.assertEqual(uniform.pixels["raw.G"][i], adaptive.pixels["raw.G"][i])


if __name__ == "__main__":
    unittest.main()
