"""Scans as arrays."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ._checks import floats, plain
from .errors import InputError
from .layers import table

#: Types of voxels, as the planner names them.
SAMPLES = {
    "uint8": "u8",
    "int8": "i8",
    "uint16": "u16",
    "int16": "i16",
    "uint32": "u32",
    "int32": "i32",
    "float32": "f32",
    "float64": "f64",
}

#: Most voxels of a plane, and most planes: as readers of files have it.
MAX_PIXELS = 1 << 26
MAX_PLANES = 1 << 20


class Volume:
    """A scan: grey values ``array[plane, row, column]`` and the distances of voxels, mm, in the same order.

    ``array`` is anything with ``shape``, ``dtype`` and ``__getitem__``: a numpy array of any byte order and strides, a
    memory map, an h5py, Zarr or Dask array. Nothing is copied: it is kept, and read in slabs of planes while a plan is
    made, in the thread that called :meth:`Job.plan`, as float32. Columns lie along x, rows along y, planes along z.

    >>> import numpy as np, grainpath as gp
    >>> z, y, x = np.mgrid[:10, :60, :60]
    >>> ball = (200 * ((x - 30) ** 2 + (y - 30) ** 2 < 400)).astype("u1")
    >>> gp.Job(gp.Volume(ball, spacing=(0.2, 0.2, 0.2))).plan()
    <grainpath.Plan: 10 layers to 2 mm>
    """

    def __init__(self, array: Any, *, spacing: float | Sequence[float] | None = None) -> None:
        shape = getattr(array, "shape", None)
        if shape is None or not hasattr(array, "__getitem__") or np.ma.isMaskedArray(array):
            array = plain(array, "the array")
            shape = array.shape
        if not isinstance(shape, (tuple, list)) or len(shape) != 3:
            raise InputError(f"the array has the shape {shape!r}; (planes, rows, columns) is needed")
        shape = _lengths(shape)
        try:
            dtype = np.dtype(getattr(array, "dtype", np.float32))
        except TypeError as error:
            raise InputError(f"the array has the type {array.dtype!r}, which numpy does not know") from error
        if dtype.kind == "b":
            dtype = np.dtype(np.uint8)
        if dtype.newbyteorder("=").name not in SAMPLES and dtype.kind not in "iuf":
            raise InputError(f"the array has the type {dtype}; integers or floats are needed")
        self.array = array
        self.shape: tuple[int, int, int] = shape
        self.dtype = dtype
        self.spacing: tuple[float, float, float] | None = None
        if spacing is not None:
            given = floats([spacing] * 3 if np.ndim(spacing) == 0 else spacing, "spacing", (3,))
            if (given <= 0).any():
                raise InputError(f"spacing is {spacing}; all three should be above 0, mm")
            self.spacing = (float(given[0]), float(given[1]), float(given[2]))

    def _slices(self, first: int, count: int) -> npt.NDArray[np.float32]:
        """Planes as one flat array of float32."""
        block = plain(self.array[first : first + count], f"planes {first} to {first + count} of the array")
        if block.shape != (count, *self.shape[1:]):
            raise InputError(
                f"planes {first} to {first + count} of the array have the shape {block.shape}; "
                f"{(count, *self.shape[1:])} is needed"
            )
        if block.dtype.kind not in "iufb":
            raise InputError(
                f"planes {first} to {first + count} of the array have the type {block.dtype}; {self.dtype} was promised"
            )
        # What is beyond float32 becomes infinite, and is warned of with the other voxels that are not finite.
        with np.errstate(over="ignore"):
            flat: npt.NDArray[np.float32] = np.require(block, np.float32, ["C", "A"]).reshape(-1)
        return flat

    def _missing(self, window: Callable[[], list[int] | None]) -> int:
        """How many chunks of the planes in the job's window its store has not; 0 for arrays without a store of chunks."""
        # By its name, since the package zarr is there only where it is used.
        kind = type(self.array)
        if (kind.__module__.split(".")[0], kind.__name__) not in (("zarr", "Array"), ("grainpath", "ZarrPlanes")):
            return 0
        from .omezarr import missing_chunks

        first, last = window() or (0, self.shape[0] - 1)
        # A window beyond the scan is an error of the plan, which names it.
        return missing_chunks(self.array, first, min(last + 1, self.shape[0]))

    def _given(self, missing: int = 0) -> tuple[list[int], str, list[float] | None, Any, int]:
        planes, rows, columns = self.shape
        # The planner is told what float32 may have rounded: integers of 64 bits and long floats, as float64.
        sample = SAMPLES.get(self.dtype.newbyteorder("=").name, "f64" if self.dtype.itemsize > 4 else "f32")
        spacing = None if self.spacing is None else list(reversed(self.spacing))
        return [columns, rows, planes], sample, spacing, self._slices, missing

    def _repr_html_(self) -> str:
        spacing = "none" if self.spacing is None else " x ".join(f"{s:.6g}" for s in self.spacing) + " mm"
        rows = [("planes x rows x columns", " x ".join(map(str, self.shape))), ("type", self.dtype), ("spacing", spacing)]
        return table("Volume", rows)

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.shape))
        spacing = "no spacing" if self.spacing is None else f"{self.spacing} mm"
        return f"<grainpath.Volume: {shape} {self.dtype}, {spacing}>"


def _lengths(shape: Sequence[Any]) -> tuple[int, int, int]:
    """The lengths of a shape, which are in the limits of the planner."""
    if any(isinstance(n, float) and math.isnan(n) for n in shape):
        raise InputError(f"the array has the shape {tuple(shape)}; call its compute_chunk_sizes() first")
    try:
        planes, rows, columns = (operator.index(n) for n in shape)
    except TypeError as error:
        raise InputError(f"the array has the shape {tuple(shape)!r}; three whole numbers are needed") from error
    if min(planes, rows, columns) < 0:
        raise InputError(f"the array has the shape {tuple(shape)}; no length is below 0")
    if 0 in (planes, rows, columns):
        raise InputError(f"the array has the shape {tuple(shape)}, which is empty")
    if rows * columns > MAX_PIXELS or planes > MAX_PLANES:
        raise InputError(
            f"the array has the shape {(planes, rows, columns)}; at most {MAX_PIXELS} voxels a plane and {MAX_PLANES} planes "
            "are handled"
        )
    return planes, rows, columns
