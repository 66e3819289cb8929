"""Scans: any object with `__getitem__`, read in slabs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import grainpath as gp

SPACING = (0.3, 0.5, 0.5)


def bytes_of(array, spacing=SPACING):
    return gp.Job(gp.Volume(array, spacing=spacing), process__layer_height_mm=0.3).plan().to_gcode()


class Lazy:
    """An array that is read slice by slice, as h5py's and Zarr's are."""

    def __init__(self, array):
        self.array, self.shape, self.dtype, self.asked = array, array.shape, array.dtype, []

    def __getitem__(self, key):
        self.asked.append(key)
        return self.array[key]


def test_a_scan_is_its_outline(ball):
    plan = gp.Job(gp.Volume(ball, spacing=SPACING)).plan()
    area = np.pi * 200 * 0.25
    (outer,) = plan.sections[3][0]
    x, y = outer.T
    assert 0.5 * abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))) == pytest.approx(area, rel=0.02)
    assert plan.layers[-1].z_top_mm == pytest.approx(3.6, abs=0.21)


@settings(max_examples=12, deadline=None)
@given(
    dtype=st.sampled_from(["u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"]),
    order=st.sampled_from("<>"),
    layout=st.sampled_from(["C", "F", "reversed", "strided", "lazy"]),
)
def test_any_type_byte_order_and_strides(ball, dtype, order, layout):
    array = (ball // 2).astype(order + dtype)
    if layout == "F":
        array = np.asfortranarray(array)
    elif layout == "reversed":
        array = np.ascontiguousarray(array[:, ::-1])[:, ::-1]
    elif layout == "strided":
        wide = np.zeros([2 * n for n in array.shape], dtype=array.dtype)
        wide[::2, ::2, ::2] = array
        array = wide[::2, ::2, ::2]
    elif layout == "lazy":
        array = Lazy(array)
    assert bytes_of(array) == bytes_of((ball // 2).astype("u1"))


def test_a_memory_map(ball, tmp_path):
    np.save(tmp_path / "scan.npy", ball)
    assert bytes_of(np.load(tmp_path / "scan.npy", mmap_mode="r")) == bytes_of(ball)


def test_bools_are_voxels(ball):
    assert bytes_of(ball > 0) == bytes_of((ball > 0).astype("u1"))


def test_slabs_are_bounded_and_in_order():
    planes = Lazy(np.zeros((40, 1024, 1024), dtype="u1"))
    planes.array[:, 400:600, 400:600] = 200
    gp.Job(gp.Volume(planes, spacing=0.2), process__layer_height_mm=0.4).plan()
    assert all(key.stop - key.start <= 2 for key in planes.asked)
    assert max(key.stop for key in planes.asked) == 40


def test_nothing_is_copied_of_a_large_array():
    """The allocations of Python while a scan is planned stay far below the scan."""
    import tracemalloc

    array = np.zeros((64, 1024, 1024), dtype="u2")
    array[:, 300:400, 300:400] = 1000
    volume = gp.Volume(array, spacing=0.1)
    assert volume.array is array
    tracemalloc.start()
    gp.Job(volume).plan()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.25 * array.nbytes


def test_nan_is_air(ball):
    holes = ball.astype("f4")
    holes[holes == 0] = np.nan
    holes[0, 0, 0] = 0
    assert len(gp.Job(gp.Volume(holes, spacing=SPACING)).plan().layers) > 0


def test_the_exception_of_a_store_comes_back_as_it_was(ball):
    class Broken(Lazy):
        def __getitem__(self, key):
            if key.start >= 3:
                raise OSError("chunk 3 is missing")
            return self.array[key]

    array = np.zeros((40, 1500, 1500), dtype="u1")
    array[:, 400:600, 400:600] = 200
    with pytest.raises(OSError, match="chunk 3 is missing"):
        gp.Job(gp.Volume(Broken(array), spacing=SPACING)).plan()


def test_a_store_that_lies_about_its_shape(ball):
    class Short(Lazy):
        def __getitem__(self, key):
            return self.array[key][:, :-1]

    with pytest.raises(gp.InputError, match="planes 0 to"):
        gp.Job(gp.Volume(Short(ball), spacing=SPACING)).plan()


@pytest.mark.parametrize(
    "array, spacing, words",
    [
        (np.zeros((3, 3)), 1, "(planes, rows, columns) is needed"),
        (np.zeros((3, 0, 3)), 1, "which is empty"),
        (np.zeros((3, 3, 3), dtype=complex), 1, "the array has the type complex128"),
        (np.zeros((3, 3, 3), dtype="U1"), 1, "the array has the type"),
        (np.zeros((3, 3, 3)), 0, "should be above 0"),
        (np.zeros((3, 3, 3)), (1, -1, 1), "should be above 0"),
        (np.zeros((3, 3, 3)), (1, 1), "spacing has the shape (2,)"),
        (np.zeros((3, 3, 3)), np.nan, "spacing[0] is nan"),
        (np.zeros((3, 3, 3)), (1, 1, np.inf), "spacing[2] is inf"),
    ],
)
def test_wrong_volumes_are_named(array, spacing, words):
    with pytest.raises(gp.InputError) as error:
        gp.Volume(array, spacing=spacing)
    assert words in str(error.value)


@pytest.mark.parametrize("value", [0, 7, np.nan])
def test_a_scan_of_nothing_is_refused(value):
    with pytest.raises(gp.GrainpathError):
        gp.Job(gp.Volume(np.full((8, 20, 20), value, dtype="f4"), spacing=0.5)).plan()


class Said:
    """An array that says of itself what it is told."""

    def __init__(self, array, **said):
        self.array, self.shape, self.dtype = array, said.get("shape", array.shape), said.get("dtype", array.dtype)

    def __getitem__(self, key):
        return self.array[key]


@pytest.mark.parametrize(
    "said, words",
    [
        ({"dtype": "torch.float32"}, "the array has the type 'torch.float32', which numpy does not know"),
        ({"shape": "abc"}, "the array has the shape 'abc'"),
        ({"shape": (-1, 40, 40)}, "no length is below 0"),
    ],
)
def test_arrays_that_say_nonsense_of_themselves(ball, said, words):
    with pytest.raises(gp.InputError, match=words):
        gp.Volume(Said(ball, **said), spacing=SPACING)


@pytest.mark.parametrize("kind", ["U3", "c8", "O"])
def test_planes_of_another_type_than_promised_are_refused(ball, kind):
    """Words would be read as numbers, and of complex numbers a half be dropped."""
    with pytest.raises(gp.InputError, match="of the array have the type .*; uint8 was promised"):
        bytes_of(Said(ball.astype(kind), dtype=np.dtype("u1")))


def test_masked_arrays_are_refused(ball):
    """What is under a mask would be printed without a word."""
    masked = np.ma.masked_less(ball, 100)
    for take in (
        lambda: gp.Volume(masked, spacing=SPACING),
        lambda: bytes_of(Said(masked)),
        lambda: gp.Image(masked[0]),
        lambda: gp.Field((range(40), range(40)), masked[0] * 0.1),
        lambda: gp.Mesh(np.ma.masked_greater(gp.box(1, 1, 1).vertices, 0.5), gp.box(1, 1, 1).faces),
    ):
        with pytest.raises(gp.InputError, match=r"has masked entries|have masked entries"):
            take()
    assert bytes_of(masked.filled(0)) == bytes_of(np.where(ball < 100, 0, ball))
    assert bytes_of(np.ma.array(ball)) == bytes_of(ball)


class Far:
    dtype = np.dtype("u1")

    def __init__(self, shape):
        self.shape = shape

    def __getitem__(self, key):
        raise AssertionError("nothing is read of it")


@pytest.mark.parametrize(
    "shape, words",
    [
        ((2, 2**40, 2**40), "at most 67108864 voxels a plane"),
        ((2**63 - 1, 3, 3), "and 1048576 planes are handled"),
        ((2**70, 3, 3), "and 1048576 planes are handled"),
        ((3, 2**31, 2**31), "at most 67108864 voxels a plane"),
        ((3.5, 3, 3), "three whole numbers are needed"),
        (("3", 3, 3), "three whole numbers are needed"),
        ((np.nan, 3, 3), r"compute_chunk_sizes\(\)"),
    ],
)
def test_lengths_are_in_the_limits_of_files(shape, words):
    with pytest.raises(gp.InputError, match=words):
        gp.Volume(Far(shape), spacing=SPACING)


def test_grey_values_that_float32_rounds_are_warned_of(ball):
    """A detector's values on an offset keep few steps, and numbers beyond float32 are infinite; neither in silence."""
    def ids(array):
        return [w.id for w in gp.Job(gp.Volume(array, spacing=SPACING)).plan().warnings]

    for dtype in ("u4", "i8", "f8", ">u8"):
        assert "scan-values-rounded" in ids(ball.astype(dtype) + np.array(2**31 - 200, dtype)), dtype
        assert "scan-values-rounded" not in ids(ball.astype(dtype)), dtype
    dark = ball.astype("f8")
    dark[:, 0, 0] = -1e300
    assert "scan-not-finite" in ids(dark)
