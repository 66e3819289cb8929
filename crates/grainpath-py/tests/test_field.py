"""Direction fields: what infill follows, from arrays and from functions."""

import pickle

import numpy as np
import pytest

import grainpath as gp
from conftest import QUICK

X, Y = np.linspace(-2, 32, 69), np.linspace(-2, 22, 49)
FILL = {"fill__pattern": "stripes", "fill__density": 0.5, "process__walls": 1, **QUICK}
DENSE = {"process__top_layers": 0, "process__bottom_layers": 0}


def rings(points):
    return np.arctan2(points[:, 1] - 10, points[:, 0] + 20) + np.pi / 2


def off_deg(plan, angle):
    """Mean angle between the fill and what is asked for, weighted by length, degrees."""
    offs, lengths = [], []
    for layer in plan.layers:
        for path in layer:
            if path.role == "Internal infill":
                step = np.diff(path.points, axis=0)
                middle = 0.5 * (path.points[1:] + path.points[:-1])
                turn = np.arctan2(step[:, 1], step[:, 0]) - angle(middle)
                offs.append(np.abs(np.angle(np.exp(2j * turn))) / 2)
                lengths.append(np.hypot(*step.T))
    return float(np.rad2deg(np.average(np.concatenate(offs), weights=np.concatenate(lengths))))


@pytest.mark.parametrize("angle_deg", [0, 30, 90, 135])
def test_fill_follows_one_direction(plate, angle_deg):
    field = gp.Field((X, Y), np.full((len(X), len(Y)), np.deg2rad(angle_deg)))
    plan = gp.Job(plate, field=field, **FILL, **DENSE).plan()
    # Joints along the border are 0.8 mm for each line of 20 mm at least, and lie up to 90 degrees off: 3.6 on average.
    assert off_deg(plan, lambda p: np.full(len(p), np.deg2rad(angle_deg))) < 3.6


def test_fill_follows_rings(plate):
    field = gp.Field((X, Y), rings)
    plan = gp.Job(plate, field=field, **FILL, **DENSE).plan()
    assert off_deg(plan, rings) < 4
    assert plan.report["field"]["layout"] == "a grid of 69 x 49 cells (x, y)"
    assert field.error_deg < 0.1


def test_angles_vectors_and_functions_are_one_field(plate):
    points = np.stack(np.meshgrid(X, Y, indexing="ij"), -1)
    angles = rings(points.reshape(-1, 2)).reshape(points.shape[:2])
    vectors = np.stack([np.cos(angles), np.sin(angles)], -1)
    fields = [
        gp.Field((X, Y), angles),
        gp.Field((X, Y), angles.astype(">f8")),
        gp.Field((X, Y), np.asfortranarray(angles)),
        gp.Field((X, Y), vectors),
        gp.Field((X, Y), rings),
        gp.Field((X, Y), lambda p: np.stack([np.cos(rings(p)), np.sin(rings(p))], -1)),
    ]
    programs = [gp.Job(plate, field=f, **FILL, **DENSE).plan().to_gcode() for f in fields]
    assert all(p == programs[0] for p in programs)


def test_a_direction_has_no_sign(plate):
    field, turned = gp.Field((X, Y), rings), gp.Field((X, Y), lambda p: rings(p) + np.pi)
    a, b = (gp.Job(plate, field=f, **FILL, **DENSE).plan() for f in (field, turned))
    assert off_deg(a, rings) == pytest.approx(off_deg(b, rings), abs=0.2)


def test_uneven_axes(plate):
    x = np.concatenate([np.linspace(-2, 10, 40), np.linspace(10.5, 32, 20)])
    plan = gp.Job(plate, field=gp.Field((x, Y), rings), **FILL, **DENSE).plan()
    assert off_deg(plan, rings) < 4


def test_directions_that_turn_with_height(plate):
    def turning(points):
        return np.where(points[:, 2] < 0.6, 0.0, np.pi / 2)

    z = np.array([0.15, 0.45, 0.75, 1.05])
    field = gp.Field((np.linspace(-2, 32, 18), np.linspace(-2, 22, 13), z), turning)
    plan = gp.Job(plate, field=field, **FILL, **DENSE).plan()
    ways = []
    for k in (0, 3):
        steps = [np.diff(p.points, axis=0) for p in plan.layers[k] if p.role == "Internal infill"]
        step = np.abs(np.concatenate(steps)).sum(axis=0)
        ways.append(step[0] > step[1])
    assert ways == [True, False]


def test_functions_are_called_in_batches_from_this_thread():
    import threading

    sizes, threads = [], set()

    def function(points):
        sizes.append(len(points))
        threads.add(threading.get_ident())
        return np.zeros(len(points))

    gp.Field((np.arange(400.0), np.arange(400.0)), function)
    assert max(sizes) == 65_536 and threads == {threading.get_ident()} and sum(sizes) < 160_000 + 4500


