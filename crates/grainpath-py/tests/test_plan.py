"""Plans: the same bytes as the command line's, arrays of paths, the report."""

import json
import os
import pathlib
import re
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import grainpath as gp
from conftest import QUICK

JOB = """\
[shape]
mesh = "plate.stl"
[process]
layer_height_mm = 0.3
first_layer_height_mm = 0.3
[fill]
pattern = "{pattern}"
density = 0.4
[guide]
kind = "angle"
[output]
gcode = "plate.gcode"
"""


def command_line(*args):
    return subprocess.run([sys.executable, "-m", "grainpath", *map(str, args)], capture_output=True, check=False)


@pytest.mark.parametrize("pattern", ["grid", "rectilinear", "gyroid", "honeycomb", "concentric", "stripes"])
def test_bytes_are_those_of_the_command_line(stl, pattern):
    path = stl.with_name("job.toml")
    path.write_text(JOB.format(pattern=pattern))
    ran = command_line("run", path, "--json")
    assert ran.returncode == 0, ran.stderr
    plan = gp.Job.from_toml(path).plan()
    written = stl.with_name("plate.gcode").read_bytes()
    assert plan.to_gcode() == written
    # The same part as arrays.
    assert gp.Job.from_toml(path).with_(gp.read(stl)).plan().to_gcode() == written
    # The report is the same, but for times, memory and files.
    theirs, ours = json.loads(ran.stdout), plan.report
    for key in ("stages_s", "peak_rss_mb", "outputs"):
        theirs.pop(key), ours.pop(key)
    assert ours == theirs


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_the_number_of_threads_changes_nothing(plate, plan, threads):
    assert gp.Job(plate, **QUICK).plan(threads=threads).to_gcode() == plan.to_gcode()


@pytest.mark.parametrize("threads", [0, -1, 5000])
def test_threads_are_some(plate, threads):
    with pytest.raises((gp.JobError, OverflowError)):
        gp.Job(plate, **QUICK).plan(threads=threads)


def test_layers_are_arrays_that_outlive_the_plan(plate):
    plan = gp.Job(plate, **QUICK).plan()
    layer = plan.layers[1]
    points, before = layer.points, layer.points.copy()
    heights = [(one.z_top_mm, one.height_mm) for one in plan.layers]
    assert np.allclose(heights, [(0.3, 0.3), (0.6, 0.3), (0.9, 0.3), (1.2, 0.3)])
    del plan, layer
    assert np.array_equal(points, before) and not points.flags.writeable


def test_paths_agree_with_the_report(plan):
    length = sum(float(layer.paths["length_mm"].sum()) for layer in plan.layers)
    assert length == pytest.approx(plan.report["printed_mm"], rel=1e-3)
    assert sum(len(layer) for layer in plan.layers) == plan.report["toolpaths"]
    for layer in plan.layers:
        assert layer.paths["count"].sum() == len(layer.points) == len(layer.widths_mm)
        for path in layer:
            ends = np.vstack([path.points, path.points[:1]]) if path.closed else path.points
            steps = np.hypot(*np.diff(ends, axis=0).T).sum()
            assert steps == pytest.approx(path.length_mm)
            assert path.role in gp.gcode.ROLES and (path.widths_mm > 0).all()


def test_layers_are_a_sequence(plan):
    assert len(plan.layers[:2]) == 2 and plan.layers[-1].z_top_mm == plan.layers[3].z_top_mm
    assert len(plan.layers[0][:2]) == 2 and plan.layers[0][-1].length_mm > 0
    for wrong in (4, -5):
        with pytest.raises(IndexError):
            plan.layers[wrong]
    with pytest.raises(IndexError):
        plan.layers[0][10_000]
    with pytest.raises(ValueError, match="read-only"):
        plan.layers[0].paths["length_mm"] = 0


def test_sections_are_rings(plan):
    assert len(plan.sections) == 4
    (outer,) = plan.sections[0][0]
    assert np.array_equal(np.ptp(outer, axis=0), [30, 20])


def test_strength_of_settings_matters(plate):
    light = gp.Job(plate, fill__density=0.1, process__top_layers=0, process__bottom_layers=0, **QUICK)
    assert light.plan().report["mass_g"] < light.with_(fill__density=0.9).plan().report["mass_g"]


def test_progress_names_stages(plate):
    seen = []
    gp.Job(gp.box(100, 100, 30), fill__pattern="gyroid").plan(progress=lambda *args: seen.append(args))
    assert seen and all(isinstance(stage, str) and 0 <= done for stage, done, _ in seen)


