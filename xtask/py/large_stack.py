"""A stack of 2048 x 2048 x 2000 voxels, 16 bit, as a folder of TIFF slices. Arguments: folder, slices.

A wheel with lobes and bores that screws upwards and is itself again after 64 slices: those 64 are written, each under as
many names as it has places in the stack, so that 17 GB are read and 0.5 GB are stored. Edges are blurred, greys noisy.
"""

import os
import struct
import sys

import numpy as np

SIZE, PERIOD = 2048, 64


def tiff(grey):
    data = grey.astype("<u2").tobytes()
    tags = [(256, 4, SIZE), (257, 4, SIZE), (258, 3, 16), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1),
            (278, 4, SIZE), (279, 4, len(data))]
    rows = b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags)
    return struct.pack("<2sHI", b"II", 42, 8 + len(data)) + data + struct.pack("<H", len(tags)) + rows + bytes(4)


def main():
    folder, slices = sys.argv[1], int(sys.argv[2])
    os.makedirs(folder, exist_ok=True)
    y, x = np.mgrid[0:SIZE, 0:SIZE].astype(np.float32) - 0.5 * (SIZE - 1)
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    rng = np.random.default_rng(7)
    for k in range(min(PERIOD, slices)):
        turn = 2 * np.pi * k / PERIOD
        inside = 900 + 40 * np.cos(6 * angle - turn) - radius
        inside = np.minimum(inside, radius - 260)
        for bore in range(6):
            a = 2 * np.pi * bore / 6 + turn / 6
            inside = np.minimum(inside, np.hypot(x - 560 * np.cos(a), y - 560 * np.sin(a)) - 150)
        grey = 1000 + 20000 / (1 + np.exp(np.clip(-2 * inside, -40, 40)))
        grey += rng.normal(0, 200, grey.shape)
        first = os.path.join(folder, f"slice_{k:04}.tif")
        with open(first, "wb") as f:
            f.write(tiff(np.clip(grey, 0, 65535)))
        for again in range(k + PERIOD, slices, PERIOD):
            name = os.path.join(folder, f"slice_{again:04}.tif")
            if not os.path.exists(name):
                os.link(first, name)


main()
