"""Many jobs: a table of what settings do.

Work goes to anything with the shape of ``concurrent.futures``: ``submit`` gives a future with ``result`` and
``add_done_callback``. Threads, processes, Dask's client, and SLURM or Kubernetes behind it all have it.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import html
import importlib
import itertools
import json
import os
import platform
import queue
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, overload

import numpy as np

from . import _grainpath
from .errors import InputError, JobError
from .field import Field
from .image import Image
from .job import Job
from .layers import LayerStack
from .mesh import Mesh
from .stress import Stress
from .volume import Volume

#: What a row says of a plan, by path in its report.
COLUMNS: dict[str, tuple[str, ...]] = {
    "mass_g": ("mass_g",),
    "time_s": ("time_s",),
    "printed_mm": ("printed_mm",),
    "travel_mm": ("travel_mm",),
    "alignment_mean_deg": ("quality", "alignment_mean_deg"),
    "gap": ("quality", "gap"),
    "overlap": ("quality", "overlap"),
    "max_von_mises_mpa": ("stress", "max_von_mises_mpa"),
    "peak_load_n": ("strength", "peak_load_n"),
    "low_n": ("strength", "low_n"),
    "high_n": ("strength", "high_n"),
}

#: What Dask raises where the scheduler or the client is gone, by name, since Dask itself is not imported here.
GONE = ("CancelledError", "FutureCancelledError", "FuturesCancelledError", "CommClosedError", "ClosedClientError")

Row = dict[str, Any]


class Sweep(Sequence[Row]):
    """The rows of a sweep, in the order of its settings. A row has its settings, what was measured, ``seconds``,
    ``cached``, and ``error``: ``None``, or why there is no plan."""

    def __init__(self, rows: list[Row]) -> None:
        self.rows = rows

    def __len__(self) -> int:
        return len(self.rows)

    @overload
    def __getitem__(self, k: int) -> Row: ...
    @overload
    def __getitem__(self, k: slice) -> list[Row]: ...
    def __getitem__(self, k: int | slice) -> Row | list[Row]:
        return self.rows[k]

    @property
    def failed(self) -> list[Row]:
        """The rows with an error."""
        return [row for row in self.rows if row["error"] is not None]

    def to_pandas(self) -> Any:
        """The rows as a ``pandas.DataFrame``; pandas has to be installed."""
        try:
            import pandas  # type: ignore[import-not-found,import-untyped,unused-ignore]
        except ImportError as error:
            raise JobError("a table of pandas needs the package pandas: pip install pandas") from error
        return pandas.DataFrame(self.rows)

    def __repr__(self) -> str:
        return f"<grainpath.Sweep: {len(self)} jobs, {len(self.failed)} failed>"

    def _repr_html_(self) -> str:
        names = list(self.rows[0]) if self.rows else []
        head = "".join(f"<th>{html.escape(name)}</th>" for name in names)

        def cell(value: Any) -> str:
            return html.escape("" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value))

        body = "".join("<tr>" + "".join(f"<td>{cell(row[n])}</td>" for n in names) + "</tr>" for row in self.rows)
        return f"<table><tr>{head}</tr>{body}</table>"


def sweep(
    job: Job,
    settings: Mapping[str, Iterable[Any]],
    *,
    executor: Any = None,
    cache: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    in_flight: int = 16,
) -> Sweep:
    """Plans and measures a job with every combination of settings.

    ``settings`` holds a list of values for each name, written ``fill.density`` or ``fill__density``. Without an
    ``executor`` jobs run here, one after the other, each on all cores; with one each job has one thread, unless
    ``threads`` says otherwise. An executor is anything with ``submit`` as ``concurrent.futures`` has it (threads,
    processes, Dask's client, ``joblib.externals.loky.get_reusable_executor()``), or the module ``ray``. At most ``in_flight`` jobs are handed over at a time.

    A job that fails is a row with its ``error``, and the others go on. ``cache`` is a folder: what is in it is not
    computed again, so that a sweep that was interrupted goes on where it was. An entry belongs to a version of
    grainpath, the job, and the contents of its arrays (also those of a point, as ``{"field": [one, other]}``) and of all files that it reads, with those that a header of a scan
    names and those of profiles. Failures are not kept.

    Workers of a Dask client need the same version of grainpath. Where its scheduler is lost the sweep ends with
    :class:`InputError`; rows that were done are in the cache.

    >>> import grainpath as gp
    >>> table = gp.sweep(gp.Job(gp.box(20, 10, 1)), {"fill.density": [0.2, 0.4], "process.walls": [1, 30, 99]})
    >>> table
    <grainpath.Sweep: 6 jobs, 0 failed>
    """
    if in_flight < 1:
        raise JobError(f"in_flight = {in_flight} should be at least 1")
    if not isinstance(job, Job):
        raise JobError(f"job is a {type(job).__name__}; a grainpath.Job is needed")
    if not isinstance(settings, Mapping):
        raise JobError(f"settings is a {type(settings).__name__}; a dict of lists is needed, by the names of settings")
    lists: dict[str, list[Any]] = {}
    for given, values in settings.items():
        if not isinstance(given, str):
            raise JobError(f"settings has the name {given!r}; names of settings are needed, as fill.density")
        name = given.replace("__", ".")
        if name in lists:
            raise JobError(f"{name} is there twice: {given} is the same")
        lists[name] = _values(given, values)
    points = [dict(zip(lists, point, strict=True)) for point in itertools.product(*lists.values())]
    folder = None if cache is None else os.fspath(cache)
    if folder is not None:
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError as error:
            raise JobError(f"cache {folder} cannot be made: {(error.strerror or str(error)).lower()}", folder) from error
    rows: list[Row | None] = [None] * len(points)
    contents = None if folder is None else _Contents()
    waiting: list[tuple[int, str | None]] = []
    for k, point in enumerate(points):
        key = None if contents is None else _key(job, contents, point)
        entry = None if key is None else os.path.join(folder or "", key + ".json")
        found = None if entry is None else _read(entry)
        if found is None:
            waiting.append((k, entry))
        else:
            rows[k] = {**point, **found, "cached": True, "error": None}
    for k, entry, measured in _measured(job, points, waiting, executor, threads, in_flight):
        rows[k] = {**points[k], **measured, "cached": False}
        if entry is not None and measured["error"] is None:
            _write(entry, {name: value for name, value in measured.items() if name != "error"})
    return Sweep([row for row in rows if row is not None])


def _values(name: str, values: Any) -> list[Any]:
    """The values of a setting. Numbers of numpy and pandas become Python's, which are what rows and entries hold."""
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        raise JobError(f"{name} = {values!r}; a list of at least one value is needed")
    found = [value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value for value in values]
    if not found:
        raise JobError(f"{name} = {values!r}; a list of at least one value is needed")
    return found


def _measured(
    job: Job,
    points: list[dict[str, Any]],
    waiting: list[tuple[int, str | None]],
    executor: Any,
    threads: int | None,
    in_flight: int,
) -> Iterator[tuple[int, str | None, Row]]:
    """Measures the jobs that wait, in the order in which they end."""
    if executor is None:
        for k, entry in waiting:
            yield k, entry, measure(job, points[k], threads)
        return
    hand_over = _submit_of(executor)
    of_job = 1 if threads is None else threads

    def submit(i: int) -> Any:
        return hand_over(as_same, _grainpath.__version__, measure, job, points[waiting[i][0]], of_job)

    # `get_executor()` of a client has it inside.
    client = getattr(executor, "_client", executor)
    look = functools.partial(connected, client) if hasattr(client, "scheduler_info") else None
    for i, outcome in in_order_of_end(range(len(waiting)), submit, in_flight, look):
        k, entry = waiting[i]
        # The worker itself was lost: its process ended, or its host.
        yield k, entry, _failed(outcome, 0.0) if isinstance(outcome, Exception) else outcome


def _submit_of(executor: Any) -> Callable[..., Any]:
    """The function of an executor that begins a call and gives its future."""
    if callable(getattr(executor, "submit", None)) and not isinstance(executor, type):
        submit: Callable[..., Any] = executor.submit
        return submit
    if callable(getattr(executor, "remote", None)) and callable(getattr(executor, "put", None)):
        # The module `ray`: its tasks give references, which have futures of the usual shape.
        remote = executor.remote(_call)
        return lambda fn, *args: remote.remote(fn, *args).future()
    raise JobError(
        f"executor is a {type(executor).__name__} without submit; a concurrent.futures executor, a Dask client, the module "
        "ray, or joblib.externals.loky.get_reusable_executor() is needed"
    )


def _call(fn: Callable[..., Any], *args: Any) -> Any:
    return fn(*args)


def as_same(version: str, call: Callable[..., Any], *arguments: Any) -> Any:
    """Calls where the caller's version of grainpath is installed, and refuses elsewhere, by name: a worker may come after
    the others were asked, and its results would differ without a word. Workers call this."""
    if version != _grainpath.__version__:
        others = f"{_worker()} has {_grainpath.__version__}"
        raise InputError(f"here is grainpath {version}, but {others}; install the same version everywhere")
    return call(*arguments)


def _worker() -> str:
    """The name of this worker: its address in Dask, or that of its host."""
    try:
        address: str = importlib.import_module("distributed").get_worker().address
    except (ImportError, ValueError):
        return platform.node()
    return address


def connected(client: Any) -> None:
    """Ends the waiting for a client of Dask that has lost its scheduler. It cancels what it had handed over, and what is
    handed over while it tries to come back never ends."""
    if client.status != "running":
        raise InputError(f"the scheduler is gone (the client is {client.status})")


#: Seconds between two looks at whether to go on.
LOOK_S = 0.1


def in_order_of_end(
    numbers: Iterable[int],
    submit: Callable[[int], Any],
    in_flight: int,
    look: Callable[[], int | None] | None = None,
) -> Iterator[tuple[int, Any]]:
    """Hands over calls, at most ``in_flight`` at a time, and gives each number with its result, or the exception that
    was raised, as they end. What was not begun is cancelled when the caller leaves. ``look`` is called while nothing ends
    and where a call failed; what it raises ends the waiting, and a number is how many may be under way from then on."""
    done: queue.SimpleQueue[Any] = queue.SimpleQueue()
    running: dict[Any, int] = {}
    left = iter(numbers)
    try:
        while True:
            for k in itertools.islice(left, max(in_flight - len(running), 0)):
                try:
                    future = submit(k)
                except Exception as error:
                    if look is not None:
                        in_flight = look() or in_flight
                    # A pool whose processes have ended takes nothing more.
                    yield k, error
                    continue
                running[future] = k
                future.add_done_callback(done.put)
            if not running:
                return
            try:
                future = done.get(timeout=None if look is None else LOOK_S)
            except queue.Empty:
                assert look is not None
                in_flight = look() or in_flight
                continue
            k = running.pop(future)
            try:
                outcome = future.result()
            except Exception as error:
                # A lost scheduler is told as what it is, and not as what became of this call.
                if look is not None:
                    in_flight = look() or in_flight
                outcome = error
            yield k, outcome
    finally:
        for future in running:
            # Whoever is gone has nothing to cancel, and must not hide why the caller leaves.
            with contextlib.suppress(Exception):
                future.cancel()


def measure(job: Job, point: Mapping[str, Any], threads: int | None) -> Row:
    """What a row of a sweep says of a job with these settings. It runs wherever the executor runs it."""
    start = time.perf_counter()
    try:
        report = _made(job, point).plan(threads=threads).report
    except Exception as error:
        # An array of the user's may raise anything where it is read.
        return _failed(error, time.perf_counter() - start)
    row: Row = {}
    for name, path in COLUMNS.items():
        value: Any = report
        for step in path:
            value = value.get(step) if isinstance(value, dict) else None
        row[name] = value
    row["warnings"] = sorted({w["id"] for w in report["warnings"]})
    row["seconds"] = time.perf_counter() - start
    row["error"] = None
    return row


def _failed(error: Exception, seconds: float) -> Row:
    row: Row = dict.fromkeys(COLUMNS)
    return {**row, "warnings": [], "seconds": seconds, "error": f"{type(error).__name__}: {error}"}


class _Contents:
    """Hashes of what jobs are apart from their settings: their arrays, and the contents of the files that they read."""

    def __init__(self) -> None:
        #: Arrays that were hashed, by their identity. They are kept, so that no other takes the place of one.
        self._arrays: dict[int, tuple[Any, bytes]] = {}
        self._files: dict[str, bytes] = {}
        self._lists: dict[tuple[tuple[str, str], ...], list[str]] = {}

    def of(self, job: Job) -> str:
        """The hash of a job, each of which may have arrays of its own."""
        digest = hashlib.sha256()
        for array in (job._shape, job._field, job._stress, job._grain):
            # A list of images is hashed by its images: another list may have the same.
            several = array if isinstance(array, (list, tuple)) else [array]
            digest.update(b"".join(map(self._array, several)) + b"%d;" % len(several))
        for path in self._list(job):
            digest.update(os.path.basename(path).encode(errors="surrogateescape"))
            if path not in self._files:
                self._files[path] = _hash_of_file(path)
            digest.update(self._files[path])
        return digest.hexdigest()

    def _array(self, array: Any) -> bytes:
        if id(array) not in self._arrays:
            self._arrays[id(array)] = array, _hash_of_array(array)
        return self._arrays[id(array)][1]

    def _list(self, job: Job) -> list[str]:
        # Headers of scans are opened to find the files that they name. Only text names files, and how a scan is opened
        # stands in [shape], so that a sweep over numbers opens them once.
        rows = tuple(row for row in job._spec.rows() if row[0].startswith("shape.") or not _is_number(row[1]))
        if rows not in self._lists:
            self._lists[rows] = job._spec.files()
        return self._lists[rows]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _hash_of_array(array: Any) -> bytes:
    """The hash of a shape, an image, a field or a stress, by its contents; ``None`` has one too."""
    digest = hashlib.sha256(type(array).__name__.encode())
    if isinstance(array, Volume):
        digest.update(repr((array.shape, array.dtype.str, array.spacing)).encode())
        for k in range(array.shape[0]):
            digest.update(array._slices(k, 1).tobytes())
    elif isinstance(array, LayerStack):
        digest.update(array.to_bytes())
    elif isinstance(array, Mesh):
        words, arrays = array._parts()
        digest.update(repr((words, [one.shape for one in arrays])).encode())
        for one in arrays:
            digest.update(one.tobytes())
    elif isinstance(array, Image):
        digest.update(repr((array.name, array.array.shape, array.array.dtype.str)).encode())
        digest.update(array.array.tobytes())
    elif isinstance(array, Field):
        file, settings = array._file()
        digest.update(file + repr(sorted(settings.items())).encode())
    elif isinstance(array, Stress):
        digest.update(array.points.tobytes() + array.tensors.tobytes())
    return digest.digest()


def _hash_of_file(path: str) -> bytes:
    """The hash of a file, or of the files of a folder. What is missing has one too: it may come."""
    digest = hashlib.sha256()
    for file in _files(path) if os.path.exists(path) else []:
        digest.update(os.path.relpath(file, path).encode(errors="surrogateescape"))
        with open(file, "rb") as stream:
            digest.update(hashlib.file_digest(stream, "sha256").digest())
    return digest.digest()


def _files(path: str) -> list[str]:
    if not os.path.isdir(path):
        return [path]
    names = sorted(os.listdir(path))
    if any(name in names for name in ("zarr.json", ".zarray", ".zgroup", ".zattrs")):
        # The chunks of a scan in Zarr are in folders of their own.
        return sorted(os.path.join(folder, name) for folder, _, files in os.walk(path) for name in files)
    return [os.path.join(path, name) for name in names if os.path.isfile(os.path.join(path, name))]


def _key(job: Job, contents: _Contents, point: Mapping[str, Any]) -> str | None:
    """The name of the entry of a job with these settings; ``None`` where there is no such job, which is told by its row."""
    try:
        made = _made(job, point)
        # The text of the job and the lines of what was set have what the settings do not show: loads, fixtures and regions.
        said = (made._text, sorted(made._lines), sorted(made.settings.items()), sorted(COLUMNS), _grainpath.__version__)
        return hashlib.sha256(repr((contents.of(made), said)).encode()).hexdigest()
    except Exception:
        # An array of the user's may raise anything where it is read; a plan of it does so again.
        return None


def _made(job: Job, point: Mapping[str, Any]) -> Job:
    return job.with_(**{name.replace(".", "__"): value for name, value in point.items()})


def _read(path: str) -> Row | None:
    try:
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) and found.keys() >= {*COLUMNS, "warnings", "seconds"} else None


def _write(path: str, row: Row) -> None:
    # Written beside its place and renamed, so that a sweep that dies leaves no half of an entry.
    try:
        handle, temporary = tempfile.mkstemp(dir=os.path.dirname(path), suffix=".part")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                json.dump(row, file)
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise JobError(f"{path} cannot be written: {(error.strerror or str(error)).lower()}", path) from error
