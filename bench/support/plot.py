"""Curves in logarithmic axes as an SVG file, by the standard library alone."""
import math
import pathlib
from xml.sax.saxutils import escape

COLORS = ["#888888", "#2b6cb0", "#c05621", "#2f855a", "#6b46c1"]
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 360, 270, 58, 12, 30, 42


def ticks(low, high):
    """1, 2 and 5 times the powers of ten in [low, high]."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    found = [m * 10.0 ** d for d in decades for m in (1, 2, 5) if low <= m * 10.0 ** d <= high]
    return found if len(found) < 9 else [t for t in found if f"{t:e}".startswith("1.0")]


def panel(title, curves, x_label, y_label):
    """SVG elements of one diagram. curves: name -> list of (x, y, low, high), all positive; low and high are bounds of y."""
    points = [p for c in curves.values() for p in c]
    x0, x1 = min(p[0] for p in points) / 1.15, max(p[0] for p in points) * 1.15
    y0, y1 = min(p[2] for p in points) / 1.3, max(p[3] for p in points) * 1.3
    def across(x):
        return LEFT + (WIDTH - LEFT - RIGHT) * math.log(x / x0) / math.log(x1 / x0)
    def down(y):
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * math.log(y / y0) / math.log(y1 / y0)
    out = [f'<text x="{WIDTH / 2}" y="18" text-anchor="middle" font-weight="bold">{escape(title)}</text>',
           f'<text x="{WIDTH / 2}" y="{HEIGHT - 8}" text-anchor="middle">{escape(x_label)}</text>',
           f'<text transform="translate(12 {HEIGHT / 2}) rotate(-90)" text-anchor="middle">{escape(y_label)}</text>']
    for t in ticks(x0, x1):
        out.append(f'<path d="M{across(t):.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
                   f'<text x="{across(t):.1f}" y="{HEIGHT - BOTTOM + 13}" text-anchor="middle">{t:g}</text>')
    for t in ticks(y0, y1):
        out.append(f'<path d="M{LEFT} {down(t):.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 4}" y="{down(t) + 4:.1f}" text-anchor="end">{t:g}</text>')
    for k, (name, curve) in enumerate(curves.items()):
        color = COLORS[k % len(COLORS)]
        line = " ".join(f"{across(p[0]):.1f},{down(p[1]):.1f}" for p in curve)
        out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="1.5"/>')
        for x, y, low, high in curve:
            out.append(f'<path d="M{across(x):.1f} {down(low):.1f}V{down(high):.1f}" stroke="{color}"/>'
                       f'<circle cx="{across(x):.1f}" cy="{down(y):.1f}" r="2.5" fill="{color}"/>')
        out.append(f'<text x="{WIDTH - RIGHT - 4}" y="{TOP + 13 + 13 * k}" text-anchor="end" fill="{color}">{escape(name)}</text>')
    return "\n".join(out)


def write(path, panels, x_label, y_label, note=""):
    """panels: title -> curves; written beside and renamed, three in a row, `note` below them."""
    columns = min(3, len(panels))
    rows = -(-len(panels) // columns)
    height = rows * HEIGHT + (20 if note else 0)
    body = [f'<g transform="translate({k % columns * WIDTH} {k // columns * HEIGHT})">\n{panel(t, c, x_label, y_label)}\n</g>'
            for k, (t, c) in enumerate(panels.items())]
    path = pathlib.Path(path)
    beside = path.with_name(path.name + ".part")
    beside.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {columns * WIDTH} {height}" '
                      f'width="{columns * WIDTH}" font-family="sans-serif" font-size="11">\n'
                      f'<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(body) +
                      f'\n<text x="4" y="{height - 6}">{escape(note)}</text>\n</svg>\n')
    beside.rename(path)
