"""The height maps that every tool gets: bricks with fractal noise, the same bytes on every machine.

Only integers and + - * / on 64-bit floats are used, in a fixed order, so nothing depends on a platform's `sin`. The
map wraps at its edges.

    heights.py DIRECTORY SIZE [COUNT]

writes COUNT (default 1) 16-bit grey PNGs of SIZE x SIZE texels as DIRECTORY/bricks_<number>_height.png.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

MORTAR = 0.06  # width of the mortar, in brick heights
BEVEL = 0.12  # width of a brick's rounded edge, in brick heights
OCTAVES_TO = 2  # the finest noise has one lattice point in so many texels
GAIN = 0.85  # amplitude of an octave relative to the one twice as coarse
NOISE = 0.4  # share of the noise in the height


def hashed(x, y, seed):
    """A number in [0, 1) for a lattice point; a xor-multiply hash (M. O'Neill's PCG output, RXS-M-XS)."""
    state = x.astype(np.uint64) * 747796405 + y.astype(np.uint64) * 2891336453 + seed * 277803737
    state &= 0xFFFFFFFF
    word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737 & 0xFFFFFFFF
    return ((word >> 22) ^ word).astype(np.float64) / 4294967296.0


def smooth(t):
    return t * t * (3 - 2 * t)


def lattice_noise(rows, size, cells, seed):
    """Value noise of `cells` x `cells` lattice points, for some rows of the map."""
    texels = size // cells
    x = np.arange(size)
    x0, y0 = x // texels, rows // texels
    tx = smooth((x % texels) / texels)[None, :]
    ty = smooth((rows % texels) / texels)[:, None]
    x1, y1 = (x0 + 1) % cells, (y0 + 1) % cells
    top = hashed(x0[None, :], y0[:, None], seed) * (1 - tx) + hashed(x1[None, :], y0[:, None], seed) * tx
    bottom = hashed(x0[None, :], y1[:, None], seed) * (1 - tx) + hashed(x1[None, :], y1[:, None], seed) * tx
    return top * (1 - ty) + bottom * ty


def fractal_noise(rows, size, seed):
    total, weights, amplitude, cells = 0.0, 0.0, 1.0, 8
    while size // cells >= OCTAVES_TO:
        total = total + amplitude * lattice_noise(rows, size, cells, seed + cells)
        weights += amplitude
        amplitude *= GAIN
        cells *= 2
    return total / weights


def bricks(rows, size, seed):
    """A running bond: 8 bricks in a row, 16 rows; each brick has a height of its own."""
    height = size // 16
    course = rows // height
    x = np.arange(size)[None, :] + (course % 2)[:, None] * height
    column = (x // (2 * height)) % 8
    along = (x % (2 * height)) / height
    across = ((rows % height) / height)[:, None]
    distance = np.minimum(np.minimum(along, 2 - along), np.minimum(across, 1 - across))
    profile = smooth(np.clip((distance - MORTAR / 2) / BEVEL, 0, 1))
    return profile * (0.7 + 0.3 * hashed(column, course[:, None], seed + 1))


def height_map(size, seed):
    codes = np.empty((size, size), np.uint16)
    for first in range(0, size, 256):
        rows = np.arange(first, min(first + 256, size))
        height = (1 - NOISE) * bricks(rows, size, seed) + NOISE * fractal_noise(rows, size, seed)
        codes[rows] = np.floor(height * 65535 + 0.5)
    return codes


def main():
    directory, size = Path(sys.argv[1]), int(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    directory.mkdir(parents=True, exist_ok=True)
    for number in range(count):
        # libpng's own choice of filters and level: what most exporters write.
        options = [cv2.IMWRITE_PNG_COMPRESSION, 6, cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_ALL_FILTERS]
        cv2.imwrite(str(directory / f"bricks_{number:02}_height.png"), height_map(size, number), options)


if __name__ == "__main__":
    main()
