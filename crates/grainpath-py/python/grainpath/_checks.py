"""Checks of arrays that users hand over, and settings as TOML."""

from __future__ import annotations

import json
import math
import operator
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import InputError, JobError

FloatArray = npt.NDArray[np.float64]


def plain(values: Any, name: str) -> npt.NDArray[Any]:
    """``values`` as an array. A mask would be lost without a word, so an array with one is refused."""
    if np.ma.isMaskedArray(values) and np.ma.is_masked(values):
        raise InputError(f"{name} has masked entries; give what they stand for, as by .filled(value)")
    try:
        return np.asarray(values)
    except ValueError as error:
        raise InputError(f"{name} is no array: rows of equal length are needed ({error})") from error


def whole(value: Any, name: str) -> int:
    """``value`` as an int. A number with a fraction is refused rather than cut."""
    try:
        return operator.index(value)
    except TypeError as error:
        raise InputError(f"{name} = {value!r}; a whole number is needed") from error


def floats(values: Any, name: str, shape: tuple[int | None, ...]) -> FloatArray:
    """``values`` as finite native float64 of a shape, whose ``None`` stand for any number."""
    array = plain(values, name)
    shown = ", ".join("n" if n is None else str(n) for n in shape)
    wanted = f"({shown},)" if len(shape) == 1 else f"({shown})"
    if array.dtype.kind not in "fiu":
        raise InputError(f"{name} has the type {array.dtype}; numbers (float or integer) are needed")
    fits = array.ndim == len(shape) and all(n is None or n == m for n, m in zip(shape, array.shape, strict=True))
    if not fits:
        raise InputError(f"{name} has the shape {array.shape}; {wanted} is needed")
    out: FloatArray = np.require(array, np.float64, ["C", "A"])
    bad = ~np.isfinite(out)
    if bad.any():
        at = tuple(int(i) for i in np.argwhere(bad)[0])
        place = f"[{', '.join(map(str, at))}]" if at else ""
        raise InputError(f"{name}{place} is {out[at]}; finite numbers are needed")
    return out


def read_only(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """A copy of the array whose memory belongs to ``bytes``, so that numpy refuses to make it writeable again."""
    return np.ndarray(array.shape, array.dtype, array.tobytes())


def toml(value: Any, key: str) -> str:
    """A Python value as TOML."""
    if isinstance(value, np.generic) or isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise JobError(f"{key} = {value}; a finite number is needed")
        return repr(value)
    if isinstance(value, str):
        # TOML's basic strings are JSON's, but for the control character that JSON lets pass.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        rows = (f"{json.dumps(str(k), ensure_ascii=False)} = {toml(v, f'{key}.{k}')}" for k, v in value.items())
        return "{ " + ", ".join(rows) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(v, key) for v in value) + "]"
    raise JobError(
        f"{key} = {value!r} is a {type(value).__name__}; a number, a text, true or false, a list or a dict is needed"
    )
