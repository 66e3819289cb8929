"""Sweeps: tables that survive failures, interruptions and executors."""

import concurrent.futures
import os
import sys

import numpy as np
import pytest

import grainpath as gp
from conftest import QUICK
from grainpath import sweeps

SETTINGS = {"fill.density": [0.2, 0.4], "process.walls": [1, 2]}


def numbers(table):
    return [{k: v for k, v in row.items() if k not in ("seconds", "cached")} for row in table]


@pytest.fixture
def job(plate):
    return gp.Job(plate, process__top_layers=0, process__bottom_layers=0, **QUICK)


def test_rows_are_all_combinations(job):
    table = gp.sweep(job, SETTINGS)
    assert [(row["fill.density"], row["process.walls"]) for row in table] == [(0.2, 1), (0.2, 2), (0.4, 1), (0.4, 2)]
    assert all(row["error"] is None and row["mass_g"] > 0 and not row["cached"] for row in table)
    assert table[0]["mass_g"] < table[2]["mass_g"] and len(table[1:]) == 3
    plan = job.with_(fill__density=0.4, process__walls=2).plan()
    assert table[3]["mass_g"] == plan.report["mass_g"]
    assert "<table>" in table._repr_html_() and repr(table) == "<grainpath.Sweep: 4 jobs, 0 failed>"


@pytest.mark.parametrize("in_flight", [1, 2, 16])
def test_threads_and_processes_find_the_same(job, in_flight):
    here = numbers(gp.sweep(job, SETTINGS))
    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        assert numbers(gp.sweep(job, SETTINGS, executor=threads, in_flight=in_flight)) == here
    with concurrent.futures.ProcessPoolExecutor(2) as processes:
        assert numbers(gp.sweep(job, SETTINGS, executor=processes, in_flight=in_flight)) == here


def test_failures_are_rows(job):
    table = gp.sweep(job, {"fill.density": [0.2, -7, 0.4], "shape.scale": [1, 20]})
    errors = [row["error"] for row in table]
    assert [e is None for e in errors] == [True, False, False, False, True, False]
    assert errors[1].startswith("PhysicsError: ") and errors[2].startswith("JobError: ")
    assert table[1]["mass_g"] is None


def test_what_is_in_the_cache_is_not_computed_again(job, tmp_path, monkeypatch):
    first = gp.sweep(job, SETTINGS, cache=tmp_path)
    monkeypatch.setattr(sweeps, "measure", lambda *_: pytest.fail("computed again"))
    second = gp.sweep(job, SETTINGS, cache=tmp_path)
    assert numbers(first) == numbers(second) and all(row["cached"] for row in second)
    assert len(os.listdir(tmp_path)) == 4


def test_a_sweep_goes_on_where_it_was(job, tmp_path, monkeypatch):
    measure, calls = sweeps.measure, []

    def stopping(job, point, threads):
        if len(calls) == 2:
            raise KeyboardInterrupt
        calls.append(point)
        return measure(job, point, threads)

    monkeypatch.setattr(sweeps, "measure", stopping)
    with pytest.raises(KeyboardInterrupt):
        gp.sweep(job, SETTINGS, cache=tmp_path)
    monkeypatch.setattr(sweeps, "measure", measure)
    table = gp.sweep(job, SETTINGS, cache=tmp_path)
    assert [row["cached"] for row in table] == [True, True, False, False]


@pytest.mark.parametrize("what", ["part", "field", "setting", "load"])
def test_another_job_is_another_entry(plate, job, tmp_path, what):
    gp.sweep(job, {"process.walls": [1]}, cache=tmp_path)
    x = np.linspace(-5, 40, 10)
    other = {
        "part": lambda: job.with_(gp.box(30, 20, 1.5)),
        "field": lambda: job.with_(field=gp.Field((x, x), np.zeros((10, 10)))),
        "setting": lambda: job.with_(fill__density=0.7),
        "load": lambda: gp.Job(plate, text="[[guide.load]]\non = { box_mm = [[0, 0, 0], [1, 1, 1]] }\nforce_n = [1, 0, 0]", **QUICK),
    }[what]()
    (row,) = gp.sweep(other, {"process.walls": [1]}, cache=tmp_path)
    assert not row["cached"]


