"""Stress and virtual tests, on our plans and on any program."""

import copy
import json
import pickle

import numpy as np
import pytest

import grainpath as gp
from test_plan import command_line

TEXT = """\
[process]
walls = 1
[fill]
pattern = "aligned"
density = 1.0
angles_deg = [0]
[[guide.fixture]]
on = { box_mm = [[0, 0, 0], [6, 8, 1]] }
fix = "xyz"
[[guide.load]]
on = { box_mm = [[34, 0, 0], [40, 8, 1]] }
force_n = [100, 0, 0]
[strength]
cell_mm = 1.0
corners = false
check = false
"""


@pytest.fixture(scope="module")
def bar():
    return gp.Job(gp.box(40, 8, 1), text=TEXT)


@pytest.fixture(scope="module")
def pulled(bar):
    return bar.with_(guide__kind="stress").plan()


@pytest.fixture(scope="module")
def tested(bar):
    return bar.strength()


def test_stress_of_a_pulled_bar(pulled):
    points = np.array([[20, 4, 0.5], [20, 2, 0.5], [24, 6, 0.2]])
    found = pulled.stress.at(points)
    # 100 N over 8 mm x 1 mm.
    assert found[:, 0] == pytest.approx([12.5] * 3, rel=0.03)
    assert np.abs(found[:, 1:]).max() < 0.6
    assert pulled.stress.tensors(points).shape == (3, 3, 3)
    values, axes = pulled.stress.principal(points)
    assert values[:, 0] == pytest.approx(found[:, 0], rel=0.01) and np.abs(axes[:, 0, 0]) == pytest.approx([1] * 3, abs=0.01)
    assert pulled.stress.von_mises(points) == pytest.approx([12.5] * 3, rel=0.05)


