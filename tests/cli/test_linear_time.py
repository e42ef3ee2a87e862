"""Large inputs: the cost of a file grows with its size and not with its square."""

import json
import resource
import unittest

from support import DONE, HEADER, SLOWER, CliTest

FILM = HEADER.replace("24", "48").replace("16", "27")


class LinearTime(CliTest):
    def cpu_seconds(self, *arguments):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        result = self.run_program(*arguments, timeout=300)
        self.assertEqual(result.code, DONE, str(result)[:1000])
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

    def assert_linear(self, few, many, ratio):
        """Asserts at most twice the time of a linear cost, and a second for a machine that does other work."""
        self.assertLess(many, 2 * ratio * few + SLOWER)

    def test_nodes_of_a_gltf_file(self):
        """Nodes that are empty: 13.6 s of 100,000."""
        seconds = []
        for count in (20000, 100000):
            scene = {"asset": {"version": "2.0"}, "scenes": [{"nodes": list(range(count))}], "nodes": [{}] * count}
            self.write("empty.gltf", json.dumps(scene))
            seconds.append(self.cpu_seconds("info", "empty.gltf"))
        self.assert_linear(*seconds, 5)

    def test_parameters_of_a_shape(self):
        """Parameters that are not known: 7 s of 100,000."""
        seconds = []
        for count in (20000, 100000):
            parameters = "".join(f'"float p{i}" {i}\n' for i in range(count))
            self.write("many.pbrt", HEADER + 'WorldBegin\nShape "sphere"\n' + parameters)
            seconds.append(self.cpu_seconds("info", "many.pbrt"))
        self.assert_linear(*seconds, 5)

    def test_parameters_given_by_attribute(self):
        """Beside as many shapes, and beside as many blocks: 9 s of 16,000."""
        for what in ('Shape "sphere"\n', "AttributeBegin AttributeEnd\n", 'Material "diffuse"\n'):
            seconds = []
            for count in (4000, 16000):
                directives = "".join(f'Attribute "shape" "float s{i}" {i} Attribute "material" "float m{i}" {i}\n{what}'
                                     for i in range(count))
                self.write("many.pbrt", HEADER + 'WorldBegin\nShape "sphere"\n' + directives)
                seconds.append(self.cpu_seconds("info", "many.pbrt"))
            self.assert_linear(*seconds, 4)

    def test_narrow_images(self):
        """The reconstruction of one row or one column took ten times that of a square."""
        header = HEADER.replace('"float fov" 40', '"float fov" 40 "float lensradius" .3 "float focaldistance" 6')
        self.write("plain.pbrt", header + 'WorldBegin\nLightSource "infinite"\nShape "sphere"\n')
        seconds = {}
        for size in ("256x256", "65536x1", "1x65536"):
            seconds[size] = self.cpu_seconds("render", "plain.pbrt", "-o", "out.exr", "--spp", "4", "--resolution", size,
                                             "--threads", "1", "--denoiser", "none")
        for size in ("65536x1", "1x65536"):
            # Centres of fits are three pixels apart, in rows and in columns: a row has three times as many.
            self.assertLess(seconds[size], 2 * seconds["256x256"] + SLOWER, seconds)

    def test_outlines_among_instances(self):
        """A cloud of 40,000 in front of a wall: the search took five seconds."""
        side = 34
        places = ((x, y, z) for x in range(side) for y in range(side) for z in range(side))
        instances = "".join(
            f'AttributeBegin\nTranslate {0.1 * (x - side / 2)} {0.1 * (y - side / 2)} {0.1 * (z - side / 2)}\n'
            'ObjectInstance "o"\nAttributeEnd\n' for x, y, z in places)
        self.write("cloud.pbrt", FILM + 'WorldBegin\nLightSource "infinite"\nLightSource "distant" "point3 from" [1 3 1]\n'
                   'ObjectBegin "o"\nShape "sphere" "float radius" 0.003\nObjectEnd\n' + instances +
                   'Shape "bilinearmesh" "point3 P" [-4 -4 -3  4 -4 -3  -4 4 -3  4 4 -3]\n')
        seconds = {}
        for occlusion in ("none", "query"):
            self.cpu_seconds("render", "cloud.pbrt", "-o", "out.exr", "--method", "covariance", "--cov-spp", "4", "--spp", "8",
                             "--occlusion", occlusion, "--threads", "1", "--stats", "s.json")
            statistics = json.loads((self.folder / "s.json").read_text())
            seconds[occlusion] = statistics["seconds"]["covariance"]
        # Paths without outlines cost about what tracing them does.
        self.assertLess(seconds["query"], 6 * seconds["none"] + 0.2 * SLOWER, seconds)


if __name__ == "__main__":
    unittest.main()
