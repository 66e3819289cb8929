"""Scans in Zarr: arrays, and OME-Zarr 0.4 and 0.5 with their levels and units."""

from __future__ import annotations

import importlib
import itertools
import math
import os
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ._checks import floats, name_of, whole
from .errors import InputError, JobError
from .volume import Volume

#: Millimetres of units of length, as OME-Zarr names them (those of UDUNITS-2), and their short forms.
UNITS_MM = {
    "angstrom": 1e-7,
    "nanometer": 1e-6,
    "micrometer": 1e-3,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "decimeter": 100.0,
    "meter": 1000.0,
    "inch": 25.4,
    "foot": 304.8,
    "nm": 1e-6,
    "um": 1e-3,
    "mm": 1.0,
    "cm": 10.0,
    "m": 1000.0,
}


#: Most bytes of a row of chunks that is kept, so that each of its chunks is unpacked once. A row of 64 planes of 1024 x
#: 2048 voxels of 16 bits has as many.
ROW_BYTES = 256 << 20


class ZarrPlanes:
    """The planes of a Zarr array, read when they are asked for, by whole rows of chunks. Pickled, it is its path."""

    def __init__(self, path: str, inner: str, before: tuple[int, ...]) -> None:
        self._of = (path, inner, before)
        array = self._opened()
        self._array = array
        self.shape: tuple[int, ...] = tuple(int(n) for n in array.shape[len(before) :])
        self.dtype: np.dtype[Any] = np.dtype(array.dtype)
        chunks = getattr(array, "shards", None) or getattr(array, "chunks", None) or (1,) * array.ndim
        #: Planes of a row of chunks: those that are packed together.
        self.depth = max(int(chunks[-3]), 1)
        self._row: tuple[int, npt.NDArray[Any]] | None = None

    def _opened(self) -> Any:
        path, inner, before = self._of
        opened = _open(path)
        try:
            array: Any = opened[inner] if inner else opened
            n_axes, shape = array.ndim, array.shape
        except Exception as error:
            raise InputError(f"{path}: there is no array {inner!r}, which is a level of the image", path) from error
        if n_axes != len(before) + 3:
            raise InputError(f"{path}: {n_axes} axes; planes, rows and columns are needed", path)
        for axis, (index, size) in enumerate(zip(before, shape, strict=False)):
            if not -size <= index < size:
                raise InputError(f"{path}: index {index} of axis {axis}, which has {size} entries", path)
        return array

    def _stored(self) -> Any:
        """The array, which is opened at the first use where the planes came from another process."""
        if self._array is None:
            array = self._opened()
            shape = tuple(int(n) for n in array.shape[len(self._of[2]) :])
            if (shape, array.dtype) != (self.shape, self.dtype):
                raise InputError(
                    f"{self._of[0]}: {shape} {array.dtype} here, and {self.shape} {self.dtype} where the job was made; the "
                    "path has to lead to the same scan everywhere",
                    self._of[0],
                )
            self._array = array
        return self._array

    def __getitem__(self, planes: slice) -> npt.NDArray[Any]:
        first, last, _ = planes.indices(self.shape[0])
        of_row = self.depth * self.shape[1] * self.shape[2] * self.dtype.itemsize
        if planes.step not in (None, 1) or last <= first or self.depth == 1 or of_row > ROW_BYTES:
            return self._read(planes)
        blocks = []
        for row in range(first // self.depth, -(-last // self.depth)):
            begin = row * self.depth
            if self._row is None or self._row[0] != row:
                # Let go before the next one is read: two would be twice the memory.
                self._row = None
                self._row = row, self._read(slice(begin, min(begin + self.depth, self.shape[0])))
            blocks.append(self._row[1][max(first - begin, 0) : last - begin])
        return blocks[0] if len(blocks) == 1 else np.concatenate(blocks)

    def _read(self, planes: slice) -> npt.NDArray[Any]:
        path, _, before = self._of
        array = self._stored()
        try:
            return np.asarray(array[(*before, planes)])
        except Exception as error:
            # Codecs and stores raise errors of many kinds, and most do not name the file.
            raise InputError(
                f"{path}: planes {planes.start} to {planes.stop} cannot be read: {error or type(error).__name__}", path
            ) from error

    def __reduce__(self) -> tuple[Any, ...]:
        return _planes, (self._of, self.shape, self.dtype.str, self.depth)


def missing_chunks(array: Any, first: int, end: int) -> int:
    """How many stored objects (shards, or chunks where there are none) of planes the store has not. Zarr reads them
    as the fill value: programs leave out objects that hold nothing else, but an incomplete copy lacks others too.

    ``array`` is planes of a file, or an array of Zarr as the user opened it.
    """
    before: tuple[int, ...] = ()
    path = str(getattr(array, "store_path", array))
    if isinstance(array, ZarrPlanes):
        path, _, before = array._of
        array = array._stored()
    sizes = getattr(array, "shards", None) or array.chunks
    places = [range(k % n // size, k % n // size + 1) for k, n, size in zip(before, array.shape, sizes, strict=False)]
    depth, *plane = sizes[-3:]
    places.append(range(first // depth, -(-end // depth)))
    places += [range(-(-n // size)) for n, size in zip(array.shape[-2:], plane, strict=True)]
    prefix = f"{array.path}/" if array.path else ""
    name_of_chunk = array.metadata.encode_chunk_key

    def is_wanted(key: str) -> bool:
        # Names are made of numbers by the array alone, so one that is read back is compared with what it makes of them.
        at = tuple(int(n) for n in re.findall(r"[0-9]+", key[len(prefix) :]))
        inside = len(at) == len(places) and all(n in place for n, place in zip(at, places, strict=True))
        return inside and prefix + name_of_chunk(at) == key

    async def count() -> int:
        if array.store.supports_listing:
            # What is stored is counted, and not what might be: of that there may be billions.
            n_stored = sum([is_wanted(key) async for key in array.store.list_prefix(prefix)])
            return math.prod(map(len, places)) - n_stored
        keys = (prefix + name_of_chunk(at) for at in itertools.product(*places))
        return sum([not await array.store.exists(key) for key in keys])

    sync: Any = importlib.import_module("zarr.core.sync")
    try:
        found: int = sync.sync(count())
    except Exception as error:
        raise InputError(f"{path}: its chunks cannot be listed: {error or type(error).__name__}", path) from error
    return found


def _planes(of: tuple[str, str, tuple[int, ...]], shape: tuple[int, ...], dtype: str, depth: int) -> ZarrPlanes:
    # A worker of Dask that cannot unpack a task ends, and with it whoever waits: a missing file is told when it is read.
    planes = ZarrPlanes.__new__(ZarrPlanes)
    planes._of, planes.shape, planes.dtype, planes.depth = of, shape, np.dtype(dtype), depth
    planes._array, planes._row = None, None
    return planes


def read_zarr(
    path: str | os.PathLike[str], *, level: int = 0, channel: int = 0, time: int = 0, spacing: Any = None
) -> Volume:
    """The scan of a Zarr array or an OME-Zarr image; nothing is read but its description.

    ``level`` is the resolution, 0 the finest; ``channel`` and ``time`` choose among several. ``spacing`` (planes, rows,
    columns, mm) is that of the image; one that is given wins, and a plain array needs it in the job or here. Chunks that
    are not there have the array's fill value, as everywhere in Zarr; a plan warns of them (``scan-chunks-missing``). The
    package zarr has to be installed.
    """
    name = name_of(path)
    level, channel, time = whole(level, "level"), whole(channel, "channel"), whole(time, "time")
    opened = _open(name)
    # Whoever unpacks it may stand in another folder.
    place = name if "://" in name else os.path.abspath(name)
    image = _multiscales(opened)
    if image is None:
        if hasattr(opened, "keys"):
            raise InputError(f"{name}: a group without OME-Zarr's multiscales; name one of its arrays", name)
        return Volume(ZarrPlanes(place, "", ()), spacing=spacing)
    datasets = _entries(name, image, "datasets")
    if not all(isinstance(one.get("path"), str) for one in datasets):
        raise InputError(f"{name}: a level of the image has no path", name)
    if not 0 <= level < len(datasets):
        raise InputError(f"{name}: level = {level} should be from 0 to {len(datasets) - 1}", name)
    axes = _entries(name, image, "axes")
    names = [str(axis.get("name")) for axis in axes]
    if names[-3:] != ["z", "y", "x"]:
        raise InputError(f"{name}: the axes {', '.join(names)}; the last should be z, y and x", name)
    chosen = {"t": time, "c": channel}
    unknown = [axis for axis in names[:-3] if axis not in chosen]
    if unknown:
        raise InputError(f"{name}: the axis {unknown[0]} is not known; t and c may stand before z, y, x", name)
    before = tuple(chosen[axis] for axis in names[:-3])
    if spacing is None:
        spacing = _spacing(name, axes, [datasets[level], image])
    return Volume(ZarrPlanes(place, datasets[level]["path"], before), spacing=spacing)


def _entries(name: str, image: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    """The entries of a list in the description of an image; axes may be names alone."""
    given = image.get(key)
    if not isinstance(given, list) or not given or not all(isinstance(one, (Mapping, str)) for one in given):
        raise InputError(f"{name}: the image has no list of {key}", name)
    return [one if isinstance(one, Mapping) else {"name": one} for one in given]


def _open(path: str) -> Any:
    try:
        zarr: Any = importlib.import_module("zarr")
    except ImportError as error:
        raise JobError('Zarr needs the package zarr: pip install "grainpath[zarr]"') from error
    if not os.path.isdir(path) and "://" not in path and not os.path.isfile(path):
        raise InputError(f"{path}: no such file or directory", path)
    try:
        return zarr.open(path, mode="r")
    except Exception as error:
        raise InputError(f"{path}: is no Zarr array or group ({error})", path) from error


def _multiscales(opened: Any) -> Mapping[str, Any] | None:
    """The description of the first image; version 0.5 keeps it under ``ome``."""
    attributes: Mapping[str, Any] = dict(opened.attrs)
    attributes = attributes.get("ome", attributes)
    images = attributes.get("multiscales")
    if isinstance(images, list) and images and isinstance(images[0], Mapping):
        found: Mapping[str, Any] = images[0]
        return found
    return None


def _spacing(name: str, axes: list[Mapping[str, Any]], sources: list[Mapping[str, Any]]) -> list[float]:
    """Distances along z, y, x: the scales of the level and of the whole image, in the units of the axes."""
    scale, n_scales = np.ones(len(axes)), 0
    for source in sources:
        if "coordinateTransformations" not in source:
            continue
        for step in _entries(name, source, "coordinateTransformations"):
            if step.get("type") == "scale":
                given = floats(step.get("scale"), f"{name}: scale", (None,))
                if given.shape != scale.shape:
                    raise InputError(f"{name}: a scale of {given.size} numbers for {len(axes)} axes", name)
                if (given <= 0).any():
                    raise InputError(f"{name}: a scale of {given.tolist()}; all should be above 0", name)
                scale *= given
                n_scales += 1
    if n_scales == 0:
        raise InputError(f"{name}: the level has no scale; give spacing=(z, y, x) in mm", name)
    out = []
    for k, axis in enumerate(axes[-3:]):
        unit = axis.get("unit")
        if unit is None:
            raise InputError(f"{name}: the axis {axis.get('name')} has no unit; give spacing=(z, y, x) in mm", name)
        if not isinstance(unit, str) or unit not in UNITS_MM:
            raise InputError(f"{name}: the unit {unit}; give spacing=(z, y, x) in mm", name)
        out.append(float(scale[len(axes) - 3 + k]) * UNITS_MM[unit])
    return out
