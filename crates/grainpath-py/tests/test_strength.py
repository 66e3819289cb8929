"""Stress and virtual tests, on our plans and on any program."""

import copy
import json
import pickle
import threading

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


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda t: pickle.loads(pickle.dumps(t))])
@pytest.mark.parametrize("what", ["solid", "plane", "given"])
def test_stress_pickles_and_copies(pulled, bar, again, what):
    points = np.array([[20, 4, 0.5], [3, 2, 0.5], [90, 6, 0.2]])
    if what == "given":
        given = gp.Stress(np.random.default_rng(5).random((60, 3)) * [40, 8, 1], np.arange(360.0).reshape(60, 6))
        found = bar.with_(stress=given).plan().stress
    else:
        found = bar.with_(guide__kind="stress", guide__analysis=what).plan().stress
    other = again(found)
    assert np.array_equal(other.at(points), found.at(points)) and repr(other) == repr(found)
    (case,), (of_other,) = found.cases, other.cases
    assert np.array_equal(case.nodes, of_other.nodes) and np.array_equal(case.at_nodes, of_other.at_nodes)
    assert (case.displacement is None) == (of_other.displacement is None)
    assert case.displacement is None or np.array_equal(case.displacement, of_other.displacement)
    assert (case.name, case.weight) == (of_other.name, of_other.weight) and again(case).name == case.name


def test_a_notebook_shows_stress_and_reports(pulled, bar, tested):
    (case,) = pulled.stress.cases
    largest = pulled.stress.von_mises(case.nodes).max()
    for shown in (case._repr_html_(), pulled.stress._repr_html_()):
        assert shown.startswith("<table>") and f"{largest:.4g} MPa" in shown and case.name in shown
    loads = bar.check()
    assert f"<th>stress.cases</th><td>{loads['stress']['cases']}</td>" in loads._repr_html_()
    report = pulled.report
    shown = report._repr_html_()
    assert f"<th>mass_g</th><td>{report['mass_g']:.6g}</td>" in shown and "<th>quality.gap</th>" in shown
    assert json.loads(json.dumps(report)) == report and pickle.loads(pickle.dumps(report))._repr_html_() == shown
    assert "peak_load_n" in tested.report._repr_html_()


def test_a_report_shows_its_warnings_and_escapes_them():
    report = gp.report.Report("R", {"warnings": [{"id": "a-b", "text": "<x> & y"}], "seam": None, "ok": True, "at": [1.0, 2.0]})
    shown = report._repr_html_()
    assert "<th>warnings: a-b</th><td>&lt;x&gt; &amp; y</td>" in shown and "<td>1, 2</td>" in shown
    assert "<td>none</td>" in shown and "<td>yes</td>" in shown


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


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda t: pickle.loads(pickle.dumps(t))])
def test_tests_pickle_and_are_compared_as_before(bar, tested, again):
    other = again(tested)
    assert other.peak_n == tested.peak_n and np.array_equal(other.curve, tested.curve)
    assert other.report == tested.report and other.warnings == tested.warnings
    across = bar.with_(fill__angles_deg=[90]).strength()
    # To the last bit, since numbers are written in full.
    assert gp.compare([other, again(across)]) == gp.compare([tested, across])


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
        (np.zeros((1, 3)), np.full((1, 6), np.nan), "tensors[0, 0] is nan"),
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


def test_poses_are_those_of_the_command(bar, stl, tmp_path):
    job = tmp_path / "job.toml"
    text = TEXT.replace("40, 8, 1", "30, 20, 1").replace("34, 0", "24, 0")
    job.write_text(f'[shape]\nmesh = "{stl.name}"\n' + text)
    theirs = json.loads(command_line("orient", job, "--json").stdout)["poses"]
    ours = gp.Job.from_toml(job).orient()["poses"]
    assert ours == theirs and len(ours) >= 2
    # The same part as arrays.
    assert gp.Job.from_toml(job).with_(gp.read(stl)).orient()["poses"] == theirs
    assert {"rotate_deg", "reserve", "support_g", "height_mm", "time_s"} <= set(ours[0])
    # Without loads there is no reserve, and the flattest pose is the best.
    flat = gp.Job(gp.box(40, 8, 1)).orient()["poses"]
    assert "reserve" not in flat[0] and flat[0]["height_mm"] == 1


def test_what_cannot_be_oriented_is_refused(bar):
    with pytest.raises(gp.JobError, match="mesh or an outline"):
        bar.with_(gp.Volume(np.zeros((4, 5, 6), "u1"), spacing=1)).orient()
    stop = threading.Event()
    stop.set()
    with pytest.raises(gp.Cancelled):
        bar.orient(cancel=stop)


CORNERS = np.array([[0.0, 0, 0], [40, 8, 1]])
PULL = np.tile([10.0, 0, 0, 0, 0, 0], (2, 1))


def test_points_have_to_reach_over_the_part():
    """The message gives both boxes, since what is wrong is no unit of a file."""
    job = gp.Job(gp.box(40, 8, 1), guide__kind="angle", fill__pattern="stripes", fill__density=0.4)
    with pytest.raises(gp.GrainpathError) as error:
        job.with_(stress=gp.Stress(CORNERS * 0.5, PULL)).plan()
    told = str(error.value)
    assert "to (20.00, 4.00, 0.50) mm, the part from (0.00, 0.00, 0.00) to (40.00, 8.00, 1.00) mm" in told
    assert "reach over the whole part" in told
    assert job.with_(stress=gp.Stress(CORNERS, PULL)).plan().report["stress"]["max_von_mises_mpa"] == 10.0


@pytest.mark.parametrize(
    "tensor, words",
    [([0, 0, 0, 0, 0, 0], "zero everywhere"), ([5, 5, 5, 0, 0, 0], "same in all directions"), ([0, 0, 7, 0, 0, 0], "same in all directions")],
)
def test_a_stress_that_leads_nowhere_is_warned_of(tensor, words):
    job = gp.Job(gp.box(40, 8, 1), guide__kind="angle", fill__pattern="stripes", fill__density=0.4)
    given = gp.Stress(CORNERS, np.tile(np.array(tensor, float), (2, 1)))
    warned = [w for w in job.with_(stress=given).plan().warnings if w.id == "fe-zero-stress"]
    assert len(warned) == 1 and words in warned[0].text
    plain = job.with_(stress=gp.Stress(CORNERS, PULL)).plan()
    assert "fe-zero-stress" not in [w.id for w in plain.warnings]


@pytest.mark.parametrize("factor", [1e155, 1e-12, 1e-155])
def test_stress_beyond_what_is_followed_is_refused(factor):
    with pytest.raises(gp.InputError, match="the largest of tensors is 1e.* MPa; from 1e-09 to 1e.100 MPa"):
        gp.Stress(CORNERS, PULL * factor)


def test_an_unpacked_stress_cannot_be_written():
    again = pickle.loads(pickle.dumps(gp.Stress(CORNERS, PULL)))
    for array in (again.points, again.tensors):
        with pytest.raises(ValueError):
            array.setflags(write=True)
