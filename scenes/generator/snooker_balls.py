"""The balls of the snooker scene: where they lie, how they are turned, what they are made of."""

from dataclasses import dataclass
from itertools import combinations
from math import atan2, cos, degrees, dist, hypot, pi, sin, sqrt

from .ball_decals import IVORY

RADIUS = 0.02625

# The ball in focus, and the direction (in the plane) in which the camera looks over it.
FOCUS = (0.55, -0.05)
VIEW_ANGLE = 0.465
_AHEAD = (cos(VIEW_ANGLE), sin(VIEW_ANGLE))
_RIGHT = (sin(VIEW_ANGLE), -cos(VIEW_ANGLE))


def place(ahead, right, height=RADIUS):
    """World point `ahead` of and to the `right` of the focus, as the camera sees it (metres)."""
    return (
        FOCUS[0] + ahead * _AHEAD[0] + right * _RIGHT[0],
        FOCUS[1] + ahead * _AHEAD[1] + right * _RIGHT[1],
        height,
    )


@dataclass(frozen=True)
class Ball:
    """A resting ball. A number faces the camera when `turn`, `tilt` and `roll` (degrees) are 0."""

    name: str
    ahead: float
    right: float
    turn: float = 0.0
    tilt: float = 0.0
    roll: float = 0.0

    @property
    def center(self):
        """World position of the centre."""
        return place(self.ahead, self.right)

    def rotations(self, eye):
        """Rotate directives that turn the number (local +y) towards the eye, then off it."""
        x, y, _ = self.center
        towards = degrees(atan2(eye[1] - y, eye[0] - x))
        return [
            ("Rotate", towards - 90 + self.turn, 0, 0, 1),
            ("Rotate", self.tilt, 1, 0, 0),
            ("Rotate", self.roll, 0, 1, 0),
        ]


# Name: (number, colour, striped, roughness of the coat; 0 is a perfect polish).
NUMBERED = {
    "one": ("1", (0.78, 0.46, 0.02), False, 0.0),
    "two": ("2", (0.02, 0.06, 0.33), False, 0.03),
    "three": ("3", (0.55, 0.02, 0.015), False, 0.1),
    "four": ("4", (0.14, 0.03, 0.22), False, 0.0),
    "eight": ("8", (0.012, 0.012, 0.014), False, 0.0),
    "ten": ("10", (0.02, 0.07, 0.36), True, 0.0),
    "eleven": ("11", (0.58, 0.02, 0.02), True, 0.01),
    "thirteen": ("13", (0.80, 0.24, 0.02), True, 0.0),
    "fourteen": ("14", (0.01, 0.19, 0.07), True, 0.05),
}

# Name: (material, parameters).
PLAIN = {
    "mirror": ("conductor", {"spectrum eta": "metal-Ag-eta", "spectrum k": "metal-Ag-k"}),
    "gold": (
        "conductor",
        {"spectrum eta": "metal-Au-eta", "spectrum k": "metal-Au-k", "float roughness": 0.06},
    ),
    "copper": (
        "conductor",
        {"spectrum eta": "metal-Cu-eta", "spectrum k": "metal-Cu-k", "float roughness": 0.25},
    ),
    "glass": ("dielectric", {"float eta": 1.5}),
    "chalky": ("diffuse", {"rgb reflectance": [0.62, 0.25, 0.30]}),
    "satin": ("coateddiffuse", {"rgb reflectance": [0.02, 0.30, 0.32], "float roughness": 0.3}),
    "red": ("coateddiffuse", {"rgb reflectance": [0.42, 0.008, 0.012], "float roughness": 0.0}),
}

RESTING = [
    Ball("eight", 0.0, 0.0, 0, 14, 8),
    Ball("glass", -0.058, -0.066),
    Ball("mirror", 0.016, 0.104),
    Ball("gold", 0.085, -0.062),
    Ball("one", 0.104, 0.036, -24, 18, -14),
    Ball("thirteen", -0.118, 0.112, 28, 30, 24),
    Ball("eleven", 0.235, -0.225, -20, 30, -38),
    Ball("satin", 0.205, -0.100),
    Ball("two", 0.170, 0.160, 30, 8, 20),
    Ball("three", 0.245, -0.010, 20, 20, 12),
    Ball("chalky", 0.262, 0.092),
    Ball("ten", 0.400, -0.255, 15, 40, 60),
    Ball("copper", 0.310, 0.255),
    Ball("fourteen", 0.440, -0.085, -25, 20, 25),
    Ball("four", 0.480, 0.140, 0, 20, -20),
]


def pack(rows=5):
    """Centres of the reds in so many rows, fifteen in five, racked far behind the focus."""
    spacing = 2 * RADIUS + 0.0004
    centers = []
    for row in range(rows):
        for i in range(row + 1):
            ahead = 0.66 + row * spacing * sqrt(3) / 2
            centers.append(place(ahead, 0.03 + (i - row / 2) * spacing))
    return centers


@dataclass(frozen=True)
class RollingBall:
    """The spotted cue ball, rolling without slipping while the shutter is open."""

    start: tuple = place(0.060, -0.166)
    end: tuple = place(0.100, -0.156)
    color: tuple = IVORY
    spot_color: tuple = (0.55, 0.015, 0.02)

    @property
    def travel(self):
        """Displacement during the shutter."""
        return (self.end[0] - self.start[0], self.end[1] - self.start[1])

    def motion(self):
        """(start, end) transforms; the ball turns about up x travel by distance / radius."""
        dx, dy = self.travel
        angle = hypot(dx, dy) / RADIUS * 180 / pi
        start = [("Translate", *self.start)]
        return start, [("Translate", *self.end), ("Rotate", angle, -dy, dx, 0)]


ROLLING = RollingBall()


@dataclass(frozen=True)
class BallSet:
    """The balls on the table: resting ones, and reds of the material "red" in rows of a pack.

    numbered, plain: see NUMBERED and PLAIN.
    """

    numbered: dict
    plain: dict
    resting: list
    pack_rows: int


EVERY_MATERIAL = BallSet(NUMBERED, PLAIN, RESTING, 5)


def require_clearance(balls):
    """Raises ValueError where two balls overlap, at the ends of the shutter or between."""
    path = [
        tuple(a + (b - a) * i / 16 for a, b in zip(ROLLING.start, ROLLING.end)) for i in range(17)
    ]
    resting = [ball.center for ball in balls.resting] + pack(balls.pack_rows)
    pairs = list(combinations(resting, 2)) + [(a, b) for a in path for b in resting]
    for a, b in pairs:
        if dist(a, b) < 2 * RADIUS:
            raise ValueError(f"the balls at {a} and {b} overlap")
