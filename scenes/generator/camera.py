"""A look-at camera in a right-handed world, z up: pbrt text and projection to pixels."""

from math import radians, sqrt, tan


def subtract(a, b):
    """a - b"""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    """Right-handed vector product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def normalize(a):
    """a with length one."""
    length = sqrt(dot(a, a))
    return (a[0] / length, a[1] / length, a[2] / length)


class Camera:
    """Perspective camera; `fov` in degrees spans the shorter image axis, as in pbrt."""

    def __init__(self, eye, target, fov, resolution):
        self.eye, self.target, self.fov, self.resolution = eye, target, fov, resolution
        self.forward = normalize(subtract(target, eye))
        self.right = normalize(cross(self.forward, (0, 0, 1)))
        self.up = cross(self.right, self.forward)

    def depth(self, point):
        """Distance along the optical axis, in the sense of pbrt's focaldistance."""
        return dot(subtract(point, self.eye), self.forward)

    def project(self, point):
        """Pixel (x right, y down) of a point in front of the camera."""
        offset = subtract(point, self.eye)
        width, height = self.resolution
        scale = min(width, height) / 2 / tan(radians(self.fov) / 2) / self.depth(point)
        return (
            width / 2 + scale * dot(offset, self.right),
            height / 2 - scale * dot(offset, self.up),
        )

    def emit(self, scene, parameters):
        """Adds the transform and the Camera directive."""
        # pbrt's LookAt is left-handed; this keeps the right-handed world (and its writing)
        # from appearing mirrored.
        scene.plain("Scale", -1, 1, 1)
        scene.plain("LookAt", *self.eye, *self.target, 0, 0, 1)
        scene.entity("Camera", "perspective", {"float fov": self.fov, **parameters})