def test_an_exception_of_the_callers_function_comes_back_as_it_was(plate):
    class Mine(Exception):
        pass

    def progress(stage, done, total):
        raise Mine(stage)

    with pytest.raises(Mine) as error:
        gp.Job(gp.box(150, 150, 60), fill__pattern="gyroid").plan(progress=progress)
    assert error.traceback[-1].name == "progress"


def test_a_token_cancels():
    token = threading.Event()
    token.set()
    with pytest.raises(gp.Cancelled, match="nothing was written"):
        gp.Job(gp.box(150, 150, 60), fill__pattern="gyroid").plan(cancel=token)


def test_short_plans_look_at_the_token_and_tell_progress(plate):
    """Of a plan that took less than a step of the watch neither was looked at."""
    token, seen = threading.Event(), []
    job = gp.Job(plate, **QUICK)
    job.plan(cancel=token, progress=lambda *args: seen.append(args))
    assert seen and seen[-1][1] == seen[-1][2]
    token.set()
    for call in (job.plan, job.orient, job.plan().measure):
        with pytest.raises(gp.Cancelled, match="nothing was written"):
            call(cancel=token)


def test_a_part_beside_the_bed_is_refused():
    with pytest.raises(gp.PhysicsError, match="the part measures 2000.00 x 10.00 x 1.00 mm"):
        gp.Job(gp.box(2000, 10, 1)).plan()


def test_open_meshes_are_warned_of():
    box = gp.box(20, 20, 2)
    plan = gp.Job(gp.Mesh(box.vertices, box.faces[1:]), **QUICK).plan()
    assert plan.warnings and all(w.id and w.text and w.remedy for w in plan.warnings)
    assert {w["id"] for w in plan.report["warnings"]} >= {w.id for w in plan.warnings}