def test_the_callers_exception_has_its_own_traceback():
    def broken(points):
        return points / ("a",)

    with pytest.raises(TypeError) as error:
        gp.Field((X, Y), broken)
    assert error.traceback[-1].name == "broken"


def test_the_error_of_a_coarse_grid_is_stated():
    fine, coarse = (gp.Field((np.linspace(0, 10, n),) * 2, lambda p: 0.05 * p[:, 0] ** 2) for n in (101, 6))
    assert fine.error_deg < 0.1 < coarse.error_deg


def test_the_error_of_a_field_that_turns_with_height_is_stated():
    # Even in each plane, so that only places between the levels show it.
    def turning(points):
        return 0.3 * points[:, 2]

    x, y = np.linspace(0, 20, 11), np.linspace(0, 10, 6)
    coarse, fine = (gp.Field((x, y, np.linspace(0, 6, n)), turning) for n in (3, 25))
    # From level to level the direction turns by 0.9 rad, its doubled angle by 1.8; the chord is not even with the arc.
    t = np.linspace(0, 1, 2001)
    chord = np.angle((1 - t) + t * np.exp(1.8j)) - 1.8 * t
    assert coarse.error_deg == pytest.approx(np.rad2deg(np.abs(chord).max() / 2), rel=0.02)
    assert 0 < fine.error_deg < 0.05 * coarse.error_deg


@pytest.mark.parametrize("level", range(5))
def test_the_error_of_one_bad_level_is_stated(level):
    x, z = np.linspace(0, 10, 21), np.arange(5.0)
    fine = gp.Field((x, x, z), lambda p: np.zeros(len(p)))

    def bad(points):
        return np.where(points[:, 2] == level, 0.1 * points[:, 0] ** 2, 0.0)

    assert fine.error_deg == 0
    # Steps of 0.5 mm are off a parabola by an eighth of the square of the step times its bend, and the rest by more.
    assert gp.Field((x, x, z), bad).error_deg >= np.rad2deg(0.5**2 * 0.2 / 8) * 0.9


def test_a_function_that_meets_the_grid_in_the_middle_of_cells_is_caught():
    # Between 0 and 10 it turns to and fro, with the grid's value at points and middles.
    x = np.linspace(0, 10, 11)
    field = gp.Field((x, x), lambda p: 0.4 * np.sin(2 * np.pi * p[:, 0]))
    assert field.error_deg == pytest.approx(np.rad2deg(0.4), rel=0.01)


def test_the_error_where_no_direction_is_known_is_no_number():
    x = np.arange(5.0)

    def odd(points):
        on_grid = (points == np.round(points)).all(axis=1)
        return np.where(on_grid & (points.sum(axis=1) % 2 == 0), 0.0, np.nan)

    assert np.isnan(gp.Field((x, x), odd).error_deg)


def test_fields_over_a_part(plate):
    field = gp.Field.over(plate, rings, cell_mm=0.5)
    assert field.shape == (61, 41)
    assert off_deg(gp.Job(plate, field=field, **FILL, **DENSE).plan(), rings) < 4


def test_fields_pickle_without_their_function(plate):
    job = gp.Job(plate, field=gp.Field((X, Y), lambda p: rings(p)), **FILL)
    assert pickle.loads(pickle.dumps(job)).plan().to_gcode() == job.plan().to_gcode()


def test_fields_beside_the_part_are_refused(plate):
    far = gp.Field((X + 500, Y), np.zeros((len(X), len(Y))))
    with pytest.raises(gp.InputError, match="the directions lie from"):
        gp.Job(plate, field=far, **FILL).plan()


def test_spacing_and_strength(plate):
    n = (len(X), len(Y))
    field = gp.Field((X, Y), np.zeros(n), strength=np.full(n, 0.5), spacing_mm=2.0)
    wide = gp.Job(plate, field=field, **FILL, **DENSE).plan()
    narrow = gp.Job(plate, field=gp.Field((X, Y), np.zeros(n)), **FILL, **DENSE).plan()
    assert wide.report["printed_mm"] < narrow.report["printed_mm"]


def test_holes_in_a_field_are_filled(plate):
    angles = np.zeros((len(X), len(Y)))
    angles[20:30, 20:30] = np.nan
    plan = gp.Job(plate, field=gp.Field((X, Y), angles), **FILL, **DENSE).plan()
    assert off_deg(plan, lambda p: np.zeros(len(p))) < 3
    assert any(w.id == "field-left-out" for w in plan.warnings)


