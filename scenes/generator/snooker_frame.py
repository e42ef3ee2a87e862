"""A frame of snooker on the table of the demo: fifteen reds, six colours and the white."""

from . import snooker
from .snooker_balls import Ball, BallSet

NAME = "snooker-frame"
HEADER = """
snooker-frame: depth of field, motion blur and glossy reflection, after figures 5.9 and 5.10 of
Belcour's thesis. Metres, z up. Fifteen reds, six colours and a spotted white, all polished, on a
woven cloth under an environment map; the lens is open and focused on the blue ball, and the white
rolls while the shutter is open. All files beside this one were made by scenes/generate.py.
"""

_COLORS = {
    "red": (0.42, 0.008, 0.012),
    "yellow": (0.78, 0.50, 0.02),
    "green": (0.01, 0.22, 0.07),
    "brown": (0.21, 0.075, 0.025),
    "blue": (0.02, 0.11, 0.42),
    "pink": (0.76, 0.29, 0.36),
    "black": (0.022, 0.022, 0.025),
}
_PLAIN = {
    name: ("coateddiffuse", {"rgb reflectance": list(color), "float roughness": 0.0})
    for name, color in _COLORS.items()
}
# Where the balls of the demo lie; the first one is in focus. Nine of the reds have left the pack.
_RESTING = [
    Ball("blue", 0.0, 0.0),
    Ball("red", -0.058, -0.066),
    Ball("yellow", 0.016, 0.104),
    Ball("red", 0.085, -0.062),
    Ball("red", 0.104, 0.036),
    Ball("green", -0.118, 0.112),
    Ball("brown", 0.235, -0.225),
    Ball("pink", 0.205, -0.100),
    Ball("red", 0.170, 0.160),
    Ball("red", 0.245, -0.010),
    Ball("black", 0.262, 0.092),
    Ball("red", 0.400, -0.255),
    Ball("red", 0.310, 0.255),
    Ball("red", 0.440, -0.085),
    Ball("red", 0.480, 0.140),
]
_PACK_ROWS = 3


def write(folder):
    """Writes the scene and its assets."""
    snooker.write_table(folder, NAME, HEADER, BallSet({}, _PLAIN, _RESTING, _PACK_ROWS))
