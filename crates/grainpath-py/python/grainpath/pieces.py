"""Supports, specimens, examples, marker sheets, and what files are."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any

from . import _grainpath
from ._checks import name_of, nearest, whole
from .errors import JobError
from .job import Job
from .mesh import Mesh
from .volume import SAMPLES


def support(part: Mesh, **settings: Any) -> tuple[Mesh | None, dict[str, Any]]:
    """Supports of a part by themselves: their surface, ``None`` where nothing hangs over, and the report.

    Settings are those of jobs, as ``support__critical_angle_deg=50``. Part and supports have the coordinates of the
    sliced part, which stands on the plate.

    >>> import grainpath as gp
    >>> gp.support(gp.box(10, 10, 5))[0] is None
    True
    """
    job = Job(part, **settings)
    if job["support.style"] == "none":
        job = job.with_(support__style="tree")
    data, report = _grainpath.support(job._spec, part._data)
    return (None if data is None else Mesh._of(data)), json.loads(report)


def inspect(
    path: str | os.PathLike[str], *, size: Sequence[int] | None = None, sample: str = "uint8"
) -> dict[str, Any]:
    """What a file is, with its defects: a mesh, a drawing, an image, a scan, a result of finite elements, directions, a
    program. ``size`` (columns, rows, slices) and ``sample`` are for raw voxels.
    """
    if sample not in SAMPLES and sample not in SAMPLES.values():
        raise JobError(f"sample = {sample!r} should be one of {', '.join(SAMPLES)}")
    wanted = None if size is None else [whole(n, f"size[{k}]") for k, n in enumerate(size)]
    if wanted is not None and (len(wanted) != 3 or min(wanted) < 1):
        raise JobError(f"size = {size!r} should be columns, rows and slices")
    found: dict[str, Any] = json.loads(_grainpath.inspect(name_of(path), wanted, SAMPLES.get(sample, sample)))
    return found


def specimens() -> dict[str, str]:
    """The pieces to print and read, and what each is for.

    >>> import grainpath as gp
    >>> "iso527-1a" in gp.specimens()
    True
    """
    return {name: about for name, about, _ in _grainpath.pieces()}


def specimen(name: str) -> tuple[Mesh, Job | None]:
    """A piece to print and read, and for test pieces the job that tests it.

    >>> import grainpath as gp
    >>> gp.specimen("critical-angle")[1] is None
    True
    """
    found = _grainpath.specimen(name)
    if found is None:
        raise JobError(f"no specimen {name!r}{_nearest(name, specimens())}")
    mesh = Mesh._of(found[0])
    return mesh, None if found[1] is None else Job(mesh, text=found[1], name=f"{name}.toml")


def new(
    preset: str,
    folder: str | os.PathLike[str] | None = None,
    *,
    pixels: int | None = None,
    force: bool = False,
) -> list[str]:
    """Writes a commented example job and its input, and gives their paths, the job first."""
    if pixels is not None and (preset != "ct" or not 64 <= pixels <= 1024):
        raise JobError(f"pixels = {pixels!r} should be from 64 to 1024, and is for the preset ct")
    files, names = _grainpath.example(preset, pixels)
    if files is None:
        raise JobError(f"no preset {preset!r}{_nearest(preset, names)}")
    folder = preset if folder is None else os.fspath(folder)
    paths = [os.path.join(folder, name) for name, _ in files]
    for path in paths:
        # All names are looked at before the first is written.
        if os.path.exists(path) and not force:
            raise JobError(f"{path} is there already; force=True writes over it", path)
    for path, (_, content) in zip(paths, files, strict=True):
        try:
            os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
            with open(path, "wb") as file:
                file.write(bytes(content))
        except OSError as error:
            raise JobError(f"{path} cannot be written: {(error.strerror or str(error)).lower()}", path) from error
    return paths


def markers(width_mm: float, height_mm: float, *, pdf: bool = False) -> bytes:
    """A sheet of corner markers to photograph a board on, as SVG or PDF.

    >>> import grainpath as gp
    >>> gp.markers(100, 50)[:4]
    b'<svg'
    """
    try:
        fits = 20 <= min(width_mm, height_mm) and max(width_mm, height_mm) <= 2000
    except (TypeError, ValueError):
        # What is no number has no size either.
        fits = False
    if not fits:
        raise JobError(
            f"{width_mm} x {height_mm} mm: the rectangle between the markers should be 20 to 2000 mm wide and high"
        )
    return bytes(_grainpath.marker_sheet(float(width_mm), float(height_mm), pdf))


def _nearest(word: str, words: Any) -> str:
    return f"{nearest(word, words) or '.'} There are {', '.join(words)}"