@pytest.mark.parametrize(
    "axes, directions, others, words",
    [
        ((X,), np.zeros(len(X)), {}, "axes has 1 entries"),
        ((X, Y), np.zeros((len(Y), len(X))), {}, "(69, 49) is needed"),
        ((X, Y[::-1]), np.zeros((69, 49)), {}, "axes[1] should rise"),
        ((X, np.array([])), np.zeros((69, 0)), {}, "axes[1] should rise"),
        ((X, np.full(49, np.nan)), np.zeros((69, 49)), {}, "axes[1][0] is nan"),
        ((X, Y), np.full((69, 49), np.nan), {}, "all are NaN"),
        ((X, Y), np.full((69, 49), "a"), {}, "directions has the type"),
        ((X, Y), lambda p: np.zeros(3), {}, "the function returned the shape (3,)"),
        ((X, Y), lambda p: ["a"] * len(p), {}, "the function returned the type"),
        ((X, Y), lambda p: np.zeros((len(p), 4)), {}, "a vector"),
        ((X, Y), np.zeros((69, 49)), {"strength": np.full((69, 49), 2.0)}, "strength should be from 0 to 1"),
        ((X, Y), np.zeros((69, 49)), {"strength": np.zeros((3, 3))}, "strength has the shape (3, 3)"),
        ((X, Y), np.zeros((69, 49)), {"spacing_mm": 0.0}, "spacing_mm should be above 0"),
        ((np.arange(3000.0), np.arange(3000.0)), np.zeros(1), {}, "at most 4000000"),
    ],
)
def test_wrong_fields_are_named(axes, directions, others, words):
    with pytest.raises(gp.InputError) as error:
        gp.Field(axes, directions, **others)
    assert words in str(error.value)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("components", [0, 2, 3])
def test_what_is_no_finite_direction_is_a_hole(plate, value, components):
    shape = (len(X), len(Y)) + ((components,) if components else ())
    directions = np.ones(shape) if components else np.full(shape, np.pi / 4)
    directions[20:30, 20:30] = value
    plan = gp.Job(plate, field=gp.Field((X, Y), directions), **FILL, **DENSE).plan()
    assert off_deg(plan, lambda p: np.full(len(p), np.pi / 4)) < 3
    assert any(w.id == "field-left-out" for w in plan.warnings)


@pytest.mark.parametrize("size", [1e300, 1e-300, 1e-310])
def test_only_the_direction_of_a_vector_counts(size):
    """The squares of these are no numbers."""
    x = np.linspace(0, 30, 31)
    turned = np.deg2rad(37)
    plate = gp.box(30, 20, 1)
    vectors = np.broadcast_to([np.cos(turned), np.sin(turned)], (31, 31, 2))

    def printed(field):
        return gp.Job(plate, field=field, fill__pattern="stripes", **QUICK).plan().to_gcode()

    plain = printed(gp.Field((x, x), vectors))
    for given in (vectors * size, lambda p: np.broadcast_to(vectors[0, 0], (len(p), 2)) * size):
        field = gp.Field((x, x), given)
        assert field.error_deg < 1e-6
        assert printed(field) == plain


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: gp.Field(5, [[0.0]]), "axes has the type int"),
        (lambda: gp.Field(([0.0, 1.0], [0.0]), lambda p: [[1.0], [1.0, 2.0]]), "what the function returned is no array"),
        (lambda: gp.Field.over(gp.Volume(np.ones((2, 2, 2))), lambda p: p[:, 0]), "part is a Volume; a Mesh is needed"),
        (lambda: gp.Field.over(gp.box(60, 30, 1), lambda p: p[:, 0], cell_mm=1e-7), "a grid of .* points; at most"),
        (lambda: gp.Field.over(gp.box(60, 30, 1), lambda p: p[:, 0], cell_mm=np.inf), "cell_mm is inf"),
    ],
)
def test_what_makes_no_field_is_told_at_once(make, words):
    with pytest.raises(gp.InputError, match=words):
        make()


@pytest.mark.parametrize("again", [lambda f: f, lambda f: pickle.loads(pickle.dumps(f))], ids=["made", "unpacked"])
def test_the_arrays_of_a_field_are_its_own(again):
    x, y = np.linspace(0, 20, 21), np.linspace(0, 10, 11)
    angles, ones = np.zeros((21, 11)), np.ones((21, 11))
    field = again(gp.Field((x, y), angles, strength=ones, spacing_mm=ones))
    assert not np.shares_memory(x, field.axes[0]) and not np.shares_memory(ones, field.strength)
    for array in (*field.axes, field.vectors, field.strength, field.spacing_mm):
        with pytest.raises(ValueError):
            array.setflags(write=True)
    assert again(gp.Field((x, y), lambda p: p[:, 0] * 0.1)).error_deg == gp.Field((x, y), lambda p: p[:, 0] * 0.1).error_deg
