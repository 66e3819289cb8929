"""The viewer of notebooks: its records hold every bead once, and they are those of the studio."""

import base64
import json
import pathlib
import re
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import grainpath as gp
from conftest import QUICK
from grainpath.records import NO_ANGLE, RECORD, SAME_MM, SEAM, START, TRAVEL, Records
from grainpath.viewer import COLORS

DATA = pathlib.Path(__file__).parents[3] / "web/tests/data"
#: Programs state coordinates to 0.001 mm.
PROGRAM_MM = 0.0005


def told(records):
    """Layer, ends and row of each bead, as the viewer reads them, and the rows of all else."""
    rows, index = records.rows, records.index
    points = np.stack([rows["x"], rows["y"]], axis=1) * index["step_mm"] + index["origin_mm"]
    layer = np.repeat(np.arange(len(index["layers"])), [one["records"] for one in index["layers"]])
    kind = rows["kind"] % SEAM
    is_bead = kind < TRAVEL
    # What comes before a record is the point where its bead begins.
    before = np.flatnonzero(is_bead) - 1
    assert (layer[before] == layer[is_bead]).all()
    return layer[is_bead], np.stack([points[before], points[is_bead]], axis=1), rows[is_bead], rows[~is_bead]


@pytest.mark.parametrize("pattern", ["grid", "gyroid", "stripes"])
def test_every_segment_of_a_plan_is_there_once(plate, pattern):
    x, y = np.linspace(0, 30, 31), np.linspace(0, 20, 21)
    field = gp.Field((x, y), np.arctan2(y[None, :] + 5, x[:, None] + 5) + np.pi / 2)
    own = {"field": field} if pattern == "stripes" else {}
    plan = gp.Job(plate, fill__pattern=pattern, fill__density=0.4, process__top_layers=1, **own, **QUICK).plan()
    records = Records(gp.gcode.loads(plan.to_gcode()))
    layers, ends, rows, _ = told(records)
    segments = [(k, path, i) for k, layer in enumerate(plan.layers) for path in layer for i in range(len(path.points) - 1 + path.closed)]
    assert len(segments) == len(rows) > 300
    assert [k for k, *_ in segments] == layers.tolist()
    assert [gp.gcode.ROLES[kind % SEAM] for kind in rows["kind"].tolist()] == [path.role for _, path, _ in segments]
    wanted = np.array([np.roll(path.points, -i, axis=0)[:2] for _, path, i in segments]) + plan.plate_from_part_mm[:2]
    # Half a step, half of the program's last digit, and its floats.
    assert np.abs(ends - wanted).max() <= 0.5 * records.index["step_mm"] + PROGRAM_MM + 2e-5
    assert records.index["step_mm"] < 0.01
    closed = sum(path.closed and path.role.endswith("erimeter") for layer in plan.layers for path in layer)
    assert (rows["kind"] >= SEAM).sum() == closed == sum(one["seams"] for one in records.index["layers"]) > 0


places = st.tuples(st.integers(0, 40_000), st.integers(0, 40_000)).map(lambda p: (p[0] / 1000, p[1] / 1000))
moves = st.lists(st.tuples(st.sampled_from(["print", "print", "travel", "layer", "role"]), places, st.integers(10, 90)), min_size=1, max_size=60)


