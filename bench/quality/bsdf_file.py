#!/usr/bin/python3
"""Writes a measured BRDF (".bsdf", as of the RGL material database) of a surface that is known.

    bench/quality/bsdf_file.py diffuse REFLECTANCE FILE
    bench/quality/bsdf_file.py ggx ALPHA FILE

Both are grey: a Lambertian surface, or GGX microfacets that reflect everything. The tables follow Dupuy and Jakob
2018, "An adaptive parameterization for efficient material acquisition and rendering". Visible normals are tabulated as
evenly spread over the unit square, which any BRDF may be written with: renderers then sample it badly, but right.
scenes/tests/data/half.bsdf is `diffuse 0.5`, scenes/tests/data/metal.bsdf is `ggx 0.4`. Needs numpy.
"""
import struct
import sys

import numpy as np

THETAS, SIDE = 12, 16
NORMALS = 32  # nodes of the distribution of normals


def direction(u, v):
    theta, phi = u * u * np.pi / 2, (2 * v - 1) * np.pi
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


def square(side):
    """The nodes of a table, row by row: u along a row, v from row to row."""
    v, u = np.meshgrid(np.linspace(0, 1, side), np.linspace(0, 1, side), indexing="ij")
    return u, v


def stretched(w, alpha):
    return np.sqrt(w[..., 2] ** 2 + alpha**2 * (w[..., 0] ** 2 + w[..., 1] ** 2))


def density(m, alpha):
    return 1 / (np.pi * alpha**2 * ((m[..., 0] ** 2 + m[..., 1] ** 2) / alpha**2 + m[..., 2] ** 2) ** 2)


def tensor(fields):
    head = b"tensor_file\0" + struct.pack("<BBI", 1, 0, len(fields))
    size = len(head) + sum(2 + len(name) + 2 + 1 + 8 + 8 * a.ndim for name, a in fields)
    data = b""
    for name, a in fields:
        kind = {np.dtype(np.uint8): 1, np.dtype(np.float32): 10}[a.dtype]
        head += struct.pack("<H", len(name)) + name.encode() + struct.pack("<HBQ", a.ndim, kind, size + len(data))
        head += struct.pack(f"<{a.ndim}Q", *a.shape)
        data += a.tobytes()
    return head + data


def main():
    kind, number, file = sys.argv[1], float(sys.argv[2]), sys.argv[3]
    theta = np.linspace(0, np.pi / 2 * 0.995, THETAS)
    m = direction(*square(SIDE))
    if kind == "ggx":
        normals = density(direction(*square(NORMALS)), number)
        w = direction(*square(NORMALS))
        areas = (w[..., 2] + stretched(w, number)) / 2
    else:
        normals = areas = np.ones((2, 2))
    factors = np.empty((THETAS, SIDE, SIDE))
    for i, t in enumerate(theta):
        wo = np.array([np.sin(t), 0, np.cos(t)])
        wi = 2 * (m @ wo)[..., None] * m - wo
        cosine = np.maximum(wi[..., 2], 0)
        if kind == "ggx":  # masking over that of the viewer
            so, si = stretched(wo, number), stretched(wi, number)
            factors[i] = np.where(cosine > 0, cosine * (wo[2] + so) / np.maximum(so * cosine + si * wo[2], 1e-9), 0)
        else:  # the microfacets of these tables give 1 / 4
            factors[i] = 4 * number / np.pi * cosine
    f32 = lambda a: np.ascontiguousarray(a, dtype=np.float32)  # noqa: E731
    wavelengths = np.array([360, 830])
    fields = [
        ("description", np.frombuffer(f"{kind} {number:g}".encode(), dtype=np.uint8)),
        ("jacobian", np.array([1], dtype=np.uint8)),
        ("phi_i", f32([0])),
        ("theta_i", f32(theta)),
        ("wavelengths", f32(wavelengths)),
        ("ndf", f32(normals)),
        ("sigma", f32(areas)),
        ("vndf", f32(np.ones((1, THETAS, 2, 2)))),
        ("luminance", f32(factors[None] + 1e-3)),
        ("spectra", f32(np.repeat(factors[None, :, None], len(wavelengths), axis=2))),
    ]
    with open(file, "wb") as out:
        out.write(tensor(fields))


if __name__ == "__main__":
    main()