def test_a_changed_file_is_another_entry(stl, tmp_path):
    job = gp.Job(shape__mesh=str(stl), **QUICK)
    cache = tmp_path / "cache"
    assert not gp.sweep(job, {"process.walls": [1]}, cache=cache)[0]["cached"]
    assert gp.sweep(job, {"process.walls": [1]}, cache=cache)[0]["cached"]
    stl.write_text(stl.read_text().replace("1.2", "1.5"))
    assert not gp.sweep(job, {"process.walls": [1]}, cache=cache)[0]["cached"]


#: A bar with its loads as a deck of CalculiX has them.
DECK = """*NODE
1, 0, 0, 0
2, 30, 0, 0
3, 0, 20, 0
4, 0, 0, 1.2
*ELEMENT, TYPE=C3D4, ELSET=ALL
1, 1, 2, 3, 4
*BOUNDARY
1, 1, 3
3, 1, 3
4, 1, 3
*STEP
*STATIC
*CLOAD
2, 1, FORCE
*END STEP
"""
#: For each kind of file: the job's text, its files, and what they have after a change.
NAMED = {
    "mesh of a region": (
        '[[region]]\non = { mesh = "region.stl" }\nprocess = { walls = 4 }\n',
        {"region.stl": "STL 12"},
        {"region.stl": "STL 18"},
    ),
    "raw file of a header": (
        '[shape]\nct = "scan.mhd"\n',
        {"scan.mhd": "MHD", "scan.raw": "RAW 10"},
        {"scan.raw": "RAW 14"},
    ),
    "file of densities": (
        '[fill]\ndensity = { min = 0.1, max = 0.9, by = "file", file = "density.csv", array = "density" }\n',
        {"density.csv": "x,y,z,density\n0,0,0,0.2\n30,0,0,0.2\n0,20,0,0.2\n"},
        {"density.csv": "x,y,z,density\n0,0,0,0.5\n30,0,0,0.5\n0,20,0,0.5\n"},
    ),
    "deck of loads": ('[guide]\ndeck = "loads.inp"\n', {"loads.inp": DECK}, {"loads.inp": DECK.replace("FORCE", "7")}),
    "profile of a material": ('[material]\nprofile = "own.toml"\n', {"own.toml": "CARD 1.1"}, {"own.toml": "CARD 1.4"}),
    "material of fibre": (
        '[printer]\nprofile = "fibre-coextruded"\n[fibre]\nenabled = true\nmaterial = "./fibre.toml"\n',
        {"fibre.toml": "CARD 1.1"},
        {"fibre.toml": "CARD 1.4"},
    ),
}


def content(said):
    """What a file of :data:`NAMED` has."""
    word, *number = said.split(" ")
    if word == "STL":
        mesh = gp.box(float(number[0]), 10, 2)
        rows = ["outer loop\n" + "\n".join(f"vertex {x} {y} {z}" for x, y, z in mesh.vertices[face]) for face in mesh.faces]
        facets = "".join(f"facet normal 0 0 0\n{row}\nendloop\nendfacet\n" for row in rows)
        return f"solid a\n{facets}endsolid a\n".encode()
    if word == "MHD":
        return (
            b"ObjectType = Image\nNDims = 3\nDimSize = 40 40 8\nElementType = MET_UCHAR\n"
            b"ElementSpacing = 0.3 0.3 0.3\nElementDataFile = scan.raw\n"
        )
    if word == "RAW":
        z, y, x = np.mgrid[:8, :40, :40]
        return (200 * (np.hypot(x - 20, y - 20) < int(number[0]))).astype("u1").tobytes()
    if word == "CARD":
        return f"density_g_cm3 = {number[0]}\n".encode()
    return said.encode()


@pytest.mark.parametrize("what", NAMED)
def test_a_change_of_any_file_that_a_job_reads_is_another_entry(plate, tmp_path, what, monkeypatch):
    text, files, changed = NAMED[what]
    folder = tmp_path / "job"
    folder.mkdir()
    for name, said in files.items():
        (folder / name).write_bytes(content(said))
    # What the rows hold does not matter here, and a deck of one element is no part that could be solved.
    monkeypatch.setattr(sweeps, "measure", lambda *_: {**dict.fromkeys(sweeps.COLUMNS), "warnings": [], "seconds": 0.0, "error": None})
    job = gp.Job(None if "[shape]" in text else plate, text=text, folder=folder, **QUICK)

    def cached():
        return [row["cached"] for row in gp.sweep(job, {"process.walls": [1, 2]}, cache=tmp_path / "cache")]

    assert cached() == [False, False]
    assert cached() == [True, True]
    for name, said in changed.items():
        (folder / name).write_bytes(content(said))
    assert cached() == [False, False]
    assert cached() == [True, True]


