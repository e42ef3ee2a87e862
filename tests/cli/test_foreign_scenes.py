"""Scenes of formats that are not read: the message says so, and which formats are read."""

import unittest

from support import SCENE, CliTest


class Foreign(CliTest):
    def test_each_is_named(self):
        for name, content, fragment in (
            ("x.blend", b"BLENDER-v304" + bytes(64), "Blender"),
            ("X.BLEND", b"\x28\xb5\x2f\xfd", "Blender"),
            ("x.usd", b"#usda 1.0\n", "USD"),
            ("x.usda", b"#usda 1.0\n", "USD"),
            ("x.usdc", b"PXR-USDC", "USD"),
            ("x.xml", b'<scene version="3.0.0"></scene>', "Mitsuba"),
            ("x.obj", b"v 0 0 0\n", "mesh"),
        ):
            self.write(name, content)
            for command in (["render", name], ["info", name], ["measure", name, "--pixel", "0,0"]):
                with self.subTest(command=command):
                    self.assert_fails(
                        self.run_program(*command, timeout=10), SCENE, f"{name}: ", fragment, "format", ".pbrt", ".gltf", ".glb"
                    )
        self.assert_fails(self.run_program("render", "x.blend"), SCENE, "blender/")

    def test_what_is_not_there_is_not_found(self):
        self.assert_fails(self.run_program("render", "none.blend"), SCENE, "none.blend", "not found")


if __name__ == "__main__":
    unittest.main()
