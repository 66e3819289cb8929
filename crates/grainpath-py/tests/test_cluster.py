"""Folders of jobs and sweeps on Dask: the same bytes, failures as rows, workers of another version refused."""

import json
import os
import re
import subprocess
import sys
import threading

import pytest

import grainpath as gp
from conftest import QUICK
from grainpath import cluster, sweeps
from test_plan import command_line

# What Dask itself warns of is no error of ours.
pytestmark = pytest.mark.filterwarnings("default")

JOB = """\
[shape]
mesh = "plate.stl"
[process]
layer_height_mm = 0.3
first_layer_height_mm = 0.3
top_layers = 0
bottom_layers = 0
[fill]
density = {density}
"""


@pytest.fixture(scope="module")
def client():
    pytest.importorskip("distributed")
    client = cluster.connect("local", 2)
    yield client
    cluster.close(client)


@pytest.fixture
def folder(stl):
    for k, density in enumerate((0.2, 0.4, -7)):
        (stl.parent / f"job{k}.toml").write_text(JOB.format(density=density))
    return stl.parent


def test_a_folder_of_jobs_has_the_bytes_of_the_command(folder, client, tmp_path):
    noted = []
    table = cluster.run_folder(folder, client=client, out=tmp_path / "out", note=noted.append)
    assert [row["job"] for row in table] == ["job0.toml", "job1.toml", "job2.toml"]
    assert [row["code"] for row in table] == [0, 0, 2] and "density" in table.failed[0]["error"]
    assert sorted(row["job"] for row in noted) == ["job0.toml", "job1.toml", "job2.toml"]
    for k in (0, 1):
        assert command_line("run", folder / f"job{k}.toml").returncode == 0
        here = (folder / "plate.gcode").read_bytes()
        assert (tmp_path / "out" / f"job{k}" / "plate.gcode").read_bytes() == here
        assert gp.Job.from_toml(folder / f"job{k}.toml").plan().to_gcode() == here
    assert table[0]["mass_g"] < table[1]["mass_g"] and not (tmp_path / "out" / "job2").exists()


@pytest.mark.parametrize("in_flight", [1, 2, 16])
def test_sweeps_on_dask_find_the_same(plate, client, in_flight):
    job = gp.Job(plate, process__top_layers=0, process__bottom_layers=0, **QUICK)
    settings = {"fill.density": [0.2, 0.4, -1], "process.walls": [1, 2]}

    def numbers(table):
        return [{k: v for k, v in row.items() if k not in ("seconds", "cached")} for row in table]

    table = gp.sweep(job, settings, executor=client, in_flight=in_flight)
    assert numbers(table) == numbers(gp.sweep(job, settings)) and len(table.failed) == 2


def program(job, point):
    return job.with_(**point).plan(threads=1).to_gcode()


def test_programs_are_the_same_bytes_on_workers(plate, client):
    job = gp.Job(plate, **QUICK)
    points = [{"fill__pattern": pattern} for pattern in ("grid", "gyroid", "concentric", "stripes")]
    points = [{**point, "guide__kind": "angle"} if point["fill__pattern"] == "stripes" else point for point in points]
    there = client.gather([client.submit(program, job, point) for point in points])
    assert there == [program(job, point) for point in points]


def test_a_job_whose_worker_dies_is_run_again(plate, tmp_path):
    pytest.importorskip("distributed")
    client = cluster.connect("local", 2)
    try:
        mark = tmp_path / "died"
        future = client.submit(die_once, str(mark), gp.Job(plate, **QUICK), retries=2, pure=False)
        assert future.result(timeout=60) == gp.Job(plate, **QUICK).plan().to_gcode()
        assert mark.exists()
    finally:
        cluster.close(client)


def die_once(mark, job):
    if not os.path.exists(mark):
        open(mark, "w").close()
        os._exit(9)
    return job.plan(threads=1).to_gcode()


def test_workers_of_another_version_are_refused_by_name(client, monkeypatch):
    monkeypatch.setattr(cluster._grainpath, "__version__", "9.9.9")
    with pytest.raises(gp.InputError, match=r"here is grainpath 9\.9\.9, but tcp://127\.0\.0\.1:\d+ has "):
        cluster.same_version(client)


def test_a_scheduler_that_is_gone_is_an_error(folder, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.5)
    with pytest.raises(gp.InputError, match="tcp://127.0.0.1:9: no scheduler answers"):
        cluster.run_folder(folder, scheduler="tcp://127.0.0.1:9")


@pytest.fixture
def killable(monkeypatch):
    """A client whose scheduler and worker are processes of their own, and the scheduler's process."""
    distributed = pytest.importorskip("distributed")
    started = []

    def start(*words):
        command = [sys.executable, "-m", *words]
        started.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True))
        return started[-1]

    scheduler = start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    address = None
    while address is None:
        line = scheduler.stderr.readline()
        assert line, "the scheduler ended"
        found = re.search(r"tcp://[\d.]+:\d+", line)
        address = found and found.group()
    worker = start("distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny")
    # Their pipes are read to the end, so that they never wait for a reader.
    for process in (scheduler, worker):
        threading.Thread(target=process.stderr.read, daemon=True).start()
    # The time for which a client tries to come back.
    client = distributed.Client(address, timeout=5)
    yield client, scheduler
    client.close()
    for process in started:
        process.kill()
        process.wait()
        process.stderr.close()


