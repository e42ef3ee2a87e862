"""Meshes in files, of which each has one material; objects consist of them."""

from .placement import placement
from .shader_nodes.light_path import RAYS
from .visibility import hidden_from


class Part:
    """A mesh in a file, with a Variant of its material. motion: its transforms when the shutter opens and closes, or None.
    tube_sides: sides of the tubes that it consists of; 0: it is no strands."""

    def __init__(self, file, variant, motion, tube_sides):
        self.file, self.variant, self.motion, self.tube_sides = file, variant, motion, tube_sides

    def text(self, hidden, is_holdout):
        """pbrt's light and shape of it. hidden: the kinds of rays that do not see it; is_holdout: whether all of its object is one."""
        emission, light = self.variant.emission, ""
        if emission:
            passes = ' "bool letslightpass" true' if self.variant.is_light_alone else ""
            light = f'AreaLightSource "diffuse" {emission.parameters()} "bool twosided" true{passes}\n'
        # Media end at their border for every ray.
        unseen = set() if self.variant.is_volume_alone else hidden | (set(RAYS) - set(self.variant.rays))
        tubes = f' "integer tubesides" {self.tube_sides}' if self.tube_sides else ""
        hole = ' "bool holdout" true' if is_holdout or self.variant.is_holdout else ""
        return light + self.shapes(f"{self.variant.alpha}{hidden_from(unseen)}{tubes}{hole}")

    def shapes(self, parameters):
        """pbrt's shapes, with parameters that all of them have."""
        return f'Shape "plymesh" "string filename" "{self.file}" {parameters}\n'


def write_parts(out, media, parts, hidden, is_holdout, around, matrix):
    """Writes Parts in their object's space. media: a Media; around: names of those that the object stands in; matrix: its own, to the
    world."""
    for part in parts:
        out.write(f'AttributeBegin\nNamedMaterial "{part.variant.name}"\n')
        if part.variant.medium:
            inner = media.sum((media.placed(part.variant.medium, matrix), *around))
            out.write(f'MediumInterface "{inner}" "{media.sum(around)}"\n')
        if part.motion is not None:
            out.write(placement("ConcatTransform", *part.motion))
        out.write(f"{part.text(hidden, is_holdout)}AttributeEnd\n")
