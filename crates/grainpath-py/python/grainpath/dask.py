"""Scans that are larger than the memory, planned on the workers of a Dask cluster.

The scan is cut in slabs of slices, whose layers are made on the workers: contours travel, voxels never. Walls and infill
are laid for windows of layers there too; the order of the paths and the program are made here, since each layer begins
where the one below ended. What workers do are functions of their arguments alone, so that a lost one is done again by
another with the same result. A few are handed over at a time, which bounds the memory of the scheduler.
"""

from __future__ import annotations

import contextlib
import os
import warnings
from collections.abc import Callable
from typing import Any

from . import _grainpath
from ._checks import number, watch, whole
from .cluster import WAIT_S, Limit, check_client, closing, connect, reachable, same_version, wait_for_workers
from .errors import Cancelled, InputError, JobError
from .job import Cancel, Job, Progress
from .layers import LayerStack
from .omezarr import ZarrPlanes, read_zarr
from .plan import Plan
from .sweeps import GONE, as_same, connected, in_order_of_end
from .volume import Volume

#: Slabs that a scan is cut in, where nothing else is asked for: a worker that is lost then costs little.
SLABS = 64
#: Layers that are filled at a time, where nothing else is asked for. Each window makes the masks of its neighbours anew.
WINDOW = 32
#: Grey values and the height of the part's begin, as the module has them.
Found = tuple[float, float, float, float, float | None]


def plan_zarr(
    path: str | os.PathLike[str],
    job: Job,
    *,
    client: Any = None,
    workers: int | None = None,
    level: int = 0,
    channel: int = 0,
    time: int = 0,
    spacing: Any = None,
    slab_planes: int | None = None,
    window_layers: int | None = None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    wait_s: float = WAIT_S,
) -> Plan:
    """Plans a job whose part is a scan in Zarr, on the workers of a Dask cluster.

    The program is byte for byte that of ``job.with_(gp.read_zarr(path)).plan()``, for any number of workers, any chunks
    and slabs. ``path`` has to be the same on all workers, and they need the same version of grainpath. ``client`` is a
    client of Dask; without one ``workers`` processes of one thread are started here. ``slab_planes`` slices are cut at a
    time: whole rows of chunks, unless said otherwise. ``window_layers`` layers are filled at a time; jobs with a stress, a
    field, supports, regions, fibre, a mass, the pattern ``continuous`` or sparse lines along a direction, which go on from
    layer to layer, are filled here instead. The first worker has ``wait_s`` seconds to come, and more may come while the
    plan is made. Other arguments are those of :func:`grainpath.read_zarr` and :meth:`grainpath.Job.plan`.
    """
    if not isinstance(job, Job):
        raise JobError(f"job is a {type(job).__name__}; a grainpath.Job is needed")
    watch(progress, cancel)
    if client is not None:
        check_client(client)
    wait_s = number(wait_s, "wait_s")
    for name, value in (("slab_planes", slab_planes), ("window_layers", window_layers)):
        if value is not None and whole(value, name) < 1:
            raise JobError(f"{name} = {value} should be 1 or more")
    # Opened here before any worker is asked, so that what is wrong with the store is told at once.
    volume = read_zarr(path, level=level, channel=channel, time=time, spacing=spacing)
    scanned = job.with_(volume)
    if any(scanned["shape.rotate_deg"]):
        raise JobError("shape.rotate_deg: a scan that is turned is not cut in slabs; plan it with gp.read_zarr(path)")
    if scanned["guide.kind"] == "grain" and not scanned.settings.get("guide.image.files"):
        raise JobError(
            "guide.kind = grain: the texture of a scan is not found in slabs; plan it with gp.read_zarr(path), or name photographs"
        )
    own = client is None
    client = connect("local", workers, wait_s) if own else client

    def look() -> None:
        if cancel is not None and cancel.is_set():
            raise Cancelled("cancelled; nothing was written")

    with closing(client, always=True) if own else contextlib.nullcontext():
        if not own:
            _reachable(wait_for_workers, client, wait_s, look)
            _reachable(same_version, client)
        return _Run(client, scanned, volume, progress, cancel).plan(slab_planes, window_layers)


