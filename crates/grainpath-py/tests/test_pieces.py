"""Supports, specimens, examples, marker sheets, and what files are."""

import json

import numpy as np
import pytest

import grainpath as gp
from conftest import QUICK
from test_plan import command_line


@pytest.fixture(scope="module")
def table():
    """A slab on one leg."""
    slab, leg = gp.box(20, 20, 3), gp.box(6, 20, 12)
    vertices = np.vstack([slab.vertices + [0, 0, 11.5], leg.vertices])
    return gp.Mesh(vertices, np.vstack([slab.faces, leg.faces + 8]))


def test_supports_hold_what_hangs_over(table):
    mesh, report = gp.support(table, **QUICK)
    assert mesh.volume_mm3 > 0 and report["support"]["contacts"] > 0
    assert mesh.bounds_mm[0, 2] == pytest.approx(0, abs=0.5) and mesh.bounds_mm[1, 2] < 11.6
    assert mesh.bounds_mm[1, 0] > 10


def test_supports_of_a_plan(table):
    plan = gp.Job(table, support__style="tree", **QUICK).plan()
    assert plan.support_mesh().volume_mm3 > 0
    roles = {path.role for layer in plan.layers[:20] for path in layer}
    assert "Support material" in roles
    assert gp.Job(table, **QUICK).plan().support_mesh() is None


def test_inspect_says_what_the_command_says(stl):
    assert gp.inspect(stl) == json.loads(command_line("inspect", stl, "--json").stdout)
    assert gp.inspect(stl)["kind"] == "mesh"


def test_inspect_of_a_program_and_of_an_array(tmp_path, plan):
    (tmp_path / "a.gcode").write_bytes(plan.to_gcode())
    assert gp.inspect(tmp_path / "a.gcode")["kind"] == "gcode"
    np.save(tmp_path / "theta.npy", np.zeros((4, 5)))
    assert gp.inspect(tmp_path / "theta.npy")["kind"] == "directions"
    np.zeros((4, 5, 6), dtype="<u2").tofile(tmp_path / "scan.raw")
    assert gp.inspect(tmp_path / "scan.raw", size=(6, 5, 4), sample="uint16")["voxels"] == [6, 5, 4]


@pytest.mark.parametrize("size, sample", [((6, 5), "uint16"), ((6, 5, 0), "uint16"), ((6, 5, 4), "uint12")])
def test_inspect_refuses_what_is_no_size(tmp_path, size, sample):
    with pytest.raises(gp.JobError):
        gp.inspect(tmp_path / "scan.raw", size=size, sample=sample)
    with pytest.raises(gp.InputError, match="no.stl"):
        gp.inspect(tmp_path / "no.stl")


@pytest.mark.parametrize("name", list(gp.specimens()))
def test_every_specimen_is_a_closed_mesh(name):
    mesh, job = gp.specimen(name)
    assert mesh.volume_mm3 > 0
    assert job is None or job.shape is mesh


def test_unknown_names_have_a_nearest():
    with pytest.raises(gp.JobError, match="did you mean 'iso527-1[ab]'"):
        gp.specimen("iso527-1")
    with pytest.raises(gp.JobError, match="did you mean 'plate'"):
        gp.new("plat")
    with pytest.raises(gp.JobError, match="no preset 'xyzzy'. There are "):
        gp.new("xyzzy")


def test_examples_are_written_once(tmp_path):
    job, *_ = paths = gp.new("plate", tmp_path / "plate")
    assert job.endswith("job.toml") and len(paths) >= 2
    assert len(gp.Job.from_toml(job).plan().layers) > 1
    with pytest.raises(gp.JobError, match="force=True"):
        gp.new("plate", tmp_path / "plate")
    assert gp.new("plate", tmp_path / "plate", force=True) == paths


@pytest.mark.parametrize("preset, pixels", [("plate", 64), ("ct", 10), ("ct", 5000)])
def test_pixels_are_for_scans(preset, pixels):
    with pytest.raises(gp.JobError, match="pixels"):
        gp.new(preset, pixels=pixels)


def test_marker_sheets():
    assert gp.markers(100, 50).startswith(b"<svg") and gp.markers(100, 50, pdf=True).startswith(b"%PDF")
    for wrong in ((10, 50), (100, 5000), (float("nan"), 50)):
        with pytest.raises(gp.JobError, match="20 to 2000 mm"):
            gp.markers(*wrong)


@pytest.mark.parametrize("color", ["role", "width", "speed"])
def test_pictures_of_layers(plan, color):
    program = gp.gcode.loads(plan.to_gcode())
    assert program.render(0, color=color, size=200).startswith(b"\x89PNG")
    assert program.render(-1, color=color, size=200, svg=True).startswith(b"<svg")
    assert program.render(size=200).startswith(b"\x89PNG")


def test_pictures_of_directions(plate):
    plan = gp.Job(plate, guide__kind="angle", fill__pattern="stripes", **QUICK).plan()
    program = gp.gcode.loads(plan.to_gcode())
    assert program.render(1, color="direction", plan=plan, size=200).startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "options, words",
    [
        ({"color": "red"}, "color = 'red'"),
        ({"color": "direction"}, "needs plan="),
        ({"size": 3}, "size = 3"),
        ({"layer": 99}, "layer = 99 should be from 0 to 3"),
        ({"layer": -5}, "layer = -5"),
    ],
)
def test_wrong_pictures_are_named(plan, options, words):
    with pytest.raises(gp.InputError) as error:
        gp.gcode.loads(plan.to_gcode()).render(**{"layer": 0, **options})
    assert words in str(error.value)


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(gp.JobError, match="cannot be written: file exists"):
        gp.new("plate", tmp_path / "file")


def test_half_a_column_is_no_size(tmp_path):
    with pytest.raises(gp.InputError, match=r"size\[0\] = 60.7; a whole number is needed"):
        gp.inspect(tmp_path / "raw", size=(60.7, 60, 12))
