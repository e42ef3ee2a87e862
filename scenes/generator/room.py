"""The room around the snooker table, as radiance by direction: windows, lamps and a bar.

Directions start at the middle of the table's surface; the room is a box, so that windows and
lamps keep their perspective. The scale is free: the writer normalises the whole map.
"""

from math import cos, floor, hypot, sin
from random import Random

from .color import mix, smoothstep
from .equal_area import mean_cosine, render_map
from .files import write_pfm

_HALF_X, _HALF_Y, _FLOOR, _CEILING = 6.0, 4.5, -0.86, 2.5
_EDGE = 0.03


def _sconces():
    """Small lamps over the bar: (y, z, radius, colour)."""
    random = Random(5)
    lamps = []
    for i in range(7):
        y = -4.0 + 1.33 * i
        lamps.append((y, 0.62, 0.13, (26.0, 15.0, 6.5)))
    colors = [
        (20.0, 9.0, 2.6),
        (16.0, 10.5, 5.0),
        (5.0, 9.0, 14.0),
        (18.0, 4.0, 1.6),
        (6.0, 12.0, 5.0),
    ]
    for i in range(16):
        y = -4.2 + 0.56 * i + random.uniform(-0.15, 0.15)
        lamps.append((y, random.uniform(-0.05, 0.33), 0.07, colors[i % len(colors)]))
    return lamps


_SCONCES = _sconces()


def _box(x, low, high):
    """1 inside [low, high] with soft edges."""
    return smoothstep(low - _EDGE, low + _EDGE, x) * smoothstep(high + _EDGE, high - _EDGE, x)


def _outdoors(a, z):
    """View through a window: a bright hazy sky over trees."""
    sky = mix((9.5, 10.5, 12.0), (6.0, 8.6, 13.5), smoothstep(0.2, 2.0, z))
    crown = 0.35 + 0.22 * sin(2.3 * a) + 0.12 * sin(5.1 * a + 1) + 0.06 * sin(13 * a)
    return mix((0.5, 0.75, 0.30), sky, smoothstep(crown - 0.12, crown + 0.12, z))


def _window(wall, a, z, center, half_width, low, high):
    """Paints a window with a white frame, one mullion and two transoms over a wall."""
    inside = _box(a, center - half_width, center + half_width) * _box(z, low, high)
    if inside == 0:
        return wall
    bars = _box(a, center - 0.045, center + 0.045)
    for i in (1, 2):
        bar = low + (high - low) * i / 3
        bars = max(bars, _box(z, bar - 0.035, bar + 0.035))
    frame = 0.09
    pane = _box(a, center - half_width + frame, center + half_width - frame)
    pane *= _box(z, low + frame, high - frame) * (1 - bars)
    return mix(wall, mix((0.55, 0.52, 0.47), _outdoors(a, z), pane), inside)


def _panelling(a, z):
    """Dark wainscot with a rail at 0.1 m above the table, painted plaster higher up."""
    if z > 0.1:
        plaster = (0.30, 0.245, 0.18)
        return mix(plaster, (0.20, 0.16, 0.12), smoothstep(1.2, 2.5, z))
    panel = abs(a / 0.8 - floor(a / 0.8) - 0.5)
    groove = smoothstep(0.42, 0.45, panel) * 0.55
    wood = mix((0.105, 0.052, 0.026), (0.045, 0.020, 0.010), groove)
    return mix(wood, (0.21, 0.11, 0.055), _box(z, 0.02, 0.08))


def _picture(wall, a, z, center, low, high, half_width, tone):
    """A gilt frame around a dark landscape."""
    frame = _box(a, center - half_width, center + half_width) * _box(z, low, high)
    canvas = _box(a, center - half_width + 0.07, center + half_width - 0.07)
    canvas *= _box(z, low + 0.07, high - 0.07)
    ground = smoothstep(low + 0.35, low + 0.5, z + 0.05 * sin(7 * a))
    painted = mix((0.10, 0.085, 0.04), tone, ground)
    return mix(wall, mix((0.42, 0.28, 0.09), painted, canvas), frame)


