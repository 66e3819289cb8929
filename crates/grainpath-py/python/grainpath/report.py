"""Reports: what was measured, as nested dictionaries that a notebook shows as tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from .layers import table

#: Longest list that a table shows number by number. Longer ones, such as curves, are told by their length; a position or
#: a size has three numbers.
LISTED = 4


class Report(dict[str, Any]):
    """What was measured, by name, as ``--json`` of the command line prints it.

    >>> import grainpath as gp
    >>> report = gp.Job(gp.box(20, 10, 1)).plan().report
    >>> report["layers"], "<td>5</td>" in report._repr_html_()
    (5, True)
    """

    def __init__(self, caption: str, found: Mapping[str, Any]) -> None:
        super().__init__(found)
        self._caption = caption

    def _repr_html_(self) -> str:
        return table(self._caption, list(_rows("", self)))

    def __reduce__(self) -> tuple[Any, ...]:
        return Report, (self._caption, dict(self))


def _rows(name: str, value: Any) -> Iterator[tuple[str, object]]:
    """The rows of a value: one for each number or text in it, named by its path."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _rows(f"{name}.{key}" if name else str(key), inner)
    elif isinstance(value, list) and any(isinstance(one, (Mapping, list)) for one in value):
        # Warnings are what a reader must not miss; other lists of records are as long as the part is large.
        if name.split(".")[-1] == "warnings":
            yield from ((f"{name}: {one['id']}", one["text"]) for one in value)
        else:
            yield name, f"{len(value)} entries"
    elif isinstance(value, list) and len(value) > LISTED:
        yield name, f"{len(value)} values"
    elif isinstance(value, list):
        yield name, ", ".join(map(_shown, value))
    else:
        yield name, _shown(value)


def _shown(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    return f"{value:.6g}" if isinstance(value, float) else str(value)