def test_files_that_the_settings_of_a_sweep_name_are_hashed(stl, tmp_path):
    other = stl.parent / "other.stl"
    other.write_text(stl.read_text().replace("1.2", "1.8"))
    settings, cache = {"shape.mesh": [str(stl), str(other)]}, tmp_path / "cache"
    first = gp.sweep(gp.Job(**QUICK), settings, cache=cache)
    assert first[0]["mass_g"] < first[1]["mass_g"]
    other.write_text(stl.read_text().replace("1.2", "2.4"))
    second = gp.sweep(gp.Job(**QUICK), settings, cache=cache)
    assert [row["cached"] for row in second] == [True, False] and second[1]["mass_g"] > first[1]["mass_g"]


def test_a_mesh_with_other_paint_is_another_entry(tmp_path, painted):
    cache = tmp_path / "cache"
    for k, paint in enumerate(("4", "8")):
        job = gp.Job(painted(f"{k}.3mf", paint), **QUICK)
        assert not gp.sweep(job, {"process.walls": [1]}, cache=cache)[0]["cached"]
        assert gp.sweep(job, {"process.walls": [1]}, cache=cache)[0]["cached"]


def test_a_damaged_entry_is_computed_again(job, tmp_path):
    gp.sweep(job, {"process.walls": [1]}, cache=tmp_path)
    (entry,) = tmp_path.iterdir()
    entry.write_text('{"mass')
    assert not gp.sweep(job, {"process.walls": [1]}, cache=tmp_path)[0]["cached"]
    assert gp.sweep(job, {"process.walls": [1]}, cache=tmp_path)[0]["cached"]


def test_failures_are_not_kept(job, tmp_path):
    gp.sweep(job, {"shape.scale": [20]}, cache=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_lost_worker_is_a_row(job):
    class Losing:
        def submit(self, fn, *args):
            future = concurrent.futures.Future()
            future.set_exception(concurrent.futures.process.BrokenProcessPool("gone"))
            return future

    table = gp.sweep(job, SETTINGS, executor=Losing())
    assert all(row["error"] == "BrokenProcessPool: gone" for row in table)


@pytest.mark.parametrize("settings", [{"fill.density": []}, {"fill.density": 0.3}, {"fill.pattern": "grid"}])
def test_values_are_lists(job, settings):
    with pytest.raises(gp.JobError, match="a list of at least one value"):
        gp.sweep(job, settings)
    with pytest.raises(gp.JobError, match="in_flight"):
        gp.sweep(job, SETTINGS, in_flight=0)


class Broken:
    """A scan whose store fails."""

    shape, dtype = (4, 20, 20), np.dtype("u1")

    def __getitem__(self, key):
        raise OSError("disk on fire")


@pytest.mark.parametrize("threads", [None, 2])
def test_an_array_that_cannot_be_read_is_a_row(threads):
    job = gp.Job(gp.Volume(Broken(), spacing=0.3))
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        table = gp.sweep(job, {"process.walls": [1, 2]}, executor=threads and pool)
    assert [row["error"] for row in table] == ["OSError: disk on fire"] * 2


def test_values_may_be_any_numbers_in_a_row(job, tmp_path):
    plain = gp.sweep(job, {"fill.density": [0.2, 0.4]}, cache=tmp_path)
    for values in (np.array([0.2, 0.4]), (v for v in (0.2, 0.4)), (0.2, np.float64(0.4))):
        again = gp.sweep(job, {"fill__density": values}, cache=tmp_path)
        assert [row["fill.density"] for row in again] == [0.2, 0.4] and all(row["cached"] for row in again)
        assert numbers(again) == numbers(plain)


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda job: gp.sweep(gp.box(1, 1, 1), {}), "job is a Mesh"),
        (lambda job: gp.sweep(job, ["fill.density"]), "settings is a list"),
        (lambda job: gp.sweep(job, {"fill.density": [0.2], "fill__density": [0.3]}), "fill.density is there twice"),
        (lambda job: gp.sweep(job, {"fill.density": []}), "a list of at least one value is needed"),
        (lambda job: gp.sweep(job, {}, executor=concurrent.futures.ThreadPoolExecutor), "executor is a type without submit"),
    ],
)
def test_wrong_calls_are_refused_before_any_work(job, call, words):
    with pytest.raises(gp.JobError, match=words):
        call(job)


