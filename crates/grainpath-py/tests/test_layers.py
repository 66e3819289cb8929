"""Parts as sections: rings in, rings and bytes out."""

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import grainpath as gp
from conftest import QUICK

TURN = np.linspace(0, 2 * np.pi, 64, endpoint=False)
CIRCLE = np.stack([np.cos(TURN), np.sin(TURN)], axis=1)
#: Area of the 64-gon over the square of its radius.
AREA = 32 * np.sin(2 * np.pi / 64)
SQUARE = np.array([[0, 0], [10, 0], [10, 10], [0, 10]])


def moves(program):
    """The program without its comments, which name the part."""
    return [line for line in program.splitlines() if not line.startswith(b";")]


@pytest.fixture(scope="module")
def cup():
    return gp.LayerStack([[20 * CIRCLE]] * 2 + [[20 * CIRCLE, 15 * CIRCLE]] * 4, height_mm=0.3)


def test_rings_become_sections(cup):
    assert cup.areas_mm2 == pytest.approx([400 * AREA] * 2 + [175 * AREA] * 4, rel=1e-4)
    assert cup.z_top_mm == pytest.approx(0.3 * np.arange(1, 7)) and cup.height_mm == pytest.approx(0.3)
    assert cup.volume_mm3 == pytest.approx(0.3 * AREA * (800 + 700), rel=1e-4)
    assert [len(section.polygons[0]) for section in cup] == [1, 1, 2, 2, 2, 2]
    section = cup[-1]
    assert section.z_top_mm == pytest.approx(1.8) and len(section.rings) == 2 and len(cup[1:3]) == 2
    with pytest.raises(ValueError, match="read-only"):
        section.rings[0][0] = 7


def test_a_job_of_sections_prints_them(cup):
    plan = gp.Job(cup, fill__density=1.0, **QUICK).plan()
    assert len(plan.layers) == 6 and plan.stack == cup
    radii = np.concatenate([np.hypot(*(path.points.T)) for path in plan.layers[4] if path.role != "Skirt"])
    assert radii.min() > 15 and radii.max() < 20
    beads = gp.gcode.loads(plan.to_gcode()).beads
    assert beads["volume_mm3"][beads["layer"] > 0].sum() == pytest.approx(cup.volume_mm3 - 0.3 * 400 * AREA, rel=0.03)


def test_the_sections_of_a_plan_have_the_plan_of_its_mesh():
    piece, _ = gp.specimen("critical-angle")
    job = gp.Job(piece, fill__pattern="gyroid", **QUICK)
    plan = job.plan()
    again = job.with_(gp.LayerStack.from_bytes(plan.stack.to_bytes())).plan()
    assert moves(again.to_gcode()) == moves(plan.to_gcode())


def test_stacks_are_copied_and_pickled(cup):
    for other in (pickle.loads(pickle.dumps(cup)), copy.copy(cup), copy.deepcopy(cup), gp.LayerStack.from_bytes(cup.to_bytes())):
        assert other == cup and other.to_bytes() == cup.to_bytes()
    assert len(cup.to_bytes()) < 8 * sum(len(r) for s in cup for r in s.rings)
    job = gp.Job(cup, **QUICK)
    assert pickle.loads(pickle.dumps(job)).plan().to_gcode() == job.plan().to_gcode()
    assert cup != gp.LayerStack([[20 * CIRCLE]], height_mm=0.3)


def test_rules_say_what_is_inside():
    rings = [SQUARE, SQUARE + 5]
    assert gp.LayerStack([rings], height_mm=0.2).areas_mm2 == pytest.approx([150])
    assert gp.LayerStack([rings], height_mm=0.2, rule="non-zero").areas_mm2 == pytest.approx([175])


def test_polygons_that_came_out_go_in_again(cup):
    again = gp.LayerStack([section.polygons for section in cup], height_mm=cup.height_mm)
    assert again.areas_mm2 == pytest.approx(cup.areas_mm2)


@settings(max_examples=30, deadline=None)
@given(st.integers(3, 40), st.floats(0.1, 500), st.floats(-1e3, 1e3), st.booleans())
def test_rings_of_any_layout(n, radius, shift, turned):
    turn = 2 * np.pi * np.arange(n) / n
    ring = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1) + shift
    wide = np.zeros((n, 4), dtype=">f8")
    wide[:, ::2] = ring[::-1] if turned else ring
    stack = gp.LayerStack([[wide[:, ::2]]], height_mm=0.2)
    # Each vertex moves by half a step of the grid at most.
    slack = 1e-4 * 2 * np.pi * radius + 1e-8
    assert stack.areas_mm2[0] == pytest.approx(0.5 * n * radius**2 * np.sin(2 * np.pi / n), abs=slack)


