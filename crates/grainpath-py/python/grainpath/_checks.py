"""Checks of arrays that users hand over, and settings as TOML."""

from __future__ import annotations

import json
import math
import operator
import os
from collections.abc import Iterable, Mapping
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


def number(value: Any, name: str) -> float:
    """``value`` as a finite float."""
    return float(floats(value, name, ()))


def name_of(path: Any, name: str = "path") -> str:
    """A path as text. Bytes are refused, since messages and jobs name files in text."""
    try:
        found: str | bytes = os.fspath(path)
    except TypeError as error:
        raise InputError(f"{name} is a {type(path).__name__}; a str or an os.PathLike is needed") from error
    if isinstance(found, bytes):
        raise InputError(f"{name} is bytes; a str is needed: os.fsdecode(path)")
    if "\0" in found:
        raise InputError(f"{name} {found!r} has a NUL character, which no file's name has")
    return found


def whole_text(text: str, name: str) -> None:
    """Refuses halves of characters, which numpy and file systems may leave in a text, and UTF-8 has not."""
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise JobError(f"{name} has half of a character ({text[error.start]!r} at {error.start}), which is no text") from error


def nearest(word: str, words: Iterable[str]) -> str:
    """What was probably meant by a word that is not among some; empty if none of them is near."""
    # Imported here, since only mistakes need it.
    import difflib

    near = difflib.get_close_matches(word, list(words), n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def watch(progress: Any, cancel: Any) -> None:
    """Refuses what cannot be called for progress, and what is no token."""
    if progress is not None and not callable(progress):
        raise JobError(f"progress is a {type(progress).__name__}; a function of stage, done and total is needed")
    if cancel is not None and not callable(getattr(cancel, "is_set", None)):
        raise JobError(f"cancel is a {type(cancel).__name__}; a token with is_set() is needed, such as threading.Event()")


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
        whole_text(value, key)
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
