"""Sweeps: tables that survive failures, interruptions and executors."""

import concurrent.futures
import os

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
