"""Stress under the loads of a job."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _grainpath
from ._checks import FloatArray, floats, read_only
from .errors import InputError


class Stress:
    """Stress that was computed elsewhere, at points of the part: infill follows its principal directions.

    ``points`` are ``(n, 3)``, mm, in the coordinates of the part. ``tensors`` are ``(n, 6)``: xx, yy, zz, xy, yz, zx, or
    ``(n, 3, 3)``, MPa, tension positive. Between points the nearest count.

    >>> import numpy as np, grainpath as gp
    >>> points = np.random.default_rng(1).random((50, 3)) * [20, 10, 1]
    >>> pull = gp.Stress(points, np.tile([10.0, 0, 0, 0, 0, 0], (50, 1)))
    >>> plan = gp.Job(gp.box(20, 10, 1), stress=pull, fill__pattern="aligned").plan()
    >>> plan.report["stress"]["max_von_mises_mpa"]
    10.0
    """

    def __init__(self, points: npt.ArrayLike, tensors: npt.ArrayLike) -> None:
        self.points = read_only(floats(points, "points", (None, 3)).copy())
        given = np.asarray(tensors)
        if given.ndim == 3:
            matrices = floats(given, "tensors", (len(self.points), 3, 3))
            if not np.allclose(matrices, np.swapaxes(matrices, 1, 2)):
                raise InputError("tensors should be symmetric matrices")
            given = matrices[:, [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
        self.tensors = read_only(floats(given, "tensors", (len(self.points), 6)).copy())
        if len(self.points) == 0:
            raise InputError("points is empty; stress needs at least one point")

    def _given(self) -> tuple[FloatArray, FloatArray]:
        return self.points.reshape(-1), self.tensors.reshape(-1)

    def __repr__(self) -> str:
        return f"<grainpath.Stress: {len(self.points)} points>"


class StressCase:
    """The stress of one load case: tensors xx, yy, zz, xy, yz, zx in MPa, tension positive."""

    def __init__(self, data: _grainpath.StressData) -> None:
        self._data = data
        #: Name of the case.
        self.name: str = data.name
        #: Weight of the case among others.
        self.weight: float = data.weight

    @cached_property
    def nodes(self) -> FloatArray:
        """Nodes of the mesh, ``(n, 3)``, mm, in part coordinates, read-only."""
        return read_only(self._data.nodes())

    @cached_property
    def at_nodes(self) -> FloatArray:
        """Stress at the nodes, ``(n, 6)``, read-only."""
        return read_only(self._data.at_nodes())

    @cached_property
    def displacement(self) -> FloatArray | None:
        """Displacement of the nodes, ``(n, 3)``, mm, where it is known."""
        found = self._data.displacement()
        return None if found is None else read_only(found)

    def at(self, points: npt.ArrayLike) -> FloatArray:
        """Stress at points ``(n, 3)`` of the part, ``(n, 6)``; outside, that of the nearest point of the part."""
        return self._data.at(floats(points, "points", (None, 3)))

    def tensors(self, points: npt.ArrayLike) -> FloatArray:
        """Stress at points as symmetric matrices, ``(n, 3, 3)``."""
        return self.at(points)[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]

    def principal(self, points: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Principal stresses ``(n, 3)``, greatest first, and their directions ``(n, 3, 3)``, one a row."""
        values, vectors = np.linalg.eigh(self.tensors(points))
        return values[:, ::-1], np.swapaxes(vectors, 1, 2)[:, ::-1]

    def von_mises(self, points: npt.ArrayLike) -> FloatArray:
        """Equivalent stress at points, ``(n,)``."""
        xx, yy, zz, xy, yz, zx = self.at(points).T
        normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
        found: FloatArray = np.sqrt(0.5 * normal + 3.0 * (xy**2 + yz**2 + zx**2))
        return found

    def __repr__(self) -> str:
        return f"<grainpath.StressCase: {self.name}, {len(self.nodes)} nodes>"

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError("stress is not pickled; pickle its plan, or the arrays nodes and at_nodes")


class StressResult:
    """The stress of a plan, case by case. What is asked of it is asked of the case with the largest weight."""

    def __init__(self, cases: list[StressCase]) -> None:
        #: All load cases.
        self.cases = cases
        # The first among equals, as the planner has it.
        self._main = max(cases, key=lambda case: case.weight)

    def at(self, points: npt.ArrayLike) -> FloatArray:
        """Stress at points; see :meth:`StressCase.at`."""
        return self._main.at(points)

    def tensors(self, points: npt.ArrayLike) -> FloatArray:
        """Stress as matrices; see :meth:`StressCase.tensors`."""
        return self._main.tensors(points)

    def principal(self, points: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Principal stresses; see :meth:`StressCase.principal`."""
        return self._main.principal(points)

    def von_mises(self, points: npt.ArrayLike) -> FloatArray:
        """Equivalent stress; see :meth:`StressCase.von_mises`."""
        return self._main.von_mises(points)

    def __repr__(self) -> str:
        return f"<grainpath.StressResult: {', '.join(case.name for case in self.cases)}>"