@settings(max_examples=150, deadline=None)
@given(moves)
def test_every_bead_of_a_program_is_there_once(moves):
    text, z, roles = ["M83", "G1 Z0.2 F600"], 0.2, ["External perimeter", "Internal infill", "Skirt"]
    for k, (what, (x, y), speed) in enumerate(moves):
        if what == "layer":
            z += 0.2
            text += [";LAYER_CHANGE", f"G1 Z{z:.2f} F600"]
        elif what == "role":
            text.append(f";TYPE:{roles[k % 3]}")
        else:
            text.append(f"G1 X{x} Y{y} {'E0.3 ' if what == 'print' else ''}F{60 * speed}")
    program = gp.gcode.loads("\n".join(text))
    if len(program.beads) == 0:
        with pytest.raises(gp.InputError, match="nothing is printed"):
            Records(program)
        return
    records, beads = Records(program), program.beads
    layers, ends, rows, others = told(records)
    assert layers.tolist() == beads["layer"].tolist()
    assert (rows["kind"] % SEAM).tolist() == beads["role"].tolist()
    # A bead begins where the one before ended, so that the start may be off by what counts as the same place.
    off = np.abs(ends - np.stack([beads["start"], beads["end"]], axis=1))
    assert (off.max(axis=(0, 2)) <= 0.51 * records.index["step_mm"] + np.array([float(SAME_MM), 0]) + 2e-5).all()
    assert np.abs(rows["width_um"] - 1e3 * beads["width_mm"].astype(float).clip(0, 65.535)).max() <= 0.51
    speeds = np.array(records.index["speeds_mm_s"])[rows["speed"]]
    assert np.abs(speeds - beads["speed_mm_s"]).max() <= 0.06
    assert set(others["kind"].tolist()) <= {TRAVEL, START} and (others["kind"] == START).sum() <= len(program.z_mm)
    assert sum(one["beads"] for one in records.index["layers"]) == len(beads) == sum(one["beads"] for one in records.index["shares"])


@pytest.mark.parametrize("name", ["squares.gcode", "bar-prusaslicer.gcode"])
def test_records_are_those_of_the_studio(name):
    """Tests of the page hold the studio and the viewer in a browser against the same file."""
    wanted = json.loads((DATA / "records.json").read_text())[name]
    records = Records(gp.gcode.read(DATA / name))
    assert records.rows.tobytes() == base64.b64decode(wanted["records"])
    ours = {key: value for key, value in records.index.items() if key != "time_s"}
    assert ours.keys() == wanted["index"].keys()
    for key in ("layers", "shares"):
        for row, other in zip(ours.pop(key), wanted["index"].pop(key), strict=True):
            assert row == pytest.approx(other, rel=1e-6)
    assert ours == wanted["index"]


def test_many_speeds_share_a_table():
    text = ["M83", "G1 Z0.2 F600", *(f"G1 X{k % 7} E0.05 F{600 + 6 * k}" for k in range(1000))]
    program = gp.gcode.loads("\n".join(text))
    records = Records(program)
    _, _, rows, _ = told(records)
    speeds = np.array(records.index["speeds_mm_s"])
    assert len(speeds) == 256
    # 1000 speeds of 0.1 mm/s apart, of which every fourth is kept.
    below = program.beads["speed_mm_s"] - speeds[rows["speed"]]
    assert -0.01 < below.min() and below.max() < 0.41


def test_angles_lie_at_their_beads():
    records = Records(gp.gcode.read(DATA / "squares.gcode"))
    off = np.linspace(0, 90, len(records.of_bead))
    off[3] = np.nan
    angles = np.frombuffer(records.angles(off), np.uint8)
    assert len(angles) == len(records.rows)
    is_bead = records.rows["kind"] % SEAM < TRAVEL
    assert (angles[~is_bead] == NO_ANGLE).all() and angles[is_bead][3] == NO_ANGLE
    known = np.delete(angles[is_bead], 3)
    assert np.abs(known / 2 - np.delete(off, 3)).max() <= 0.25 and known[-1] == 180


@pytest.mark.parametrize("angle", [0, 30, 90])
def test_colours_show_the_angle_off_the_guide(plate, angle):
    """A field along x, and infill that keeps an angle of its own: the angle is that of each bead."""
    along = gp.Field((np.array([0.0, 30.0]), np.array([0.0, 20.0])), np.zeros((2, 2)))
    own = {"fill__pattern": "rectilinear", "fill__angles_deg": [angle], "process__top_layers": 0, "process__bottom_layers": 0}
    plan = gp.Job(plate, field=along, fill__density=0.5, **own, **QUICK).plan()
    viewer = plan.view(color="direction")
    program = gp.gcode.loads(plan.to_gcode())
    records = Records(program)
    told = np.frombuffer(viewer._angles, np.uint8)[records.of_bead]
    beads = program.beads
    x, y = np.abs((beads["end"] - beads["start"]).astype(float)).T
    length = np.hypot(x, y)
    # The skirt is no part; a program states its ends to 0.001 mm.
    is_part = beads["role"] != gp.gcode.ROLES.index("Skirt")
    assert (told[~is_part] == NO_ANGLE).all() and 0 < is_part.sum() < len(beads)
    long = is_part & (length > 1)
    assert np.abs(told[long] / 2 - np.rad2deg(np.arctan2(y, x))[long]).max() < 0.35
    fill = long & (beads["role"] == gp.gcode.ROLES.index("Internal infill"))
    assert np.median(told[fill] / 2) == pytest.approx(angle, abs=0.5)
    # What another slicer's program says of its guide is not known.
    with pytest.raises(gp.InputError, match="needs a plan whose guide"):
        program.view(color="direction")


