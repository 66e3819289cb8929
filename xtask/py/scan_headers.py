"""Compares where grainpath places the voxels of 20 scans with where SimpleITK places them.

    scan_headers.py path/to/grainpath [folder]

Needs SimpleITK and numpy. Writes the scans into the folder (default: a temporary one), reads each with
`grainpath inspect --json`, and compares the centres of the eight corner voxels, which may come in another order because
grainpath brings the axes into the order of the world. Prints the largest difference of each and fails above 1e-4 mm, and
fails as well where grainpath's axes are left-handed. Sheared headers are compared with the formula: ITK refuses them or
makes them orthogonal.
"""

import itertools
import json
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import SimpleITK as sitk

SIZE = (7, 6, 5)
SPACING = np.array([0.4, 0.5, 0.7])
ORIGIN = np.array([10.0, -20.0, 30.0])
VOXELS = np.arange(np.prod(SIZE), dtype=np.int16).reshape(SIZE[::-1])
RAS = np.diag([-1.0, -1.0, 1.0])


def turn(axis, degrees):
    axis = np.array(axis, float) / np.linalg.norm(axis)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return c * np.eye(3) + s * cross + (1 - c) * np.outer(axis, axis)


def permutation(order, signs):
    m = np.zeros((3, 3))
    for column, (row, sign) in enumerate(zip(order, signs)):
        m[row, column] = sign
    return m


def nifti(path, matrix, unit=2, scale=1.0, qform=None, sform=True):
    """A NIfTI file whose voxels lie at `matrix @ index + ORIGIN` in LPS, mm."""
    head = bytearray(352)
    put = lambda form, at, *v: struct.pack_into("<" + form, head, at, *v)
    put("i", 0, 348)
    put("8h", 40, 3, *SIZE, 1, 1, 1, 1)
    put("2h", 70, 4, 16)
    put("f", 108, 352.0)
    head[123] = unit
    ras, origin = RAS @ matrix / scale, RAS @ ORIGIN / scale
    lengths = np.linalg.norm(ras, axis=0)
    put("8f", 76, -1.0 if np.linalg.det(ras) < 0 else 1.0, *lengths, 0, 0, 0, 0)
    put("2h", 252, int(qform is not None), int(sform))
    if qform is not None:
        put("3f", 256, *qform)
        put("3f", 268, *origin)
    for row in range(3):
        put("4f", 280 + 16 * row, *ras[row], origin[row])
    head[344:348] = b"n+1\0"
    path.write_bytes(bytes(head) + VOXELS.tobytes())


def nrrd(path, matrix, space="left-posterior-superior", to_space=np.eye(3)):
    text = lambda v: "(" + ",".join(repr(float(c)) for c in to_space @ v) + ")"
    head = (
        f"NRRD0005\ntype: short\ndimension: 3\nspace: {space}\nsizes: {' '.join(map(str, SIZE))}\n"
        f"space directions: {' '.join(text(matrix[:, k]) for k in range(3))}\nspace origin: {text(ORIGIN)}\n"
        "endian: little\nencoding: raw\n\n"
    )
    path.write_bytes(head.encode() + VOXELS.tobytes())


def corners(size, origin, matrix):
    index = itertools.product(*[(0, n - 1) for n in size])
    return np.array([origin + matrix @ np.array(i, float) for i in index])


def by_itk(path):
    image = sitk.ReadImage(str(path))
    direction = np.array(image.GetDirection()).reshape(3, 3)
    return corners(image.GetSize(), np.array(image.GetOrigin()), direction * np.array(image.GetSpacing()))


def by_grainpath(binary, path):
    run = subprocess.run([binary, "inspect", "--json", str(path)], capture_output=True, text=True, check=True)
    told = json.loads(run.stdout)
    world = told["world"]
    axes = np.array([world["columns"], world["rows"], world["slices"]]).T
    assert np.linalg.det(axes) > 0.999, f"{path.name}: left-handed"
    return told, corners(told["voxels"], np.array(world["origin_mm"]), axes * np.array(told["spacing_mm"]))


