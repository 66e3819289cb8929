"""Photographs as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _grainpath
from ._checks import plain, read_only
from .errors import InputError

#: Most pixels, as readers of files have it.
MAX_PIXELS = 250_000_000


class Image:
    """A photograph whose grain infill follows: ``(rows, columns)``, or ``(rows, columns, channels)`` with 1 to 4
    channels (grey, grey and alpha, RGB, RGBA), rows from the top.

    Numbers are uint8, uint16, or floats, whose lowest is black and whose highest is white. How the board lies in the
    picture and how large it is, the settings ``shape.photo`` and ``guide.image`` say; ``name`` stands in messages.

    >>> import numpy as np, grainpath as gp
    >>> x = np.arange(300)
    >>> grain = gp.Image(np.tile(128 + 100 * np.sin(x / 3), (200, 1)))
    >>> job = gp.Job(gp.box(30, 20, 1), grain=grain, fill__pattern="stripes", fill__density=0.4)
    >>> job["guide.kind"]
    'grain'
    """

    def __init__(self, array: npt.ArrayLike, *, name: str = "an array") -> None:
        given = plain(array, "the picture")
        if given.dtype.kind not in "fiub":
            raise InputError(f"the picture has the type {given.dtype}; numbers are needed")
        if given.ndim not in (2, 3) or (given.ndim == 3 and not 1 <= given.shape[2] <= 4):
            raise InputError(
                f"the picture has the shape {given.shape}; (rows, columns) or (rows, columns, 1 to 4) is needed"
            )
        if 0 in given.shape:
            raise InputError(f"the picture has the shape {given.shape}, which is empty")
        if given.shape[0] * given.shape[1] > MAX_PIXELS:
            raise InputError(f"{given.shape[0]} x {given.shape[1]} pixels; at most {MAX_PIXELS} are handled")
        if given.dtype.kind == "b":
            given = given.astype(np.uint8) * np.uint8(255)
        kinds: dict[str, Any] = {"uint8": np.uint8, "uint16": np.uint16}
        kept = kinds.get(given.dtype.newbyteorder("=").name, np.float32)
        #: The samples, ``(rows, columns, channels)``, read-only.
        self.array: npt.NDArray[Any] = read_only(
            np.array(given.reshape(*given.shape[:2], -1), dtype=kept, order="C")
        )
        if kept is np.float32 and not np.isfinite(self.array).any():
            raise InputError("no pixel of the picture is a finite number")
        self.name = name
        self._data = _grainpath.image_from_array(name, self.array)

    def __repr__(self) -> str:
        rows, columns, channels = self.array.shape
        return f"<grainpath.Image: {columns} x {rows} pixels, {channels} channels, {self.array.dtype}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.array, self.name)


def _again(array: npt.NDArray[Any], name: str) -> Image:
    return Image(array, name=name)