def _wall_windows(a, z):
    color = _panelling(a, z)
    for center in (-3.9, -1.3, 1.3, 3.9):
        color = _window(color, a, z, center, 0.78, 0.2, 2.15)
    return color


def _wall_pictures(a, z):
    color = _panelling(a, z)
    color = _window(color, a, z, -4.2, 0.7, 0.2, 2.15)
    color = _picture(color, a, z, -1.6, 0.5, 1.5, 0.75, (0.30, 0.36, 0.42))
    return _picture(color, a, z, 1.8, 0.6, 1.7, 0.5, (0.40, 0.30, 0.18))


def _wall_bar(a, z):
    """Lit shelves and small lamps: out of focus they turn into discs."""
    color = _panelling(a, z)
    shelf = _box(z, -0.12, 0.42) * _box(a, -4.3, 4.3)
    color = mix(color, (0.62, 0.33, 0.13), 0.75 * shelf)
    color = mix(color, (0.05, 0.025, 0.012), _box(z, 0.14, 0.18) * shelf)
    for y, height, radius, glow in _SCONCES:
        distance = hypot(a - y, z - height)
        if distance < 4 * radius:
            halo = 0.05 * smoothstep(4 * radius, 0, distance)
            lamp = smoothstep(radius + 0.02, radius - 0.02, distance)
            color = tuple(c + g * halo for c, g in zip(mix(color, glow, lamp), glow))
    return color


def _wall_door(a, z):
    color = _panelling(a, z)
    door = _box(a, -0.6, 0.6) * _box(z, _FLOOR, 1.3)
    color = mix(color, (0.16, 0.10, 0.06), door)
    color = mix(color, (1.7, 1.25, 0.75), _box(a, -0.45, 0.45) * _box(z, 0.1, 1.15))
    color = _window(color, a, z, 2.6, 0.7, 0.2, 2.15)
    return _window(color, a, z, -2.6, 0.7, 0.2, 2.15)


def _ceiling(x, y):
    beam = _box(x % 2.0, 0.85, 1.15)
    return mix((0.36, 0.33, 0.28), (0.10, 0.055, 0.03), beam)


def _floor(x, y):
    plank = floor(y / 0.16)
    tone = 0.75 + 0.35 * sin(plank * 12.9898 + 4.0 * cos(plank * 78.2))
    sunlit = max(0.0, 1.0 - abs(y - 2.2) / 2.2)
    return tuple(c * tone * (1 + 1.5 * sunlit) for c in (0.105, 0.055, 0.028))


def _lamp(dx, dy, dz):
    """Coverage of the three shades that hang 0.95 m above the table, in a row along x."""
    if dz <= 0.05:
        return 0.0
    x, y = 0.95 * dx / dz, 0.95 * dy / dz
    cover = 0.0
    for center in (-1.15, 0.0, 1.15):
        cover = max(cover, _box(x, center - 0.42, center + 0.42))
    return cover * _box(y, -0.2, 0.2)


def radiance(dx, dy, dz):
    """Radiance (RGB) that arrives from the unit direction (dx, dy, dz)."""
    tx = _HALF_X / abs(dx) if dx else 1e9
    ty = _HALF_Y / abs(dy) if dy else 1e9
    tz = (_CEILING if dz > 0 else -_FLOOR) / abs(dz) if dz else 1e9
    if tz <= tx and tz <= ty:
        color = (_ceiling if dz > 0 else _floor)(dx * tz, dy * tz)
    elif tx <= ty:
        color = (_wall_bar if dx > 0 else _wall_door)(dy * tx, dz * tx)
    else:
        color = (_wall_windows if dy > 0 else _wall_pictures)(dx * ty, dz * ty)
    cover = _lamp(dx, dy, dz)
    return mix(color, (15.0, 13.0, 10.0), cover) if cover else color


def write_room(path, size, supersampling):
    """Writes the map as an equal-area PFM in which a white, level diffuse surface shows 1."""
    rows = render_map(size, radiance, supersampling)
    red, green, blue = mean_cosine(rows)
    scale = 1 / (0.2126 * red + 0.7152 * green + 0.0722 * blue)
    write_pfm(path, [[scale * value for value in row] for row in rows])