def test_plans_run_side_by_side(plate, plan):
    found = [None] * 4

    def one(k):
        found[k] = gp.Job(plate, **QUICK).plan().to_gcode()

    threads = [threading.Thread(target=one, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(text == plan.to_gcode() for text in found)


def test_a_forked_child_plans():
    code = """
import multiprocessing, grainpath as gp
def length(_):
    return len(gp.Job(gp.box(20, 10, 1)).plan().to_gcode())
if __name__ == "__main__":
    mine = length(0)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map(length, range(3)) == [mine] * 3
    print("done")
"""
    ran = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, timeout=120, check=False)
    assert ran.stdout == b"done\n", ran.stderr


def test_shown_in_notebooks(plan):
    shown = plan._repr_html_()
    assert "<table>" in shown and shown.count("<script>") == 1
    # Nothing is loaded.
    assert "http" not in shown and "src=" not in shown
    data = drawn(shown)
    assert [one["text"] for one in data["layers"]] == [
        f"layer {k + 1} of {len(plan.layers)}, {layer.z_top_mm:.4g} mm" for k, layer in enumerate(plan.layers)
    ]
    for one, layer in zip(data["layers"], plan.layers, strict=True):
        assert [path[0] for path in one["paths"]] == layer.paths["role"].tolist()
    # Two pictures of the same plan have elements of their own.
    assert re.search('id="(.*?)"', shown)[1] != re.search('id="(.*?)"', plan._repr_html_())[1]


def drawn(shown):
    return json.loads(re.search(r"const data = (.*);\n", shown)[1])


def test_pictures_of_layers_are_to_scale(plan):
    """Corners of the outer wall, which are half a bead inside of the plate, 2 steps of the picture at the most off."""
    layers = drawn(plan._repr_html_())["layers"]
    wall = next(p for p in layers[2]["paths"] if gp.gcode.ROLES[p[0]] == "External perimeter")
    ours = next(p for p in plan.layers[2] if p.role == "External perimeter")
    skirt = next(p for p in plan.layers[0] if p.role == "Skirt")
    scale = gp.pictures.STEPS / max(np.ptp(skirt.points, axis=0) + skirt.widths_mm.max())
    places = np.reshape(wall[3], (-1, 2))
    assert np.allclose(np.ptp(places, axis=0), np.ptp(ours.points, axis=0) * scale, atol=2)
    assert wall[1] == 1 and wall[2] == pytest.approx(ours.widths_mm.mean() * scale, abs=0.06)


def test_pictures_of_layers_are_bounded(plan, monkeypatch):
    whole = len(plan._repr_html_())
    monkeypatch.setattr(gp.pictures, "MAX_POINTS", 150)
    fewer = drawn(plan._repr_html_())
    assert len(plan._repr_html_()) < whole
    assert 1 <= len(fewer["layers"]) < len(plan.layers)
    assert fewer["layers"][0]["text"].startswith(f"layer 1 of {len(plan.layers)},")
    n_points = sum(len(points) // 2 for one in fewer["layers"] for *_, points in one["paths"])
    assert n_points <= 150 or len(fewer["layers"]) == 1


def test_thinned_paths_stay_where_they_were():
    turn = np.linspace(0, 2 * np.pi, 720)
    points = np.rint(400 * np.stack([np.cos(turn), np.sin(turn)], axis=1)).astype(int)
    kept = gp.pictures._thinned(points, 1)
    assert len(kept) < 0.3 * len(points) and (kept[[0, -1]] == points[[0, -1]]).all()
    starts, steps = kept[:-1, None], np.diff(kept, axis=0)[:, None]
    share = (((points - starts) * steps).sum(-1) / (steps**2).sum(-1)).clip(0, 1)
    off = np.linalg.norm(points - starts - share[..., None] * steps, axis=-1).min(axis=0)
    assert off.max() <= gp.pictures.THINNED


def test_colours_are_those_of_the_studio():
    page = (pathlib.Path(__file__).parents[3] / "web/src/colours.ts").read_text()
    rows = re.findall(r"\[(\d+), (\d+), (\d+)\], //", page.split("CLASS_COLOURS")[1].split("];")[0])
    theirs = ["#%02x%02x%02x" % tuple(map(int, row)) for row in rows]
    # The last is that of travels.
    assert list(gp.pictures.COLOURS) == theirs[:-1] and len(theirs) == len(gp.gcode.ROLES) + 1


def test_no_array_can_be_made_writeable_again(plan, plate, ball):
    layer, program = plan.layers[0], gp.gcode.loads(plan.to_gcode())
    stress = gp.Stress([[0, 0, 0]], [[1, 0, 0, 0, 0, 0]])
    arrays = {
        "paths": layer.paths,
        "a path": layer[0].points,
        "points": layer.points,
        "widths": layer.widths_mm,
        "a ring": plan.stack[0].polygons[0][0],
        "heights": plan.stack.z_top_mm,
        "areas": plan.stack.areas_mm2,
        "vertices": plate.vertices,
        "faces": plate.faces,
        "beads": program.beads,
        "travels": program.travels,
        "z": program.z_mm,
        "stress": stress.tensors,
        "picture": gp.Image(ball[0]).array,
    }
    for name, array in arrays.items():
        while isinstance(array, np.ndarray):
            assert not array.flags.writeable, name
            with pytest.raises(ValueError, match="WRITEABLE"):
                array.flags.writeable = True
            array = array.base
        assert isinstance(array, bytes), name


def test_an_empty_array_is_read_only_too():
    from grainpath._checks import read_only

    for shape in ((0,), (0, 3), (2, 0, 3)):
        array = read_only(np.zeros(shape))
        assert array.shape == shape and not array.flags.writeable


def test_drawing_frees_the_lock(plan):
    """Another thread counts while a picture is drawn."""
    program, counted, ended = gp.gcode.loads(plan.to_gcode()), [0], threading.Event()

    def count():
        while not ended.is_set():
            counted[0] += 1
            # Lets the lock go, for the thread that draws.
            time.sleep(0)

    # The interpreter itself takes the lock from a thread after an hour only, so what is counted shows that it was let go.
    interval = sys.getswitchinterval()
    sys.setswitchinterval(3600.0)
    thread = threading.Thread(target=count)
    try:
        thread.start()
        before = counted[0]
        for layer in (0, None):
            program.render(layer, size=4000)
            assert counted[0] > before
            before = counted[0]
    finally:
        sys.setswitchinterval(interval)
        ended.set()
        thread.join()


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="processes cannot be bound to a core here")
@pytest.mark.parametrize("within", ["array", "progress"])
def test_a_function_of_the_callers_may_plan_in_turn(within):
    """On one core the work that asked the function and the plan in it waited for each other."""
    code = """
import os, sys, numpy as np
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
import grainpath as gp
small = gp.Job(gp.box(20, 10, 1))
class Pin:
    shape, dtype = (200, 200, 200), np.dtype("u1")
    plane = np.zeros((200, 200), "u1")
    plane[50:150, 50:150] = 200
    def __getitem__(self, key):
        if sys.argv[1] == "array":
            small.plan()
        return np.broadcast_to(self.plane, (key.stop - key.start, 200, 200))
progress = (lambda *_: small.plan()) if sys.argv[1] == "progress" else None
print(len(gp.Job(gp.Volume(Pin(), spacing=0.2)).plan(progress=progress).layers))
"""
    ran = subprocess.run([sys.executable, "-c", code, within], capture_output=True, text=True, timeout=60, check=False)
    assert ran.stdout == "200\n", ran.stderr
