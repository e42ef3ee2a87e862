"""Small stacks, as `ulimit -s` and embedded systems have them: the program takes what it needs."""

import unittest

import exr
from support import SANITIZED, CliTest, DONE, SCENE, TINY, limits


@unittest.skipIf(SANITIZED, "a sanitizer's own start takes more")
class SmallStack(CliTest):
    def test_same_image_whatever_the_limit(self):
        for method in ("uniform", "covariance", "hybrid"):
            images = []
            for kilobytes in (64, 256, 8192):
                result = self.render(TINY, "--method", method, "--reproducible", "--png", "out.png", before=limits(STACK=kilobytes << 10))
                self.assertEqual(result.code, DONE, result)
                images.append((self.folder / "out.exr").read_bytes())
            self.assertEqual(images[0], images[1], method)
            self.assertEqual(images[0], images[2], method)

    def test_commands_and_failures(self):
        self.rendered()
        small = limits(STACK=64 << 10)
        for arguments in (("compare", "out.exr", "out.exr"), ("inspect", "out.exr"), ("info", "scene.pbrt"), ("--version",)):
            result = self.run_program(*arguments, before=small)
            self.assertEqual(result.code, DONE, result)
        result = self.render(TINY + 'Shape "cube"\n', before=small)
        self.assert_fails(result, SCENE, "cube")

    def test_nested_blocks(self):
        deep = "\n".join(["AttributeBegin"] * 2000 + ["AttributeEnd"] * 2000)
        result = self.render(TINY + deep, before=limits(STACK=64 << 10))
        self.assertEqual(result.code, DONE, result)
        self.assertGreater(len(exr.read(self.folder / "out.exr").pixels["R"]), 0)


if __name__ == "__main__":
    unittest.main()
