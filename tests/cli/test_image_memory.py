"""Images that are little on disk and gigabytes decoded: images that are too large are refused before they are
decoded."""

import json
import struct
import unittest
import zlib

from support import DONE, HEADER, LIMIT, SANITIZED, CliTest, limits

SIDE = 16384
TEXTURE = 'Texture "t" "spectrum" "imagemap" "string filename" "{}"\nMaterial "diffuse" "texture reflectance" "t"\n'
ENVIRONMENT = 'LightSource "infinite" "string filename" "{}"\n'


def png(width, height):
    """A black PNG, a thousandth of its pixels' size."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    packer, row = zlib.compressobj(9), bytes(1 + 3 * width)
    data = b"".join(packer.compress(row) for _ in range(height)) + packer.flush()
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) + chunk(b"IDAT", data)
            + chunk(b"IEND", b""))


def qoi(width, height):
    """A black QOI image, in runs of 62 pixels."""
    return b"qoif" + struct.pack(">IIBB", width, height, 3, 0) + b"\xfd" * (width * height // 62 + 1) + bytes(8)


# Formats other than PNG have the header alone here: none is decoded.
BOMBS = {
    "bomb.qoi": qoi(SIDE, SIDE),
    "bomb.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (SIDE, SIDE),
    "bomb.pfm": b"PF\n%d %d\n-1.0\n" % (SIDE, SIDE),
    "bomb.ppm": b"P6\n%d %d\n255\n" % (SIDE, SIDE),
    "bomb.tga": struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, SIDE, SIDE, 24, 0x20),
}


class ImageMemory(CliTest):
    def scene_with(self, world):
        self.write("scene.pbrt", HEADER + 'WorldBegin\nLightSource "infinite"\n' + world + 'Shape "sphere"\n')
        return ["render", "scene.pbrt", "-o", "out.exr", "--spp", "1"]

    def test_bombs_are_refused_by_their_headers(self):
        """Bombs are refused: a PNG of 780 KB took 4.2 GB as a texture and 7.1 as an environment."""
        for name, content in {"bomb.png": png(SIDE, SIDE), **BOMBS}.items():
            self.write(name, content)
            for world in (TEXTURE, ENVIRONMENT):
                with self.subTest(file=name, role=world.split()[0]):
                    # An address space of 1 GiB is enough to refuse the image.
                    result = self.run_program(*self.scene_with(world.format(name)), "--max-memory", "500M",
                                              before=limits(AS=1 << 30))
                    self.assert_fails(result, LIMIT, name, "the limit of 500M", f"{SIDE}x{SIDE}")

    @unittest.skipIf(SANITIZED, "a sanitizer needs more address space than there is")
    def test_what_the_system_refuses_is_a_limit_too(self):
        self.write("bomb.png", png(SIDE, SIDE))
        for world in (TEXTURE, ENVIRONMENT):
            for space in (600 << 20, 2 << 30):
                with self.subTest(role=world.split()[0], space=space):
                    result = self.run_program(*self.scene_with(world.format("bomb.png")), "--max-memory", "64G",
                                              before=limits(AS=space), timeout=300)
                    if result.code != DONE or space < 1 << 30:
                        self.assert_fails(result, LIMIT, "bomb.png")

    @unittest.skipIf(SANITIZED, "a sanitizer takes several times what the program does")
    def test_a_texture_of_bytes_is_decoded_as_bytes(self):
        """The texture takes its pixels and a third of them, not their fourfold as numbers."""
        self.write("texture.png", png(8192, 4096))  # 96 MiB
        arguments = self.scene_with(TEXTURE.format("texture.png"))
        result = self.run_program(*arguments, "--max-memory", "220M", "--stats", "s.json")
        self.assertEqual(result.code, DONE, result)
        peak = json.loads((self.folder / "s.json").read_text())["memory"]["peak_resident"]
        self.assertLess(peak, 230 << 20)

    def test_textures_that_fit_one_after_the_other(self):
        """Textures are read side by side, eight of 24 MiB; with pages for what is read they fit into a fifth of
        that."""
        for i in range(8):
            self.write(f"{i}.png", png(4096, 2048))
        world = "".join(TEXTURE.format(f"{i}.png").replace('"t"', f'"t{i}"') + f'Shape "sphere" "float radius" {1 + i}\n'
                        for i in range(8))
        result = self.run_program(*self.scene_with(world), "--max-memory", "150M", "--texture-memory", "10M")
        if not SANITIZED:
            self.assertEqual(result.code, DONE, result)


if __name__ == "__main__":
    unittest.main()
