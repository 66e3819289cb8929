"""A folder of jobs on many machines: ``python -m grainpath.cluster JOBS/ --scheduler tcp://host:8786``.

Each job is run on a worker by ``grainpath run``, in a process of its own with one thread, so that a job that fails or
runs out of memory ends neither the worker nor the others. The folder must be at the same path on all workers. Jobs are
handed out a few at a time; a job whose worker is lost is run again by another, and its outputs are written under their
names only when they are whole. Dask is the engine: SLURM, Kubernetes and SSH are its business.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from . import _grainpath
from ._checks import name_of, number, whole
from .errors import GrainpathError, InputError, JobError
from .sweeps import GONE, LOOK_S, Row, Sweep, as_same, connected, in_order_of_end

#: What the table at the end says of a job: the name in the report of ``grainpath run --json``.
COLUMNS = ("mass_g", "time_s", "printed_mm")
#: Jobs that a worker has at hand: the next is there when one ends, and the scheduler keeps few.
PER_WORKER = 2
#: Memory that a worker keeps between two slices of a scan, bytes, as glibc reads it. Dask gives every freed block back to the
#: system, and a slice is as large as one; cutting a scan then takes 1.7 times the processor time (measured, slices of 16 MB).
MEMORY = {"MALLOC_TRIM_THRESHOLD_": str(256 << 20), "MALLOC_MMAP_THRESHOLD_": str(64 << 20)}
#: Seconds between two questions of how many workers there are: workers come by the minute, and each answer is a message.
LIMIT_S = 2.0
#: Seconds until a scheduler that does not answer is given up.
PATIENCE_S = 10.0
#: Seconds until a scheduler without workers is given up, where nothing else is asked for: processes on the same machine
#: are there in a few; whoever stands in the queue of a cluster says how long to wait.
WAIT_S = 60.0


def jobs_of(folder: str | os.PathLike[str]) -> list[str]:
    """The job files of a folder, in the order of their names; a job file is itself."""
    path = name_of(folder, "folder")
    if os.path.isfile(path):
        return [os.path.abspath(path)]
    try:
        names = sorted(name for name in os.listdir(path) if name.lower().endswith(".toml"))
    except OSError as error:
        raise InputError(f"{path}: {(error.strerror or str(error)).lower()}", path) from error
    if not names:
        raise InputError(f"{path}: there is no job (.toml) in the folder", path)
    return [os.path.abspath(os.path.join(path, name)) for name in names]


def run_job(job: str, options: Sequence[str]) -> Row:
    """Runs a job file in a process of its own, and says what came of it. Workers call this."""
    start = time.perf_counter()
    command = [sys.executable, "-P", "-m", "grainpath", "run", job, "--json", *options]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    row: Row = {"job": os.path.basename(job), **dict.fromkeys(COLUMNS), "warnings": [], "error": None}
    row["code"] = ran.returncode
    try:
        said = json.loads(ran.stdout.splitlines()[-1])
    except (ValueError, IndexError):
        said = {"ok": False, "error": (ran.stderr.strip().splitlines() or ["no answer"])[-1]}
    if ran.returncode == 0 and said.get("ok", True):
        row.update({name: said.get(name) for name in COLUMNS})
        row["warnings"] = sorted({warning["id"] for warning in said.get("warnings", [])})
    elif ran.returncode < 0:
        row["error"] = f"ended by signal {-ran.returncode}"
    else:
        row["error"] = said.get("error", "failed")
    row["seconds"] = time.perf_counter() - start
    return row


def keeping_memory() -> Any:
    """Workers that are started here meanwhile get :data:`MEMORY`. It has to be there before their process is: the C library
    reads it once, and ``env=`` of a worker comes later."""
    dask: Any = importlib.import_module("dask")
    key = "distributed.nanny.pre-spawn-environ"
    return dask.config.set({key: {**dask.config.get(key, {}), **MEMORY}})


def connect(scheduler: str, workers: int | None = None, wait_s: float = WAIT_S) -> Any:
    """A Dask client of a scheduler; ``local`` starts workers on this machine. Workers of another version are refused. The
    first worker has ``wait_s`` seconds to come."""
    if workers is not None and whole(workers, "workers") < 1:
        raise JobError(f"workers = {workers} should be 1 or more")
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise JobError(f"a scheduler needs Dask ({error.name} is missing): pip install \"grainpath[dask]\"") from error
    if scheduler == "local":
        n = workers or os.cpu_count() or 1
        # One thread a worker: jobs are processes, and memory is that of one job.
        with keeping_memory():
            cluster = distributed.LocalCluster(
                n_workers=n, threads_per_worker=1, processes=True, dashboard_address=":0", memory_limit=0
            )
        client = distributed.Client(cluster)
        client._grainpath_cluster = cluster
    else:
        try:
            client = distributed.Client(scheduler, timeout=PATIENCE_S)
        except (OSError, ValueError) as error:
            raise InputError(f"{scheduler}: no scheduler answers ({error})") from error
    with closing(client):
        wait_for_workers(client, wait_s)
        same_version(client)
    return client


def close(client: Any) -> None:
    """Ends a client, and the workers that :func:`connect` started for it."""
    cluster = getattr(client, "_grainpath_cluster", None)
    client.close()
    if cluster is not None:
        cluster.close()


@contextlib.contextmanager
def closing(client: Any, always: bool = False) -> Iterator[None]:
    """Ends a client where an exception is raised, or always. After Ctrl-C its workers end in a thread of their own, for
    which the interpreter waits before it ends: they take seconds, and who pressed the keys has the prompt at once."""
    try:
        yield
    except KeyboardInterrupt:
        threading.Thread(target=close, args=(client,), name="grainpath-close").start()
        raise
    except BaseException:
        close(client)
        raise
    if always:
        close(client)


def check_client(client: Any) -> None:
    """Refuses what is no client, such as the address of a scheduler."""
    if not callable(getattr(client, "nthreads", None)) or getattr(client, "asynchronous", False):
        raise JobError(
            f'client is a {type(client).__name__} that cannot be asked here; a dask.distributed.Client("tcp://host:8786") is '
            "needed, not an asynchronous one"
        )
    if client.status == "closed":
        raise InputError("the client is closed; make another one")


def _version() -> str:
    try:
        from grainpath import __version__
    except ImportError:
        return "none"
    return __version__


def workers_of(client: Any) -> list[str]:
    """The addresses of all workers. ``scheduler_info`` may miss them: a part of Dask that runs beside it empties its list."""
    return list(client.nthreads())


def wait_for_workers(client: Any, wait_s: float, look: Callable[[], object] | None = None) -> None:
    """Waits for the first worker: a cluster that was told to grow has none yet. ``look`` is called meanwhile."""
    end = time.monotonic() + wait_s
    while not workers_of(client):
        if time.monotonic() >= end:
            raise InputError(
                f"the scheduler has no workers after {wait_s:g} s; start some, or wait longer for them with wait_s"
            )
        if look is not None:
            look()
        time.sleep(LOOK_S)


def same_version(client: Any) -> None:
    """Refuses workers of another version, by name: their results would differ without a word. Workers that come later look
    themselves, see :func:`grainpath.sweeps.as_same`."""
    found: dict[str, str] = client.run(_version)
    here = _grainpath.__version__
    others = sorted(f"{worker} has {version}" for worker, version in found.items() if version != here)
    if others:
        raise InputError(f"here is grainpath {here}, but {', '.join(others)}; install the same version everywhere")


class Limit:
    """How many tasks may be under way: some for each worker, of which more may come or some may be lost."""

    def __init__(self, client: Any) -> None:
        self._client, self._asked, self._workers = client, -LIMIT_S, 1

    def __call__(self) -> int:
        if time.monotonic() - self._asked >= LIMIT_S:
            self._asked = time.monotonic()
            self._workers = len(reachable(workers_of, self._client))
        return PER_WORKER * max(self._workers, 1)


def reachable(call: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
    """A call of the scheduler, whose silence is told as what it is."""
    try:
        return call(*arguments, **options)
    except Exception as error:
        if not isinstance(error, (OSError, TimeoutError)) and type(error).__name__ not in GONE:
            raise
        raise InputError(f"the scheduler does not answer ({error or type(error).__name__})") from error


def run_folder(
    folder: str | os.PathLike[str],
    *,
    scheduler: str = "local",
    client: Any = None,
    workers: int | None = None,
    out: str | os.PathLike[str] | None = None,
    sets: Sequence[str] = (),
    threads: int = 1,
    note: Callable[[Row], object] | None = None,
    wait_s: float = WAIT_S,
) -> Sweep:
    """Runs all jobs of a folder, as ``grainpath run`` runs each, and gives a table with a row for each.

    ``scheduler`` is the address of a Dask scheduler, or ``local`` for ``workers`` processes here; ``client`` is one that
    is there already. ``out`` is the folder for outputs, in which each job gets a folder of its name; without it outputs
    lie beside the jobs. ``sets`` are settings as ``section.key=value``. ``note`` is called with each row as it ends. The
    first worker has ``wait_s`` seconds to come, and more may come while jobs run.

    A job that fails is a row. Where the scheduler is lost :class:`InputError` says how many jobs were done; their outputs
    are there.
    """
    jobs = jobs_of(folder)
    wait_s = number(wait_s, "wait_s")
    own = client is None
    if not own:
        check_client(client)
    client = connect(scheduler, workers, wait_s) if own else client
    with closing(client, always=True) if own else contextlib.nullcontext():
        if not own:
            reachable(wait_for_workers, client, wait_s)
            reachable(same_version, client)
        waiting = []
        for job in jobs:
            options = ["--threads", str(threads)]
            for setting in sets:
                options += ["--set", setting]
            if out is not None:
                stem = os.path.splitext(os.path.basename(job))[0]
                options += ["--out", os.path.abspath(os.path.join(os.fspath(out), stem))]
            waiting.append((job, options))
        limit = Limit(client)
        rows: list[Row | None] = [None] * len(jobs)

        def submit(k: int) -> Any:
            # Jobs read and write files, so a call with the same arguments is not the same result.
            return client.submit(as_same, _grainpath.__version__, run_job, *waiting[k], pure=False, retries=2)

        def look() -> int:
            try:
                connected(client)
                return limit()
            except InputError as error:
                done = sum(row is not None for row in rows)
                raise InputError(f"{error}; {done} of {len(jobs)} jobs were done before") from error.__cause__

        for k, outcome in in_order_of_end(range(len(jobs)), submit, limit(), look):
            if isinstance(outcome, Exception):
                failed = dict.fromkeys(COLUMNS) | {"warnings": [], "code": 1, "seconds": 0.0}
                row = {"job": os.path.basename(jobs[k]), **failed, "error": f"{type(outcome).__name__}: {outcome}"}
            else:
                row = outcome
            rows[k] = row
            if note is not None:
                note(row)
        return Sweep([row for row in rows if row is not None])


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line. Returns 0, the exit code of the first job that failed, or 2 for wrong usage."""
    parser = argparse.ArgumentParser(
        prog="python -m grainpath.cluster", description="Run all jobs of a folder on the workers of a Dask scheduler."
    )
    parser.add_argument("jobs", help="folder of job files, at the same path on all workers; or one job file")
    parser.add_argument("--scheduler", default="local", help="address of the scheduler; local: workers here")
    parser.add_argument("--workers", type=int, help="number of workers for --scheduler local [default: all cores]")
    parser.add_argument("--out", help="folder for outputs; each job gets a folder of its name")
    parser.add_argument("--set", action="append", default=[], metavar="SECTION.KEY=VALUE", help="override a setting")
    parser.add_argument("--threads", type=int, default=1, help="threads of each job")
    parser.add_argument("--wait", type=float, default=WAIT_S, help="seconds for the first worker to come [default: 60]")
    parser.add_argument("--json", action="store_true", help="print the table as one JSON object")
    args = parser.parse_args(arguments)
    done: list[Row] = []
    begin = time.perf_counter()

    def note(row: Row) -> None:
        done.append(row)
        failed = sum(one["error"] is not None for one in done)
        line = f"{len(done)} of {total} jobs, {failed} failed, {time.perf_counter() - begin:.0f} s"
        end = "\r" if sys.stderr.isatty() else "\n"
        print(line, end=end, file=sys.stderr, flush=True)

    try:
        total = len(jobs_of(args.jobs))
        table = run_folder(
            args.jobs,
            scheduler=args.scheduler,
            workers=args.workers,
            out=args.out,
            sets=args.set,
            threads=args.threads,
            note=note,
            wait_s=args.wait,
        )
    except GrainpathError as error:
        print(f"grainpath: {error}", file=sys.stderr)
        if args.json:
            print(json.dumps({"ok": False, "error": str(error)}))
        return 2 if isinstance(error, JobError) else 3
    except KeyboardInterrupt:
        return 130
    if sys.stderr.isatty():
        print(file=sys.stderr)
    if args.json:
        print(json.dumps({"ok": not table.failed, "jobs": list(table)}))
    else:
        print(text_of(table))
    failed = [int(row["code"]) for row in table.failed]
    # Signals and lost workers have no code of the command line; 1 would mean that the package is missing.
    return 0 if not failed else failed[0] if failed[0] in (2, 3, 4, 130) else 3


def text_of(table: Sweep) -> str:
    """The table for people: a line a job, and what failed."""
    lines = [f"{'job':<32} {'g':>8} {'min':>8} {'s':>7}  warnings or error"]
    for row in table:
        mass = "" if row["mass_g"] is None else f"{row['mass_g']:.2f}"
        minutes = "" if row["time_s"] is None else f"{row['time_s'] / 60:.1f}"
        said = row["error"] or ", ".join(row["warnings"])
        lines.append(f"{row['job']:<32} {mass:>8} {minutes:>8} {row['seconds']:>7.1f}  {said}")
    return "\n".join(lines)


if __name__ == "__main__":
    # Workers import what they run by its name, which in this module as a program would be `__main__`.
    from grainpath.cluster import main as imported

    sys.exit(imported())
