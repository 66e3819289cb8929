"""A scan to STL the usual way: marching cubes of scikit-image. Arguments: scan (TIFF or NIfTI), threshold, voxel mm, STL."""

import gzip
import sys

import numpy as np
from skimage.measure import marching_cubes


def read(path):
    if path.endswith(".nii.gz"):
        data = gzip.open(path).read()
        nx, ny, nz = np.frombuffer(data[42:48], "<i2")
        return np.frombuffer(data, "u1", offset=352, count=int(nx) * int(ny) * int(nz)).reshape(nz, ny, nx)
    from skimage.io import imread

    return imread(path)


def main():
    path, threshold, mm, out = sys.argv[1], float(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
    volume = np.pad(read(path), 1)
    vertices, faces, _, _ = marching_cubes(volume, threshold, spacing=(mm, mm, mm), gradient_direction="ascent")
    corners = vertices[:, ::-1].astype("<f4")[faces]
    record = np.zeros(len(faces), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    record["corners"] = corners
    with open(out, "wb") as f:
        f.write(b"\0" * 80 + np.uint32(len(faces)).tobytes())
        record.tofile(f)


main()
