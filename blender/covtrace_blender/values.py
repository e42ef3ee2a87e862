"""Values that sockets of shader nodes get: constants, images with their place and treatment, and those that hang on the angle of sight."""

import numpy as np

from .working_space import luminance

PLAIN_MAPPING = (1, 1, 0, 0)


class Value:
    """A constant, or an image with a treatment. varies: whether it takes a texture to tell it."""

    def __init__(self, constant=None, image=None, mapping=None, channel=None, scale=1.0, offset=0.0, filter="bilinear",
                 wrap="repeat"):
        self.constant, self.image, self.mapping, self.channel = constant, image, mapping, channel
        self.scale, self.offset, self.filter, self.wrap = scale, offset, filter, wrap

    @property
    def varies(self):
        return self.image is not None

    def inverse(self, whole=1.0):
        """whole - this."""
        return self.times(-1, whole)

    def times(self, factor, further=0.0):
        """This `factor` times, and a further number."""
        if self.image:
            return Value(image=self.image, mapping=self.mapping, channel=self.channel, scale=factor * self.scale,
                         offset=factor * self.offset + further, filter=self.filter, wrap=self.wrap)
        if hasattr(self.constant, "__len__"):
            return Value(tuple(factor * c + further for c in self.constant))
        return Value(factor * self.constant + further)

    def clipped(self):
        """This number, in [0, 1]; images are in files that hold no others."""
        return self if self.image else Value(min(max(self.constant, 0.0), 1.0))

    def is_plainly_placed(self):
        return self.mapping == PLAIN_MAPPING and self.filter == "bilinear" and self.wrap == "repeat" or not self.varies

    def apply(self, pixels):
        """(h, w, 3 or 4) to (h, w, 3), or to (h, w) where one number is wanted."""
        if self.channel == "grey":
            values = luminance(pixels[..., :3])
        elif self.channel is not None:
            values = pixels[..., "RGBA".index(self.channel)]
        else:
            values = pixels[..., :3]
        return values * self.scale + self.offset

    def key(self):
        return (self.channel, self.scale, self.offset)


class ByAngle(Value):
    """Values at some cosines of the angle of sight, in rising order, linear in between: `parts`, all of them constants or all images."""

    varies = True

    def __init__(self, cosines, parts):
        super().__init__()
        self.cosines, self.parts = cosines, parts

    def times(self, factor, further=0.0):
        return ByAngle(self.cosines, [part.times(factor, further) for part in self.parts])

    def clipped(self):
        return ByAngle(self.cosines, [part.clipped() for part in self.parts])

    def resampled(self, most):
        """The same of constants at `most` cosines, between which it changes about as much."""
        values = np.array([part.constant for part in self.parts], float)
        rows = values.reshape(len(values), -1)
        way = np.concatenate(([0], np.cumsum(np.abs(np.diff(rows, axis=0)).max(axis=1) + 1e-6)))
        cosines = np.interp(np.linspace(0, way[-1], most), way, self.cosines)
        rows = np.column_stack([np.interp(cosines, self.cosines, column) for column in rows.T])
        parts = [Value(float(row[0]) if values.ndim == 1 else tuple(float(v) for v in row)) for row in rows]
        return ByAngle([float(c) for c in cosines], parts)

    def is_plainly_placed(self):
        return all(part.is_plainly_placed() for part in self.parts)


class Between(Value):
    """Between two images by the angle of sight: the share of the second is `share`, a ByAngle of constants in [0, 1]."""

    varies = True

    def __init__(self, first, second, share):
        super().__init__()
        self.first, self.second, self.share = first, second, share

    def times(self, factor, further=0.0):
        return Between(self.first.times(factor, further), self.second.times(factor, further), self.share)

    def clipped(self):
        return self

    def is_plainly_placed(self):
        return self.first.is_plainly_placed() and self.second.is_plainly_placed()

    def key(self):
        """Tells what it makes of the first image from others."""
        return (self.first.key(), self.second.image.name_full, self.second.key())
