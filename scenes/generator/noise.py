"""Periodic value noise on whole images, as lists of rows; tiles without a seam."""

from random import Random


def noise_field(width, height, cells_x, cells_y, seed):
    """Smooth noise in [-1, 1] with cells_x by cells_y lattice cells over the image."""
    random = Random(seed)
    lattice = [[random.uniform(-1, 1) for _ in range(cells_x)] for _ in range(cells_y)]
    columns = []
    for x in range(width):
        position = (x + 0.5) * cells_x / width
        cell = int(position)
        t = position - cell
        columns.append((cell % cells_x, (cell + 1) % cells_x, t * t * (3 - 2 * t)))
    rows = []
    for y in range(height):
        position = (y + 0.5) * cells_y / height
        cell = int(position)
        t = position - cell
        t = t * t * (3 - 2 * t)
        upper, lower = lattice[cell % cells_y], lattice[(cell + 1) % cells_y]
        blend = [a + (b - a) * t for a, b in zip(upper, lower)]
        rows.append([blend[i] + (blend[j] - blend[i]) * s for i, j, s in columns])
    return rows


def fractal_field(width, height, cells_x, cells_y, octaves, seed):
    """Sum of `octaves` noise fields, each twice as fine and half as strong as the one before."""
    total = noise_field(width, height, cells_x, cells_y, seed)
    for octave in range(1, octaves):
        finer = noise_field(width, height, cells_x << octave, cells_y << octave, seed + octave)
        gain = 0.5**octave
        total = [[a + gain * b for a, b in zip(r, s)] for r, s in zip(total, finer)]
    return total