def test_a_folder_ends_where_its_scheduler_is_killed(folder, killable, tmp_path):
    client, scheduler = killable
    with pytest.raises(gp.InputError, match=r"the scheduler (is gone|does not answer).*; [12] of 3 jobs were done"):
        cluster.run_folder(
            folder, client=client, out=tmp_path / "out", note=lambda row: (scheduler.kill(), scheduler.wait())
        )
    assert (tmp_path / "out" / "job0" / "plate.gcode").exists()


@pytest.mark.parametrize("of", [lambda client: client, lambda client: client.get_executor()], ids=["client", "executor"])
def test_a_sweep_ends_where_its_scheduler_is_killed(plate, killable, tmp_path, monkeypatch, of):
    client, scheduler = killable
    write, written = sweeps._write, []

    def kill(path, row):
        write(path, row)
        written.append(path)
        scheduler.kill()
        scheduler.wait()

    monkeypatch.setattr(sweeps, "_write", kill)
    job, settings = gp.Job(plate, **QUICK), {"process.walls": list(range(1, 30))}
    with pytest.raises(gp.InputError, match="the scheduler is gone"):
        gp.sweep(job, settings, executor=of(client), cache=tmp_path, in_flight=2)
    assert written
    monkeypatch.setattr(sweeps, "_write", write)
    again = gp.sweep(job, settings, cache=tmp_path)
    assert sum(row["cached"] for row in again) == len(written) and not again.failed


def test_a_worker_of_another_version_that_comes_later_refuses(folder, plate, client, monkeypatch):
    monkeypatch.setattr(cluster, "same_version", lambda client: None)
    monkeypatch.setattr(cluster._grainpath, "__version__", "9.9.9")
    for table in (
        cluster.run_folder(folder, client=client),
        gp.sweep(gp.Job(plate, **QUICK), {"process.walls": [1, 2]}, executor=client),
    ):
        words = r"here is grainpath 9\.9\.9, but tcp://127\.0\.0\.1:\d+ has "
        assert len(table.failed) == len(table) and all(re.search(words, row["error"]) for row in table)


def test_folders_without_jobs_are_refused(tmp_path):
    with pytest.raises(gp.InputError, match="no job"):
        cluster.jobs_of(tmp_path)
    with pytest.raises(gp.InputError, match="none"):
        cluster.jobs_of(tmp_path / "none")


def test_the_command_line_runs_a_folder(folder, client):
    address = client.scheduler.address
    ran = command_line("run", folder, "--scheduler", address, "--json", "--set", "process.walls=1", "--out", folder / "o")
    found = json.loads(ran.stdout)
    assert ran.returncode == 2 and [row["error"] is None for row in found["jobs"]] == [True, True, False]
    assert "3 of 3 jobs, 1 failed" in ran.stderr.decode()
    (folder / "job2.toml").unlink()
    ran = subprocess.run(
        [sys.executable, "-m", "grainpath.cluster", folder, "--scheduler", address], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.splitlines()[1].startswith("job0.toml") and len(ran.stdout.splitlines()) == 3


def test_without_dask_it_says_how_to_install(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(gp.JobError, match=r'pip install "grainpath\[dask\]"'):
        cluster.run_folder(folder)


def test_a_job_that_is_killed_is_a_row(folder, monkeypatch):
    monkeypatch.setattr(sys, "executable", "/bin/false")
    row = cluster.run_job(str(folder / "job0.toml"), [])
    assert row["error"] == "no answer" and row["code"] == 1


class Ray:
    """The shape of the module ray, on threads."""

    def __init__(self):
        from concurrent.futures import ThreadPoolExecutor

        self.pool = ThreadPoolExecutor(2)

    def put(self, value):
        return value

    def remote(self, fn):
        pool = self.pool

        class Task:
            def remote(self, *args):
                class Reference:
                    def future(self):
                        return pool.submit(fn, *args)

                return Reference()

        return Task()


def test_executors_of_other_shapes(plate):
    job = gp.Job(plate, **QUICK)
    assert not gp.sweep(job, {"process.walls": [1, 2]}, executor=Ray()).failed
    with pytest.raises(gp.JobError, match="a int without submit"):
        gp.sweep(job, {"process.walls": [1]}, executor=7)


def test_what_was_not_begun_is_cancelled():
    from concurrent.futures import Future

    futures = []

    def submit(k):
        futures.append(Future())
        if k == 0:
            futures[0].set_result("first")
        return futures[-1]

    results = sweeps.in_order_of_end(range(100), submit, 4)
    assert next(results) == (0, "first")
    results.close()
    assert len(futures) == 4 and all(future.cancelled() for future in futures[1:])