def apart(a, b):
    """The largest distance from a corner to the nearest of the other set, both ways."""
    d = np.linalg.norm(a[:, None] - b[None], axis=2)
    return max(d.min(axis=0).max(), d.min(axis=1).max())


def scans(folder):
    """Path, and the matrix where ITK cannot be asked."""
    orders = [((0, 1, 2), (1, 1, 1)), ((1, 2, 0), (1, 1, 1)), ((2, 0, 1), (1, 1, 1)), ((1, 0, 2), (1, 1, 1)),
              ((0, 2, 1), (1, -1, 1)), ((2, 1, 0), (1, 1, -1)), ((0, 1, 2), (-1, 1, 1)), ((0, 1, 2), (1, -1, 1)),
              ((0, 1, 2), (1, 1, -1)), ((0, 1, 2), (-1, -1, -1))]
    writers = itertools.cycle(["mha", "nrrd", "nii"])
    for n, ((order, signs), kind) in enumerate(zip(orders, writers)):
        path = folder / f"{n:02}_order_{''.join(map(str, order))}.{kind}"
        image = sitk.GetImageFromArray(VOXELS)
        image.SetSpacing(SPACING.tolist())
        image.SetOrigin(ORIGIN.tolist())
        image.SetDirection(permutation(order, signs).flatten().tolist())
        sitk.WriteImage(image, str(path))
        yield path, None
    oblique = turn([1, 2, 3], 20) * SPACING
    mirrored = oblique @ np.diag([1, 1, -1])
    nifti(folder / "10_m.nii", oblique, unit=1, scale=1000.0)
    nifti(folder / "11_mm.nii", mirrored, unit=2)
    nifti(folder / "12_um.nii", oblique, unit=3, scale=1e-3)
    nifti(folder / "13_qform.nii", RAS * SPACING, qform=(0.0, 0.0, 0.0), sform=False)
    nifti(folder / "14_sform_against_qform.nii", oblique, qform=(0.0, 0.0, 0.6))
    nrrd(folder / "15_ras.nrrd", mirrored, "right-anterior-superior", RAS)
    nrrd(folder / "16_las.nrrd", oblique, "left-anterior-superior", np.diag([1.0, -1.0, 1.0]))
    for name in ("10_m.nii", "11_mm.nii", "12_um.nii", "13_qform.nii", "14_sform_against_qform.nii", "15_ras.nrrd",
                 "16_las.nrrd"):
        yield folder / name, None
    shear = np.array([[1, 0.2, -0.3], [0, 1, 0.25], [0, 0, 1]])
    tilt = np.array([[1, 0, 0], [0, 1, np.tan(np.radians(18))], [0, 0, 1]])
    for name, matrix in (("17_shear.nrrd", oblique @ shear), ("18_mirrored_shear.nrrd", mirrored @ shear)):
        nrrd(folder / name, matrix)
        yield folder / name, matrix
    nifti(folder / "19_tilt.nii", tilt * SPACING)
    yield folder / "19_tilt.nii", tilt * SPACING


def main():
    binary = sys.argv[1]
    with tempfile.TemporaryDirectory() as made:
        folder = Path(sys.argv[2] if len(sys.argv) > 2 else made)
        folder.mkdir(parents=True, exist_ok=True)
        worst, count = 0.0, 0
        for path, matrix in scans(folder):
            told, ours = by_grainpath(binary, path)
            if matrix is None:
                off = apart(ours, by_itk(path))
            else:
                # Upright slices enclose the leaning stack: each of its corners lies within them, on their planes.
                world = told["world"]
                axes = np.array([world["columns"], world["rows"], world["slices"]]).T * np.array(told["spacing_mm"])
                index = np.linalg.solve(axes, (corners(SIZE, ORIGIN, matrix) - np.array(world["origin_mm"])).T)
                last = np.array(told["voxels"])[:, None] - 1
                outside = np.maximum(-index, index - last).max()
                planes = index - np.round(index)
                off = max(outside, np.abs(planes).max(axis=1).min())
            print(f"{path.name:32} {off:.2e}")
            worst, count = max(worst, off), count + 1
        print(f"{count} scans, at most {worst:.2e} mm apart")
        sys.exit(0 if worst < 1e-4 and count == 20 else 1)


main()
