"""Blackbody nodes: the colour of a temperature, of luminance 1 as in Cycles."""

import functools

import numpy as np

from ..working_space import from_rec709


def temperature_of(node):
    """Kelvin; None where it is linked."""
    socket = node.inputs["Temperature"]
    return None if socket.is_linked else float(socket.default_value)


def blackbody_temperature(socket):
    """Temperature of the Blackbody node that feeds a socket, where it is fixed; None where there is no such node."""
    node = socket.links[0].from_node if socket.is_linked else None
    return temperature_of(node) if node is not None and node.type == "BLACKBODY" else None


def _matching(nanometres):
    """(3, n) CIE 1931 x, y, z by the fit of Wyman, Sloan, Shirley, "Simple Analytic Approximations to the CIE XYZ Color
    Matching Functions", JCGT 2(2), 2013, section 2.2."""
    def lobe(height, middle, below, above):
        t = (nanometres - middle) * np.where(nanometres < middle, below, above)
        return height * np.exp(-0.5 * t * t)
    return np.stack([
        lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(-0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)])


HEATS = np.geomspace(800, 12000, 256)  # at which blackbodies() is exact; between them it is off by less than a thousandth


def blackbodies(kelvin):
    """(n, 3) or (3,) of (n,) temperatures or one."""
    return from_rec709(np.stack([np.interp(kelvin, HEATS, channel) for channel in _table()], axis=-1).astype(np.float32))


@functools.cache
def _table():
    """(3, n) linear Rec.709 of HEATS."""
    return np.array([_in_rec709(heat) for heat in HEATS]).T


def blackbody(kelvin):
    """Planck's law in the scene's colour space; Cycles' range of 800 to 12000 K."""
    return tuple(float(c) for c in from_rec709(_in_rec709(kelvin)))


def _in_rec709(kelvin):
    kelvin = min(max(kelvin, 800.0), 12000.0)
    nanometres = np.arange(380.0, 781.0, 1.0)
    second_constant = 1.438776877e7  # h c / k in nm K
    planck = nanometres**-5.0 / np.expm1(second_constant / (nanometres * kelvin))
    x, y, z = _matching(nanometres) @ planck
    to_rgb = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                       [0.0556434, -0.2040259, 1.0572252]])  # IEC 61966-2-1
    rgb = to_rgb @ np.array([x, y, z]) / y
    return np.maximum(rgb, 0)
