"""Meshes in files, of which each has one material; objects consist of them."""


class Part:
    """A mesh in a file, with a Variant of its material. motion: its transforms when the shutter opens and closes, or None.
    tube_sides: sides of the tubes that it consists of; 0: it is no strands."""

    def __init__(self, file, variant, motion, tube_sides):
        self.file, self.variant, self.motion, self.tube_sides = file, variant, motion, tube_sides