def test_a_viewer_holds_the_program(plan):
    viewer = plan.view(color="speed", layers=(1, 2), height_px=300)
    records = Records(gp.gcode.loads(plan.to_gcode()))
    state = viewer.get_state()
    assert bytes(state["_records"]) == records.rows.tobytes() and len(state["_records"]) % RECORD.itemsize == 0
    assert state["_index"] == json.loads(json.dumps(records.index))
    assert (state["color"], tuple(state["layers"]), state["height_px"]) == ("speed", (1, 2), 300)
    assert "forceContextLoss" in state["_esm"]
    # What the browser sends back.
    viewer.set_state({"layers": [0, 3], "color": "width"})
    assert (viewer.layers, viewer.color) == ((0, 3), "width")
    assert repr(viewer) == "<grainpath.viewer.Viewer: layers 0 to 3 of 4 by width>"


def test_the_viewer_asks_nothing_of_the_network(plan):
    text = plan.view().get_state()["_esm"]
    assert "three.js authors" in text[:1000]
    assert not any(word in text for word in ("import(", "importScripts", "cdn.", "unpkg", "jsdelivr"))


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"color": "direction"}, "needs a plan whose guide asks for directions"),
        ({"color": "time"}, "should be one of role, speed"),
        ({"layers": (3, 1)}, r"layers = \(3, 1\) should be two of 0 to 3, the lower first"),
        ({"layers": (-1, 1)}, "should be two of 0 to 3"),
        ({"layers": (0, 4)}, "should be two of 0 to 3"),
        ({"height_px": 3}, "height_px = 3 should be from 100 to 4000 pixels"),
    ],
)
def test_wrong_wishes_are_refused(plan, given, why):
    with pytest.raises(gp.InputError, match=why):
        plan.view(**given)
    viewer = plan.view()
    for name, value in given.items():
        with pytest.raises(gp.InputError, match=why):
            setattr(viewer, name, value)
    assert (viewer.layers, viewer.color, viewer.height_px) == ((0, 3), "role", 480)


def test_colours_are_those_of_the_viewer():
    page = (DATA.parents[1] / "src/colours.ts").read_text().split("COLOUR_BY:")[1].split("];")[0]
    names = re.findall(r'\["(\w+)", "', page)
    assert [name.replace("load", "direction") for name in names if name not in ("time", "reserve")] == list(COLORS)


def test_widths_are_right_for_any_filament():
    pytest.importorskip("anywidget")
    thin, thick = (gp.Job(gp.box(20, 10, 1), printer__filament_mm=mm).plan().view()._index["widths_mm"] for mm in (1.75, 2.85))
    assert thick == pytest.approx(thin, rel=0.1) and 0.4 < thick[1] < 0.6


def test_without_anywidget_the_viewer_says_what_to_install(plan, monkeypatch):
    monkeypatch.delitem(sys.modules, "grainpath.viewer")
    monkeypatch.delattr(gp, "viewer")
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(ImportError, match=r'anywidget is missing\): pip install "grainpath\[notebook\]"'):
        plan.view()
    assert "<canvas" in plan._repr_html_()


@pytest.mark.parametrize("given, words", [({"layers": 3}, "layers = 3"), ({"layers": ("a", 1)}, "layers = 'a'"), ({"color": None}, "color = None")])
def test_what_is_no_view_is_told(plan, given, words):
    with pytest.raises(gp.InputError, match=words):
        plan.view(**given)