def test_a_cache_that_cannot_be_written_is_told(job, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(gp.JobError, match="cache .*file cannot be made: file exists"):
        gp.sweep(job, SETTINGS, cache=tmp_path / "file")
    gp.sweep(job, SETTINGS, cache=tmp_path / "cache")
    for entry in (tmp_path / "cache").iterdir():
        entry.unlink()
        entry.mkdir()
    with pytest.raises(gp.JobError, match=r"\.json cannot be written: is a directory"):
        gp.sweep(job, SETTINGS, cache=tmp_path / "cache")
    assert not list((tmp_path / "cache").glob("*.part"))


def test_an_entry_that_says_too_little_is_computed_again(job, tmp_path):
    gp.sweep(job, SETTINGS, cache=tmp_path)
    for entry in tmp_path.iterdir():
        entry.write_text("{}")
    assert not any(row["cached"] for row in gp.sweep(job, SETTINGS, cache=tmp_path))


GRID = np.linspace(-1, 31, 33), np.linspace(-1, 21, 23)
POINTS = np.random.default_rng(1).random((200, 3)) * [30, 20, 1.2]
POINTS[:2] = [0, 0, 0], [30, 20, 1.2]


def pulled(angle):
    """Tension along a direction of the plane."""
    along = np.array([np.cos(angle), np.sin(angle), 0])
    return gp.Stress(POINTS, np.tile(10 * np.outer(along, along), (len(POINTS), 1, 1)))


def wood(angle):
    y, x = np.mgrid[:120, :180]
    return gp.Image(128 + 100 * np.sin((x * np.sin(angle) + y * np.cos(angle)) / 3))


def wedge(depth):
    """A box whose top is narrower; it is shown by the same words for any depth."""
    box = gp.box(30, 20, 1.2)
    corners = box.vertices.copy()
    corners[corners[:, 2] > 0, 0] = np.clip(corners[corners[:, 2] > 0, 0], depth, 30 - depth)
    return gp.Mesh(corners, box.faces)


#: Arrays that differ in what they hold and not in what they are shown as.
ALIKE = {
    "field": lambda k: gp.Field(GRID, np.full((33, 23), 0.1 + 0.5 * k)),
    "stress": lambda k: pulled(0.2 + 0.5 * k),
    "grain": lambda k: wood(0.2 + 0.7 * k),
    "shape": lambda k: wedge(1 + 3 * k),
}


@pytest.mark.parametrize("what", ALIKE)
def test_each_array_of_a_point_has_its_own_entry(plate, tmp_path, what):
    make = ALIKE[what]
    guide = {} if what == "shape" else {"fill__pattern": "stripes", "fill__density": 0.4, "guide__kind": "angle"}
    job = gp.Job(plate, **guide, **QUICK)
    first = gp.sweep(job, {what: [make(0), make(1)]}, cache=tmp_path)
    assert [row["cached"] for row in first] == [False, False] and not first.failed
    assert first[0]["printed_mm"] != first[1]["printed_mm"]
    again = gp.sweep(job, {what: [make(1), make(2), make(0)]}, cache=tmp_path)
    assert [row["cached"] for row in again] == [True, False, True]
    assert [row["printed_mm"] for row in again[::2]] == [first[1]["printed_mm"], first[0]["printed_mm"]]
    assert again[1]["printed_mm"] == job.with_(**{what: make(2)}).plan().report["printed_mm"]


def test_long_arrays_in_settings_have_their_own_entries(plate, tmp_path):
    """numpy shows the ends of a long array only."""
    def loads(k):
        facets = np.zeros(3000, int)
        facets[1500] = k
        return [{"on": {"facets": facets}, "force_n": [1, 0, 0]}]

    job = gp.Job(plate, **QUICK)
    gp.sweep(job, {"guide.load": [loads(0)]}, cache=tmp_path)
    (row,) = gp.sweep(job, {"guide.load": [loads(1)]}, cache=tmp_path)
    assert not row["cached"]


def test_rows_of_an_array_are_lists(job):
    (row,) = gp.sweep(job, {"printer.bed_mm": np.array([[210.0, 220.0, 200.0]])})
    assert row["printer.bed_mm"] == [210.0, 220.0, 200.0] and row["error"] is None


def test_names_of_settings_are_texts(job):
    with pytest.raises(gp.JobError, match="settings has the name 3"):
        gp.sweep(job, {3: [1]})


def test_a_table_of_pandas_says_what_it_needs(job, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(gp.JobError, match="pip install pandas"):
        sweeps.Sweep([]).to_pandas()
