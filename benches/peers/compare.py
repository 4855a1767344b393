"""How far a normal map is from the formula (FGED2 eq. 7.41 and 7.43) in its middle.

    compare.py SCALE HEIGHT_MAP NORMAL_MAP

prints the largest and the mean difference in codes of 8 bits over 512 x 512 texels, for the direction of green that
fits better; `green down` if that is the other one than texbake's.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

SIDE = 512


def middle(image, border):
    rows, columns = image.shape[:2]
    top, left = (rows - SIDE) // 2 - border, (columns - SIDE) // 2 - border
    side = SIDE + 2 * border
    return image[top : top + side, left : left + side]


def expected(heights, scale):
    h = middle(heights, 1).astype(np.float64) / 65535
    x = (h[1:-1, :-2] - h[1:-1, 2:]) * scale / 2
    y = (h[2:, 1:-1] - h[:-2, 1:-1]) * scale / 2
    normal = np.stack([x, y, np.ones_like(x)], -1) / np.sqrt(x * x + y * y + 1)[..., None]
    return np.floor((normal + 1) * 127.5 + 0.5)


def rgb(path):
    if path.suffix == ".dds":
        # A header of 128 bytes, then blue, green, red, alpha.
        data = path.read_bytes()
        height, width = np.frombuffer(data, "<u4", 2, 12)
        return np.frombuffer(data, np.uint8, width * height * 4, 128).reshape(height, width, 4)[..., 2::-1]
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., 2::-1]
    assert image.dtype == np.uint8, f"{image.dtype} instead of 8 bits"
    return image


def main():
    scale, height_map, normal_map = float(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])
    want = expected(cv2.imread(str(height_map), cv2.IMREAD_UNCHANGED), scale)
    got = middle(rgb(normal_map), 0).astype(np.float64)
    up = np.abs(got - want)
    down = np.abs(got * [1, -1, 1] + [0, 255, 0] - want)
    best = min(up, down, key=np.mean)
    print(f"{best.max():.0f}, {best.mean():.3f}" + (" (green down)" if best is down else ""))


if __name__ == "__main__":
    main()
