"""Small scenes with random damage: whatever comes, the program ends in order.

The seeds are fixed, so a failure comes again; its scene is in the message."""

import random
import re
import struct
import unittest

from support import DONE, LIMIT, SCENE, CliTest, limits

RICH = """\
LookAt 0 1 6  0 0 0  0 1 0
Camera "perspective" "float fov" 40 "float lensradius" 0.02 "float focaldistance" 6
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "float iso" 100
PixelFilter "gaussian" "float xradius" 1.5
Sampler "zsobol" "integer pixelsamples" 4
Integrator "volpath" "integer maxdepth" 4
WorldBegin
LightSource "infinite" "rgb L" [.1 .2 .3]
LightSource "spot" "point3 from" [2 3 4] "point3 to" [0 0 0] "float coneangle" 30 "rgb I" [10 10 10]
Texture "checks" "spectrum" "checkerboard" "float uscale" 8 "float vscale" 8
    "rgb tex1" [.1 .1 .1] "rgb tex2" [.8 .8 .8]
MakeNamedMaterial "shiny" "string type" "conductor" "float roughness" 0.1
    "spectrum eta" "metal-Cu-eta" "spectrum k" "metal-Cu-k"
MakeNamedMaterial "glass" "string type" "dielectric" "float eta" 1.5
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [3 3 3]
  Translate 0 3 0
  Rotate 90 1 0 0
  Shape "disk" "float radius" 0.5
AttributeEnd
ObjectBegin "thing"
  NamedMaterial "glass"
  Shape "sphere" "float radius" 0.5
ObjectEnd
AttributeBegin
  ActiveTransform EndTime
  Translate 0.5 0 0
  ActiveTransform All
  NamedMaterial "shiny"
  Shape "plymesh" "string filename" "mesh.ply"
AttributeEnd
AttributeBegin
  Scale 2 1 1
  ObjectInstance "thing"
AttributeEnd
Material "coateddiffuse" "texture reflectance" "checks" "float roughness" 0.3
Shape "bilinearmesh" "point3 P" [-4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4]
Shape "trianglemesh" "point3 P" [-1 0 0  1 0 0  0 1 0] "integer indices" [0 1 2]
"""

PLY = """\
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
-1 0 1
1 0 1
1 1 1
-1 1 1
3 0 1 2
4 0 1 2 3
"""

TOKENS = re.compile(r'"[^"\n]*"|[\[\]]|[^\s\[\]"]+')
STRANGE = (
    '0 -1 1e38 -1e38 1e-38 3e9 nan inf 99999999999999999999 0x10 .5. -- "" "sphere" "float radius" '
    '"integer indices" "rgb L" "shiny" [ ] true "true" # Shape AttributeBegin AttributeEnd WorldBegin '
    'ObjectEnd Identity ReverseOrientation "\\"'
).split(" ")


def mutate_tokens(text, rng):
    """Deletes, doubles, swaps or replaces one to three tokens."""
    for _ in range(rng.randint(1, 3)):
        spans = [m.span() for m in TOKENS.finditer(text)]
        begin, end = rng.choice(spans)
        other = text[slice(*rng.choice(spans))]
        new = rng.choice(("", text[begin:end] + " " + text[begin:end], other, rng.choice(STRANGE)))
        text = text[:begin] + new + text[end:]
    return text.encode()


def mutate_bytes(data, rng):
    """Changes one to five bytes, or cuts the end off."""
    data = bytearray(data)
    if rng.random() < 0.1:
        return bytes(data[: rng.randrange(len(data))])
    for _ in range(rng.randint(1, 5)):
        at = rng.randrange(len(data))
        kind = rng.randrange(3)
        if kind == 0:
            data[at] = rng.randrange(256)
        elif kind == 1:
            data[at] ^= 1 << rng.randrange(8)
        else:
            del data[at : at + rng.randint(1, 4)]
    return bytes(data)


def binary_mesh():
    header = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    )
    points = (-1, 0, 1), (1, 0, 1), (1, 1, 1), (-1, 1, 1)
    return (
        header.encode()
        + b"".join(struct.pack("<3f", *p) for p in points)
        + struct.pack("<B3iB4i", 3, 0, 1, 2, 4, 0, 1, 2, 3)
    )


class Mutations(CliTest):
    def check(self, scene, mesh, damaged):
        self.write("mesh.ply", mesh)
        result = self.render(
            scene, "--spp", "1", "--resolution", "8x8", "--threads", "1", "--quiet", before=limits(AS=4 << 30, CORE=0), timeout=20
        )
        self.assertIn(result.code, (DONE, SCENE, LIMIT), f"{result}\n{damaged!r}")
        if result.code != DONE:
            self.assert_fails(result, result.code)

    def test_whole(self):
        for mesh in (PLY.encode(), binary_mesh()):
            self.write("mesh.ply", mesh)
            result = self.render(RICH, "--spp", "1", "--resolution", "8x8")
            self.assertEqual(result.code, DONE, result)
            self.assertNotIn("warning", result.stderr)

    def test_scene_tokens(self):
        rng = random.Random(1)
        for number in range(150):
            with self.subTest(number=number):
                scene = mutate_tokens(RICH, rng)
                self.check(scene, PLY, scene)

    def test_scene_bytes(self):
        rng = random.Random(2)
        for number in range(100):
            with self.subTest(number=number):
                scene = mutate_bytes(RICH.encode(), rng)
                self.check(scene, PLY, scene)

    def test_mesh_bytes(self):
        rng = random.Random(3)
        for number in range(100):
            with self.subTest(number=number):
                mesh = mutate_bytes(PLY.encode() if number % 2 else binary_mesh(), rng)
                self.check(RICH, mesh, mesh)


if __name__ == "__main__":
    unittest.main()