def test_layers_without_area_are_gaps(cup):
    stack = gp.LayerStack([[SQUARE], [], [SQUARE]], height_mm=[0.3, 0.3, 0.2])
    assert stack.areas_mm2.tolist() == [100, 0, 100] and stack[1].rings == []
    with pytest.raises(gp.InputError, match="no layer of the part has any area"):
        gp.Job(gp.LayerStack([[], []], height_mm=0.3)).plan()
    with pytest.raises(gp.InputError, match="no layer"):
        gp.Job(gp.LayerStack([], height_mm=0.3)).plan()


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: gp.LayerStack([[SQUARE[:, :1]]], height_mm=0.2), r"sections\[0\]\[0\] has the shape \(4, 1\)"),
        (lambda: gp.LayerStack([[SQUARE * np.nan]], height_mm=0.2), r"sections\[0\]\[0\]\[0, 0\] is nan"),
        (lambda: gp.LayerStack([[SQUARE * 1e7]], height_mm=0.2), "100 m"),
        (lambda: gp.LayerStack([[SQUARE]], height_mm=0), r"height_mm\[0\] should be above 0"),
        (lambda: gp.LayerStack([[SQUARE]], height_mm=[0.2, 0.2]), "height_mm has the shape"),
        (lambda: gp.LayerStack([[SQUARE]], height_mm=0.2, rule="odd"), "even-odd"),
        (lambda: gp.LayerStack.from_bytes(b"solid"), "not a layer stack"),
        (lambda: gp.LayerStack.from_bytes("solid"), "data is a str; bytes"),
        (lambda: gp.LayerStack.from_bytes(b"GPLS\x07"), "version 7"),
    ],
)
def test_what_is_no_stack_is_refused(make, message):
    with pytest.raises(gp.InputError, match=message):
        make()


@pytest.mark.parametrize("setting", [{"shape__scale": 2}, {"shape__rotate_deg": [0, 0, 30]}, {"process__adaptive_layers": True}])
def test_settings_that_change_a_part_are_refused(cup, setting):
    with pytest.raises(gp.JobError, match="printed as they are"):
        gp.Job(cup, **setting)


def test_a_damaged_stack_is_an_error_at_a_place(cup):
    data = cup.to_bytes()
    for cut in (5, 20, len(data) - 1):
        with pytest.raises(gp.InputError, match="ends at byte"):
            gp.LayerStack.from_bytes(data[:cut])


def test_notebooks_show_parts(cup, plan, ball):
    for shown in (cup, plan, plan.job, gp.Volume(ball, spacing=0.2), gp.box(1, 2, 3), gp.gcode.loads(plan.to_gcode())):
        text = shown._repr_html_()
        assert text.startswith("<table><caption>") and text.count("<tr>") == text.count("</tr>") >= 2
    assert "<svg" in cup._repr_html_() and "evenodd" in cup[3]._repr_svg_()


@pytest.mark.parametrize(
    "sections, words",
    [(5, "sections is a int"), ([None], r"sections\[0\] is a NoneType"), ([[1, 2, 3]], r"sections\[0\]\[0\] has the shape \(\)")],
)
def test_what_holds_no_rings_is_told(sections, words):
    with pytest.raises(gp.InputError, match=words):
        gp.LayerStack(sections, height_mm=0.2)


def test_layers_thicker_than_a_bead_is_wide_are_refused(cup):
    """As process.layer_height_mm is, whose place the heights of sections take."""
    with pytest.raises(gp.JobError) as error:
        gp.Job(gp.box(5, 5, 10), process__layer_height_mm=5)
    words = "process.bead_width_mm (0.45) should not be less than the layer height (5)"
    assert words in str(error.value)
    with pytest.raises(gp.JobError) as error:
        gp.Job(gp.LayerStack([[SQUARE], [SQUARE]], height_mm=[0.2, 5]))
    assert words in str(error.value)
    thick = gp.LayerStack([[SQUARE]] * 2, height_mm=0.8)
    assert len(gp.Job(thick, process__bead_width_mm=1.0, printer__nozzle_mm=0.8).plan().layers) == 2