class _Run:
    """One plan on a cluster."""

    def __init__(
        self, client: Any, job: Job, volume: Volume, progress: Progress | None, cancel: Cancel | None
    ) -> None:
        self._client, self._job, self._volume = client, job, volume
        self._progress, self._cancel = progress, cancel
        self._limit = Limit(client)

    def plan(self, slab_planes: int | None, window_layers: int | None) -> Plan:
        job = self._job
        (found, (first, end)) = self._all("read", 1, lambda _: self._submit(survey, job))[0]
        n = end - first
        size = slab_planes or slab_of(self._volume, n)
        # Borders of slabs are borders of chunks, wherever the window of the job begins.
        borders = [0, *range(size - first % size, n, size), n]
        slabs = list(zip(borders[:-1], borders[1:], strict=True))
        parts = self._all("slice", len(slabs), lambda k: self._submit(cut, job, found, slabs[k], first))
        spec, handover = job._given()
        array, missing = handover[1][:3], handover[1][4]
        scan = _grainpath.scan_join(spec, array, found, parts, (None, None, self._cancel), missing)
        filled = None
        if _grainpath.fills_in_windows(spec):
            stack = LayerStack._of(scan.stack())
            step = window_layers or WINDOW
            windows = [(k, min(k + step, len(stack))) for k in range(0, len(stack), step)]
            # The settings travel without the scan, and the sections once to each worker. They are the result of a task:
            # where the worker that has them is lost, the scheduler lets another make them again. Data that were scattered
            # would be lost with it.
            settings = job._without_shape()
            with warnings.catch_warnings():
                # Dask warns of large arguments, since most are better read by the worker; sections are nowhere but here.
                warnings.filterwarnings("ignore", "Sending large graph", UserWarning)
                sections = _reachable(self._submit, same, stack.to_bytes())
            filled = self._all("fill", len(windows), lambda k: self._submit(fill, settings, sections, windows[k]))
        data = _grainpath.plan_parted(spec, scan, filled, handover, (None, self._progress, self._cancel))
        return Plan._of(job, data)

    def _submit(self, call: Callable[..., Any], *arguments: Any) -> Any:
        # Not tried again where it fails: the same task fails in the same way. Where its worker was lost, Dask itself gives it
        # to another, as often as its distributed.scheduler.allowed-failures says.
        return self._client.submit(as_same, _grainpath.__version__, call, *arguments, pure=False)

    def _all(self, stage: str, n: int, submit: Callable[[int], Any]) -> list[Any]:
        """The results of a stage, in the order of their numbers."""
        results: list[Any] = [None] * n
        done = 0
        for k, outcome in in_order_of_end(range(n), submit, _reachable(self._limit), self._look):
            if isinstance(outcome, Exception):
                raise _told(outcome) from outcome.__cause__
            results[k] = outcome
            done += 1
            if self._progress is not None:
                self._progress(stage, done, n)
            self._look()
        return results

    def _look(self) -> int:
        """Ends the plan where it was cancelled, or no results can come any more; else how many tasks may be under way."""
        if self._cancel is not None and self._cancel.is_set():
            raise Cancelled("cancelled; nothing was written")
        _reachable(connected, self._client)
        limit: int = _reachable(self._limit)
        return limit


def slab_of(volume: Volume, n_planes: int) -> int:
    """Planes of a slab: whole rows of chunks, of which each is read once but for the plane below a slab."""
    depth = volume.array.depth if isinstance(volume.array, ZarrPlanes) else 1
    least = max(-(-n_planes // SLABS), 16)
    return int(depth * -(-least // depth))


def survey(job: Job) -> tuple[Found, tuple[int, int]]:
    """What has to be known of the whole scan before a slab is cut. Workers call this."""
    found, taken = _grainpath.scan_survey(job._spec, _array(job), (1, None, None))
    return found, (taken[0], taken[1])


def cut(job: Job, found: Found, planes: tuple[int, int], first: int) -> bytes:
    """The layers of a slab. Workers call this."""
    return _grainpath.scan_part(job._spec, _array(job), found, (*planes, first), (1, None, None))


def same(sections: bytes) -> bytes:
    """What it is given, as the result of a task. Workers call this."""
    return sections


def fill(job: Job, sections: bytes, window: tuple[int, int]) -> bytes:
    """The walls and the infill of a window of layers. Workers call this."""
    stack = LayerStack.from_bytes(sections)
    return _grainpath.fill_window(job._spec, stack._data, window, (1, None, None))


def _array(job: Job) -> Any:
    shape = job.shape
    assert isinstance(shape, Volume)
    return shape._given()


def _reachable(call: Callable[..., Any], *arguments: Any) -> Any:
    """A call of the scheduler, whose silence is told as what it is."""
    try:
        return reachable(call, *arguments)
    except InputError as error:
        raise InputError(f"{error}; nothing was written") from error.__cause__


def _told(error: Exception) -> Exception:
    """An exception of a task: that of the work as it was raised, or that its worker or the scheduler is gone."""
    name = type(error).__name__
    if name in ("KilledWorker", "NoValidWorkerError"):
        return InputError(f"a slab was lost with each of its workers, one after the other ({error}); nothing was written")
    if name in GONE:
        return InputError(f"the scheduler is gone ({name}); nothing was written")
    return error
