"""Warnings: what was assumed, and what cannot be trusted."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Warning:
    """A warning. ``id`` is a stable name, listed in docs/warnings.md.

    >>> import grainpath as gp
    >>> [w.id for w in gp.Job(gp.box(20, 10, 1)).plan().warnings]
    []
    """

    id: str
    text: str
    place: dict[str, Any] | None
    remedy: str

    def __str__(self) -> str:
        return f"{self.id}: {self.text}"


def warnings_of(text: str | list[dict[str, Any]]) -> list[Warning]:
    """The warnings in JSON of the planner."""
    rows = json.loads(text) if isinstance(text, str) else text
    return [Warning(w["id"], w["text"], w.get("place"), w["remedy"]) for w in rows]
