"""PNG files with a palette, small enough to stand in the documents.

    small_png.shrink(FROM, TO)

takes a PNG of 8-bit RGB, as the program writes them, and writes the same picture with at most 256 colours: those of a
median cut (Heckbert 1982, "Color image quantization for frame buffer display"), each pixel the nearest of them. Needs
numpy."""

import pathlib
import struct
import zlib

import numpy as np

COLOURS = 256
SIGNATURE = b"\x89PNG\r\n\x1a\n"


def chunks(data):
    at = len(SIGNATURE)
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        yield kind, data[at + 8 : at + 8 + length]
        at += 12 + length


def unfiltered(kind, line, above, channels):
    """A line of bytes without its filter (the PNG specification, second edition, 9.2)."""
    if kind == 0:
        return line
    if kind == 1:
        return np.cumsum(line.reshape(-1, channels), axis=0).reshape(-1) & 255
    if kind == 2:
        return (line + above) & 255
    result, up = [0] * channels + line.tolist(), [0] * channels + above.tolist()
    for i in range(channels, len(result)):
        left, over, corner = result[i - channels], up[i], up[i - channels]
        if kind == 3:
            guess = (left + over) // 2
        else:
            # Paeth: the one of the three that is nearest to their plane
            to_left, to_over, to_corner = abs(over - corner), abs(left - corner), abs(left + over - 2 * corner)
            guess = left if to_left <= to_over and to_left <= to_corner else over if to_over <= to_corner else corner
        result[i] = (result[i] + guess) & 255
    return np.array(result[channels:])


def read(file):
    """The pixels of a PNG of 8-bit RGB: height x width x 3."""
    data = pathlib.Path(file).read_bytes()
    parts = list(chunks(data))
    width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", parts[0][1])
    if data[:8] != SIGNATURE or (depth, colour, interlaced) != (8, 2, 0):
        raise ValueError(f"{file}: expected a PNG of 8-bit RGB")
    raw = zlib.decompress(b"".join(content for kind, content in parts if kind == b"IDAT"))
    lines = np.frombuffer(raw, np.uint8).reshape(height, 1 + 3 * width)
    pixels, above = np.zeros((height, 3 * width), np.uint8), np.zeros(3 * width, int)
    for y, line in enumerate(lines):
        above = unfiltered(line[0], line[1:].astype(int), above, 3)
        pixels[y] = above
    return pixels.reshape(height, width, 3)


def palette(pixels):
    """At most COLOURS colours of pixels (n x 3), and the index of each pixel's nearest."""
    # Six bits of a channel tell colours apart well enough to choose among them.
    coarse = (pixels >> 2).astype(int)
    kinds, of_pixel, counts = np.unique(coarse @ [4096, 64, 1], return_inverse=True, return_counts=True)
    colours = np.stack([kinds >> 12, kinds >> 6 & 63, kinds & 63], axis=1) * 4.0 + 2
    exact = np.stack([np.bincount(of_pixel, pixels[:, c]) for c in range(3)], axis=1) / counts[:, None]
    boxes = [np.arange(len(kinds))]
    while len(boxes) < COLOURS:
        weights = [np.ptp(colours[box], axis=0).max() * counts[box].sum() ** 0.25 for box in boxes]
        box = boxes.pop(int(np.argmax(weights)))
        if len(box) == 1:
            boxes.append(box)
            break
        axis = int(np.argmax(np.ptp(colours[box], axis=0)))
        box = box[np.argsort(colours[box, axis], kind="stable")]
        sums = np.cumsum(counts[box])
        middle = min(max(int(np.searchsorted(sums, sums[-1] / 2)), 1), len(box) - 1)
        boxes += [box[:middle], box[middle:]]
    chosen = np.array([np.average(exact[box], axis=0, weights=counts[box]) for box in boxes])
    nearest = ((exact[:, None] - chosen[None]) ** 2).sum(axis=2).argmin(axis=1)
    return np.clip(chosen.round(), 0, 255).astype(np.uint8), nearest[of_pixel].astype(np.uint8)


def shrink(source, target):
    pixels = read(source)
    height, width, _ = pixels.shape
    colours, indices = palette(pixels.reshape(-1, 3))
    lines = np.zeros((height, 1 + width), np.uint8)
    lines[:, 1:] = indices.reshape(height, width)
    data = SIGNATURE
    for kind, content in (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)),
        (b"PLTE", colours.tobytes()),
        (b"IDAT", zlib.compress(lines.tobytes(), 9)),
        (b"IEND", b""),
    ):
        data += struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    pathlib.Path(target).write_bytes(data)
