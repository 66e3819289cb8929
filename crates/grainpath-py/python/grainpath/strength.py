"""Virtual tests: how much a part carries until it breaks."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _grainpath
from ._checks import FloatArray, read_only
from .layers import table
from .report import Report
from .warning import Warning, warnings_of


class Strength:
    """The result of a virtual test; ``docs/strength.md`` says what is computed and what is not.

    >>> import grainpath as gp
    >>> piece, job = gp.specimen("iso527-1a")
    >>> job is not None
    True
    """

    def __init__(self, found: str) -> None:
        self._found: dict[str, Any] = json.loads(found)
        #: All that was found, as ``grainpath strength --json`` prints it.
        self.report: dict[str, Any] = Report("Strength", self._found["strength"])
        #: Mass of the program, g, and its time, s.
        self.mass_g: float = self._found["mass_g"]
        self.time_s: float = self._found["time_s"]

    @property
    def peak_n(self) -> float:
        """The largest load, N."""
        return float(self.report["peak_load_n"])

    @property
    def interval_n(self) -> tuple[float, float]:
        """The peak load with the weakest and the strongest material and the error of the grid, N."""
        return float(self.report["low_n"]), float(self.report["high_n"])

    @property
    def stiffness_n_per_mm(self) -> float:
        """Load over displacement at the start."""
        return float(self.report["stiffness_n_per_mm"])

    @property
    def curve(self) -> FloatArray:
        """Displacement in mm and load in N, ``(n, 2)``."""
        return read_only(np.array(self.report["curve"], dtype=np.float64).reshape(-1, 2))

    @property
    def mode(self) -> str:
        """How the part fails mostly."""
        return str(self.report["mode"])

    @property
    def weakest(self) -> str:
        """Where it fails first."""
        return str(self.report["weakest"]["words"])

    @property
    def warnings(self) -> list[Warning]:
        """Warnings of the plan and the test."""
        return warnings_of(self._found["warnings"])

    def __repr__(self) -> str:
        low, high = self.interval_n
        return f"<grainpath.Strength: {self.peak_n:.0f} N ({low:.0f} to {high:.0f}), {self.mode}>"

    def _repr_html_(self) -> str:
        low, high = self.interval_n
        rows = [
            ("peak load", f"{self.peak_n:.4g} N ({low:.4g} to {high:.4g} N)"),
            ("stiffness", f"{self.stiffness_n_per_mm:.4g} N/mm"),
            ("fails by", self.mode),
            ("first", self.weakest),
            ("mass", f"{self.mass_g:.4g} g"),
        ]
        return table("Strength", rows)

    def __reduce__(self) -> tuple[Any, ...]:
        return Strength, (json.dumps(self._found),)


def compare(tests: Sequence[Strength]) -> list[dict[str, Any]]:
    """Several tests of one part side by side, as ``grainpath compare --json`` has them; ratios are to the first.

    Tests of equal mass are made by ``job.with_(fill__mass_g=first.mass_g).strength()``.

    >>> import grainpath as gp
    >>> gp.compare([])
    []
    """
    found: list[dict[str, Any]] = json.loads(_grainpath.compare([json.dumps(test._found) for test in tests]))
    return found
