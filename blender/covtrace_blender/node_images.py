"""Images as nodes read them: whether a node's Alpha is used decides, in Cycles, whether its colours are multiplied by the opacity."""

import bpy

MISSING = (1, 0, 1, 1)  # linear; the magenta by which Blender shows images whose files are missing
HAVE_OPACITY = ("STRAIGHT", "PREMUL")  # ways of images in which alpha is opacity, and no further channel


class NodeImage:
    """An image of Blender's whose colours are multiplied by its opacity, or divided by it where is_multiplied, against how Blender has
    its pixels."""

    def __init__(self, image, is_multiplied):
        self.is_multiplied = is_multiplied
        self.image, self.name_full = image, f"{image.name_full} by its other opacity"

    def __getattr__(self, name):
        return getattr(self.image, name)

    def __eq__(self, other):
        return isinstance(other, NodeImage) and self.image == other.image

    def __hash__(self):
        return hash(self.name_full)


def image_of(node):
    """The image of a node Image Texture, or its NodeImage: colours alone are multiplied by the opacity, and beside it they are not."""
    image = node.image
    if image.channels != 4 or image.source == "TILED" or image.alpha_mode not in HAVE_OPACITY or image.colorspace_settings.is_data:
        return image
    # Blender has bytes without opacity, and floats with it; Cycles 5.3 goes by the image's own words. Versions from 5.0 on were not tried.
    is_multiplied = image.alpha_mode == "PREMUL" if bpy.app.version >= (5, 3, 0) else image.is_float
    return image if node.outputs["Alpha"].is_linked != is_multiplied else NodeImage(image, is_multiplied)


def with_other_opacity(values, is_multiplied):
    """The (h, w, 4) pixels of a NodeImage, as the file has them, of an image's own."""
    opacity = values[..., 3:]
    if (opacity == 1).all():
        return values
    colours = values[..., :3]
    values[..., :3] = colours / opacity.clip(1e-6) * (opacity > 0) if is_multiplied else colours * opacity
    return values
