"""The octahedral equal-area map of the sphere that pbrt-v4 uses for environment images.

Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", 2008: the square's centre is
+z, its corners are -z, and equal areas of the square are equal solid angles.
"""

from math import copysign, cos, pi, sin, sqrt


def square_to_direction(s, t):
    """Unit vector of the point (s, t) of [0, 1]^2; t runs down the image."""
    u, v = 2 * s - 1, 2 * t - 1
    distance = 1 - (abs(u) + abs(v))
    radius = 1 - abs(distance)
    phi = pi / 4 if radius == 0 else ((abs(v) - abs(u)) / radius + 1) * pi / 4
    z = copysign(1 - radius * radius, distance)
    planar = radius * sqrt(max(0.0, 2 - radius * radius))
    return (copysign(cos(phi), u) * planar, copysign(sin(phi), v) * planar, z)


def render_map(size, radiance, supersampling):
    """Rows of interleaved RGB floats: the mean of radiance(x, y, z) over each texel."""
    step = 1 / (size * supersampling)
    weight = 1 / supersampling**2
    rows = []
    for y in range(size):
        row = []
        for x in range(size):
            r = g = b = 0.0
            for j in range(supersampling):
                t = (y * supersampling + j + 0.5) * step
                for i in range(supersampling):
                    s = (x * supersampling + i + 0.5) * step
                    color = radiance(*square_to_direction(s, t))
                    r, g, b = r + color[0], g + color[1], b + color[2]
            row += (r * weight, g * weight, b * weight)
        rows.append(row)
    return rows


def mean_cosine(rows):
    """Irradiance of an upward-facing surface over pi, per channel."""
    size = len(rows)
    total = [0.0, 0.0, 0.0]
    for y, row in enumerate(rows):
        for x in range(size):
            cosine = square_to_direction((x + 0.5) / size, (y + 0.5) / size)[2]
            if cosine > 0:
                for channel in range(3):
                    total[channel] += cosine * row[3 * x + channel]
    # Each texel subtends 4 pi / size^2.
    return [4 * value / size**2 for value in total]
