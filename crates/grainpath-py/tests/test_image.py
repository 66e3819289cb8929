"""Photographs as arrays."""

import pickle
import struct
import zlib

import numpy as np
import pytest

import grainpath as gp
from conftest import QUICK


def png(array):
    """An 8-bit PNG, written apart from the planner."""
    rows, columns = array.shape[:2]
    kind = 0 if array.ndim == 2 else 2
    raw = b"".join(b"\0" + row.tobytes() for row in np.ascontiguousarray(array))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", columns, rows, 8, kind, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


def wood(angle_deg, rows=200, columns=300):
    """Stripes whose lines run at an angle from +X, seen with Y upwards."""
    y, x = np.mgrid[:rows, :columns].astype(float)
    turn = np.deg2rad(angle_deg)
    across = -x * np.sin(turn) + (rows - y) * np.cos(turn)
    return (128 + 100 * np.sin(across / 2.5)).astype(np.uint8)


BOARD = {"shape__photo__size_mm": [30, 20], "shape__photo__thickness_mm": 1.2}
GRAIN = {"guide__kind": "grain", "fill__pattern": "stripes", "fill__density": 0.4}


@pytest.mark.parametrize("colour", [False, True])
def test_bytes_are_those_of_the_file(tmp_path, colour):
    picture = wood(20)
    if colour:
        picture = np.stack([picture, picture // 2, 255 - picture], axis=-1)
    (tmp_path / "board.png").write_bytes(png(picture))
    of_file = gp.Job(folder=tmp_path, shape__photo__files=["board.png"], **BOARD, **GRAIN, **QUICK)
    of_array = gp.Job(gp.Image(picture, name="board.png"), **BOARD, **GRAIN, **QUICK)
    assert of_array.plan().to_gcode() == of_file.plan().to_gcode()


@pytest.mark.parametrize("angle", [0, 37, 110])
def test_infill_follows_the_grain_of_a_picture(angle):
    plan = gp.Job(gp.box(30, 20, 1.2), grain=gp.Image(wood(angle)), process__top_layers=0, process__bottom_layers=0, **{**GRAIN, **QUICK}).plan()
    vectors = []
    for path in plan.layers[2]:
        if "fill" in path.role.lower():
            vectors.append(np.diff(path.points, axis=0))
    steps = np.concatenate(vectors)
    length = np.hypot(*steps.T)
    # The mean axis, of doubled angles.
    axis = np.angle((length * np.exp(2j * np.arctan2(steps[:, 1], steps[:, 0]))).sum()) / 2
    assert abs((np.rad2deg(axis) - angle + 90) % 180 - 90) < 4


def test_types_that_mean_the_same_give_the_same():
    picture = wood(30)
    programs = set()
    for array in (picture, picture[:, :, None], np.asfortranarray(picture), picture.astype(np.uint16) * 257):
        plan = gp.Job(gp.box(30, 20, 0.6), grain=gp.Image(array), **{**GRAIN, **QUICK}).plan()
        programs.add(b"".join(np.round(layer.points, 2).tobytes() for layer in plan.layers))
    assert len(programs) == 1


def test_several_pictures_and_pickling():
    pictures = [gp.Image(wood(10), name="low"), gp.Image(wood(20), name="high")]
    job = gp.Job(gp.box(30, 20, 1.2), grain=pictures, **{**GRAIN, **QUICK})
    assert job["guide.image.files"] == ["low", "high"]
    again = pickle.loads(pickle.dumps(job))
    assert again.plan().to_gcode() == job.plan().to_gcode()
    assert repr(pictures[0]) == "<grainpath.Image: 300 x 200 pixels, 1 channels, uint8>"
    with pytest.raises(ValueError, match="read-only"):
        pictures[0].array[0, 0] = 1


@pytest.mark.parametrize(
    "array, message",
    [
        (np.zeros(5), r"the shape \(5,\)"),
        (np.zeros((5, 5, 5)), r"the shape \(5, 5, 5\)"),
        (np.zeros((0, 5)), "empty"),
        (np.full((5, 5), np.nan), "no pixel"),
        (np.zeros((5, 5), dtype=complex), "complex128"),
        ([["a"]], "numbers are needed"),
    ],
)
def test_what_is_no_picture_is_refused(array, message):
    with pytest.raises(gp.InputError, match=message):
        gp.Image(array)


def test_jobs_say_what_they_take():
    with pytest.raises(gp.JobError, match="grain is a ndarray"):
        gp.Job(gp.box(1, 1, 1), grain=np.zeros((5, 5)))
    with pytest.raises(gp.JobError, match="exactly one guides"):
        gp.Job(gp.box(1, 1, 1), grain=gp.Image(wood(0)), field=gp.Field(([0, 1], [0, 1]), np.zeros((2, 2))))
    with pytest.raises(gp.JobError, match="shape is a list"):
        gp.Job([1, 2])
    with pytest.raises(gp.JobError, match="size_mm"):
        gp.Job(gp.Image(wood(0)))


def test_another_picture_is_another_entry(tmp_path):
    job = gp.Job(gp.box(30, 20, 0.6), grain=gp.Image(wood(10)), **{**GRAIN, **QUICK})
    for picture, cached in ((wood(10), False), (wood(10), True), (wood(11), False)):
        (row,) = gp.sweep(job.with_(grain=gp.Image(picture)), {"process.walls": [1]}, cache=tmp_path)
        assert row["cached"] is cached
