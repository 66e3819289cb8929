"""Arrays of any type, byte order and strides, empty ones and ones with NaN, for all that takes arrays."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import grainpath as gp

ORDERS = st.sampled_from("<>")
FLOATS = st.sampled_from(["f4", "f8"])
LAYOUTS = st.sampled_from(["C", "F", "reversed", "strided", "offset"])


def laid(values, kind, layout):
    """The same numbers as another array: other strides, or an address that the type is not aligned to."""
    array = np.array(values, dtype=kind)
    if layout == "F":
        return np.asfortranarray(array)
    if layout == "reversed":
        return np.ascontiguousarray(array[::-1])[::-1]
    if layout == "strided":
        wide = np.zeros([2 * n for n in array.shape], dtype=array.dtype)
        every = (slice(None, None, 2),) * array.ndim
        wide[every] = array
        return wide[every]
    if layout == "offset":
        raw = np.zeros(array.nbytes + 1, dtype="u1")
        raw[1:] = np.frombuffer(array.tobytes(), "u1")
        return raw[1:].view(array.dtype).reshape(array.shape)
    return array


@given(kind=st.sampled_from(["u1", "u2", "i4", "f4", "f8"]), order=ORDERS, layout=LAYOUTS, shape=st.sampled_from([(4, 6), (4, 6, 3)]))
def test_pictures(kind, order, layout, shape):
    values = np.arange(np.prod(shape)).reshape(shape) * 3
    kept = {"u1": "u1", "u2": "u2"}.get(kind, "f4")
    image = gp.Image(laid(values, order + kind, layout))
    assert image.array.dtype == np.dtype(kept)
    assert np.array_equal(image.array, values.reshape(4, 6, -1))


@given(kind=FLOATS, order=ORDERS, layout=LAYOUTS, form=st.sampled_from(["angles", "2", "3"]))
def test_fields(kind, order, layout, form):
    x, y = np.arange(5.0), np.arange(4.0)
    shape = (5, 4) if form == "angles" else (5, 4, int(form))
    values = 1 + np.arange(np.prod(shape)).reshape(shape) / 8
    # Eighths are exact in both types.
    plain = gp.Field((x, y), values, strength=np.full((5, 4), 0.5))
    other = gp.Field(
        (laid(x, order + kind, layout), laid(y, order + kind, layout)),
        laid(values, order + kind, layout),
        strength=laid(np.full((5, 4), 0.5), order + kind, layout),
    )
    assert other.vectors.dtype == np.float64 and np.array_equal(other.vectors, plain.vectors)
    assert np.array_equal(other.strength, plain.strength)


@given(kind=FLOATS, order=ORDERS, layout=LAYOUTS, matrices=st.booleans())
def test_stress(kind, order, layout, matrices):
    points = np.arange(18.0).reshape(6, 3)
    tensors = np.arange(36.0).reshape(6, 6)
    given_ = tensors[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(6, 3, 3) if matrices else tensors
    stress = gp.Stress(laid(points, order + kind, layout), laid(given_, order + kind, layout))
    assert np.array_equal(stress.points, points) and np.array_equal(stress.tensors, tensors)


@given(kind=FLOATS, order=ORDERS, layout=LAYOUTS)
def test_sections(kind, order, layout):
    square = [[0, 0], [8, 0], [8, 4.5], [0, 4.5]]
    stack = gp.LayerStack([[laid(square, order + kind, layout)]] * 2, height_mm=0.25)
    assert stack == gp.LayerStack([[np.array(square, dtype=float)]] * 2, height_mm=0.25)


#: What takes arrays, with the shape of an array that is right.
TAKERS = {
    "mesh": (lambda a: gp.Mesh(a, np.zeros((1, 3), int)), (4, 3)),
    "volume": (lambda a: gp.Volume(a, spacing=1), (3, 4, 5)),
    "image": (gp.Image, (4, 5, 3)),
    "angles": (lambda a: gp.Field(([0, 1], [0, 1, 2]), a), (2, 3)),
    "vectors": (lambda a: gp.Field(([0, 1], [0, 1, 2]), a), (2, 3, 3)),
    "points": (lambda a: gp.Stress(a, np.zeros((4, 6))), (4, 3)),
    "tensors": (lambda a: gp.Stress(np.zeros((4, 3)), a), (4, 6)),
}


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data(), name=st.sampled_from(sorted(TAKERS)), kind=st.sampled_from(["u1", "i8", "f4", "f8"]))
def test_empty_arrays_are_refused_by_name(data, name, kind):
    take, shape = TAKERS[name]
    axis = data.draw(st.integers(0, len(shape) - 1))
    with pytest.raises(gp.InputError):
        take(np.zeros([0 if k == axis else n for k, n in enumerate(shape)], dtype=kind))


@given(data=st.data(), name=st.sampled_from(sorted(TAKERS)), value=st.sampled_from([np.nan, np.inf, -np.inf]), order=ORDERS)
def test_single_values_that_are_no_numbers(data, name, value, order):
    """Where a number is needed they are refused with their place; in a scan, a picture and a field they are holes."""
    take, shape = TAKERS[name]
    array = np.ones(shape, dtype=order + "f8")
    at = tuple(data.draw(st.integers(0, n - 1)) for n in shape)
    array[at] = value
    if name in ("mesh", "points", "tensors"):
        with pytest.raises(gp.InputError, match="finite numbers are needed") as error:
            take(array)
        assert str(list(at)) in str(error.value)
    else:
        take(array)


@given(name=st.sampled_from(sorted(set(TAKERS) - {"volume"})), value=st.sampled_from([np.nan, np.inf, -np.inf]))
def test_arrays_without_a_number_are_refused(name, value):
    take, shape = TAKERS[name]
    with pytest.raises(gp.InputError):
        take(np.full(shape, value))


@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(share=st.floats(0, 1), seed=st.integers(0, 9), kind=FLOATS)
def test_scans_with_any_share_of_nan_are_planned_or_refused(ball, share, seed, kind):
    """A voxel without a value is air: NaN or 0 outside the material are the same program."""
    holes = ball.astype(kind)
    lost = (np.random.default_rng(seed).random(ball.shape) < share) & (ball == 0)
    # Air that is known is what the threshold is found from.
    lost[:, 0, :] = False
    holes[lost] = np.nan
    job = gp.Job(gp.Volume(holes, spacing=(0.3, 0.5, 0.5)), process__layer_height_mm=0.3)
    areas = job.plan().stack.areas_mm2
    right = job.with_(gp.Volume(ball, spacing=(0.3, 0.5, 0.5))).plan().stack.areas_mm2
    assert np.allclose(areas, right, rtol=0.02)
