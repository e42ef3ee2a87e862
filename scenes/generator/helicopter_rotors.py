"""The toy helicopter's rotors: hubs and blades as meshes. Decimetres; they turn about z."""

from math import cos, pi, radians, sin, sqrt

from .loft import loft, tube
from .mesh import Mesh, lathe


def _rounded(t):
    """Half width of a round end at t of its length from the tip; one behind it."""
    return sqrt(max(1e-5, 1 - (1 - min(t, 1.0)) ** 2))


def _blade(start, end, chord, thickness, twist, coning, turn):
    """A twisted aerofoil from radius `start` to `end` (angles in degrees). uv: v along the span."""
    sections, along = [], []
    count = 40
    for i in range(count + 1):
        t = i / count
        size = _rounded(t / 0.12) * _rounded((1 - t) / 0.05)
        r = start + (end - start) * t
        pitch = radians(twist * (1.3 - 0.6 * t))
        section = []
        for k in range(28):
            a = 2 * pi * k / 28
            y, z = 0.5 * size * chord * cos(a), 0.5 * size * thickness * sin(a)
            y, z = y * cos(pitch) - z * sin(pitch), y * sin(pitch) + z * cos(pitch)
            z += r * sin(radians(coning))
            c, s = cos(turn), sin(turn)
            section.append((r * c - y * s, r * s + y * c, z))
        sections.append(section)
        along.append(t)
    return loft(sections, along=along)


def main_blades(count, radius):
    """Blades at equal angles."""
    mesh = Mesh()
    for i in range(count):
        mesh.append(_blade(0.24, radius, 0.44, 0.055, 9, 2.5, 2 * pi * i / count))
    return mesh


def main_hub(count):
    """Hub with a cap, and a grip for each blade."""
    profile = [(0.15, -0.07), (0.16, 0.03), (0.13, 0.08), (0.07, 0.1), (0.06, 0.17), (1e-4, 0.19)]
    mesh = lathe(profile, 40)
    for i in range(count):
        turn = 2 * pi * i / count
        ends = [(r * cos(turn), r * sin(turn), 0.035 * r) for r in (0.1, 0.2, 0.3, 0.4)]
        mesh.append(tube(ends, (0.055, 0.055, 0.05, 0.04), 16))
    return mesh


def tail_blades(radius):
    """Two small blades."""
    mesh = Mesh()
    for turn in (0.0, pi):
        mesh.append(_blade(0.05, radius, 0.13, 0.025, 14, 0, turn))
    return mesh


def tail_hub():
    """A small hub on a stub shaft."""
    return lathe([(0.035, -0.17), (0.035, -0.04), (0.06, -0.03), (0.06, 0.03), (1e-4, 0.05)], 24)
