"""What a job may contain."""

from __future__ import annotations

import json
from typing import Any

from . import _grainpath
from .errors import JobError


def schema() -> dict[str, Any]:
    """The JSON Schema of job files.

    >>> import grainpath as gp
    >>> gp.schema()["properties"]["fill"]["properties"]["density"]["default"]
    0.2
    """
    found: dict[str, Any] = json.loads(_grainpath.schema())
    return found


def profiles(name: str | None = None) -> Any:
    """The profiles that come with grainpath: a dict of kind to names, or the TOML of one.

    >>> import grainpath as gp
    >>> "pla" in gp.profiles()["material"]
    True
    """
    all_profiles = _grainpath.profiles()
    if name is None:
        kinds: dict[str, list[str]] = {}
        for kind, own, _ in all_profiles:
            kinds.setdefault(kind, []).append(own)
        return kinds
    for _, own, text in all_profiles:
        if own == name:
            return text
    raise JobError(f"no profile {name!r}; there are {', '.join(own for _, own, _ in all_profiles)}")