def test_stress_at_nodes_is_stress_at_points(pulled):
    (case,) = pulled.stress.cases
    some = slice(0, None, max(1, len(case.nodes) // 50))
    off = case.at(case.nodes[some]) - case.at_nodes[some]
    assert np.abs(off).max() < 1e-6 * np.abs(case.at_nodes).max()
    assert case.displacement is None or case.displacement.shape == case.nodes.shape
    with pytest.raises(TypeError, match="pickle its plan"):
        pickle.dumps(case)


def test_no_stress_without_loads(plan):
    assert plan.stress is None


@pytest.mark.parametrize("points", [np.zeros((3, 2)), np.zeros(3), [[0, 0, np.nan]], [["a"] * 3]])
def test_points_are_points(pulled, points):
    with pytest.raises(gp.InputError, match="points"):
        pulled.stress.at(points)


def test_no_points_no_stress(pulled):
    assert pulled.stress.at(np.zeros((0, 3))).shape == (0, 6)


def test_a_bar_carries_its_section(tested):
    # 8 mm2 of beads along the load: the card of PLA has 40 to 60 MPa along beads.
    assert 200 < tested.peak_n < 520
    low, high = tested.interval_n
    assert low <= tested.peak_n <= high
    assert tested.curve.shape[1] == 2 and tested.curve[:, 1].max() == pytest.approx(tested.peak_n, rel=0.02)
    assert tested.stiffness_n_per_mm > 0 and tested.mode and tested.weakest
    assert not tested.curve.flags.writeable


def test_the_command_line_finds_the_same(tested, stl):
    import json

    part = gp.box(40, 8, 1)
    rows = ["solid bar"]
    for face in part.vertices[part.faces]:
        rows.append("facet normal 0 0 0\nouter loop")
        rows += [f"vertex {x!r} {y!r} {z!r}" for x, y, z in face.tolist()]
        rows.append("endloop\nendfacet")
    stl.write_text("\n".join([*rows, "endsolid bar\n"]))
    job = stl.with_name("bar.toml")
    job.write_text(f'[shape]\nmesh = "{stl.name}"\n' + TEXT)
    ran = command_line("strength", job, "--json")
    theirs = json.loads(ran.stdout)["strength"]
    ours = dict(tested.report)
    theirs.pop("seconds"), ours.pop("seconds")
    assert ours == theirs


def test_a_program_of_any_slicer(bar, tested):
    program = gp.gcode.loads(bar.plan().to_gcode())
    assert program.strength(bar).peak_n == pytest.approx(tested.peak_n, rel=0.05)


def test_a_program_of_another_part_is_refused(bar):
    other = gp.gcode.loads(gp.Job(gp.box(90, 60, 1)).plan().to_gcode())
    with pytest.raises(gp.GrainpathError, match="program: "):
        other.strength(bar)


def test_side_by_side(bar, tested):
    across = bar.with_(fill__angles_deg=[90]).strength()
    first, second = gp.compare([tested, across])
    assert first["ratio"] == 1 and second["ratio"] == pytest.approx(across.peak_n / tested.peak_n, rel=1e-3)
    assert second["ratio"] < 1


@pytest.mark.parametrize("again", [copy.copy, lambda t: pickle.loads(pickle.dumps(t))])
def test_tests_pickle_as_numbers(tested, again):
    other = again(tested)
    assert other.peak_n == tested.peak_n and np.array_equal(other.curve, tested.curve)
    with pytest.raises(gp.JobError, match="cannot be compared"):
        gp.compare([tested, other])


def test_a_test_without_loads_says_so(plate):
    with pytest.raises(gp.JobError, match="strength"):
        gp.Job(plate).strength()


@pytest.mark.parametrize("angle_deg", [0, 30, 120])
def test_fill_follows_a_stress_of_another_program(angle_deg):
    points = np.random.default_rng(2).random((200, 3)) * [40, 30, 1]
    a = np.deg2rad(angle_deg)
    axis = np.array([np.cos(a), np.sin(a), 0])
    tensors = np.tile(10 * np.outer(axis, axis), (200, 1, 1))
    dense = {"process__top_layers": 0, "process__bottom_layers": 0, "fill__pattern": "stripes", "fill__density": 0.5}
    plan = gp.Job(gp.box(40, 30, 1), stress=gp.Stress(points, tensors), **dense).plan()
    steps = [np.diff(p.points, axis=0) for one in plan.layers for p in one if p.role == "Internal infill"]
    step = np.concatenate(steps)
    turn = np.arctan2(step[:, 1], step[:, 0]) - a
    off = np.abs(np.angle(np.exp(2j * turn))) / 2
    assert np.rad2deg(np.average(off, weights=np.hypot(*step.T))) < 4


@pytest.mark.parametrize(
    "points, tensors, words",
    [
        (np.zeros((0, 3)), np.zeros((0, 6)), "points is empty"),
        (np.zeros((2, 3)), np.zeros((3, 6)), "tensors has the shape (3, 6); (2, 6) is needed"),
        (np.zeros((2, 3)), np.zeros((2, 5)), "tensors has the shape (2, 5)"),
        (np.zeros((1, 3)), [[[0, 1, 0], [0, 0, 0], [0, 0, 0]]], "symmetric"),
        (np.zeros((1, 3)), np.full((1, 6), np.nan), "tensors[(0, 0)] is nan"),
    ],
)
def test_wrong_stress_is_named(points, tensors, words):
    with pytest.raises(gp.InputError) as error:
        gp.Stress(points, tensors)
    assert words in str(error.value)


def test_loads_are_checked_as_the_command_checks_them(bar, stl, tmp_path):
    found = bar.check()["stress"]
    assert found["cases"] == 1 and found["imbalance"] < 1e-6
    assert found["loads"][0]["force_n"] == pytest.approx([100, 0, 0], abs=1e-6)
    assert found["reactions"][0]["force_n"] == pytest.approx([-100, 0, 0], abs=1e-3)
    job = tmp_path / "job.toml"
    job.write_text(f'[shape]\nmesh = "{stl.name}"\n' + TEXT.replace("40, 8, 1", "30, 20, 1").replace("34, 0", "24, 0"))
    theirs = json.loads(command_line("run", job, "--check", "--json").stdout)
    assert gp.Job.from_toml(job).check()["stress"] == theirs["stress"]
    with pytest.raises(gp.GrainpathError, match="load"):
        gp.Job(gp.box(40, 8, 1)).check()
    with pytest.raises(gp.JobError, match="mesh or an outline"):
        bar.with_(gp.Volume(np.zeros((4, 5, 6), "u1"), spacing=1)).check()
