"""Stress under the loads of a job."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _grainpath
from ._checks import FloatArray, floats, plain, read_only
from .errors import InputError
from .layers import table


#: Least and greatest value of the largest component of all tensors, MPa. Measured: beads follow a pull as well at 1e-9 MPa as at
#: 10 (2.16 degrees), and at 1e-11 no longer (4.08). Source of the greatest: derived: the equivalent stress is a root of squares,
#: and the square of 1e100 is a number.
RANGE_MPA = 1e-9, 1e100


class Stress:
    """Stress that was computed elsewhere, at points of the part: infill follows its principal directions.

    ``points`` are ``(n, 3)``, mm, in the coordinates of the part, and reach over the whole part: each side of their box has
    to agree with that of the part within 5 % of its longest side (of points of one height, x and y). ``tensors`` are ``(n, 6)``: xx, yy, zz, xy, yz, zx, or
    ``(n, 3, 3)``, MPa, tension positive. Between points the nearest count.

    >>> import numpy as np, grainpath as gp
    >>> points = np.random.default_rng(1).random((50, 3)) * [20, 10, 1]
    >>> pull = gp.Stress(points, np.tile([10.0, 0, 0, 0, 0, 0], (50, 1)))
    >>> plan = gp.Job(gp.box(20, 10, 1), stress=pull, fill__pattern="aligned").plan()
    >>> plan.report["stress"]["max_von_mises_mpa"]
    10.0
    """

    def __init__(self, points: npt.ArrayLike, tensors: npt.ArrayLike) -> None:
        self.points = read_only(floats(points, "points", (None, 3)))
        given = plain(tensors, "tensors")
        if given.ndim == 3:
            matrices = floats(given, "tensors", (len(self.points), 3, 3))
            if not np.allclose(matrices, np.swapaxes(matrices, 1, 2)):
                raise InputError("tensors should be symmetric matrices")
            given = matrices[:, [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
        self.tensors = read_only(floats(given, "tensors", (len(self.points), 6)))
        if len(self.points) == 0:
            raise InputError("points is empty; stress needs at least one point")
        largest = float(np.abs(self.tensors).max())
        least, most = RANGE_MPA
        if largest and not least <= largest <= most:
            raise InputError(f"the largest of tensors is {largest:g} MPa; from {least:g} to {most:g} MPa is needed")

    def _given(self) -> tuple[FloatArray, FloatArray]:
        return self.points.reshape(-1), self.tensors.reshape(-1)

    def __reduce__(self) -> tuple[Any, ...]:
        # Made anew, since numpy unpacks arrays that may be written to.
        return Stress, (self.points, self.tensors)

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
        return _equivalent(self.at(points))

    def __repr__(self) -> str:
        return f"<grainpath.StressCase: {self.name}, {len(self.nodes)} nodes>"

    def _rows(self) -> list[tuple[str, object]]:
        """What a notebook shows of the case."""
        rows: list[tuple[str, object]] = [("nodes", len(self.nodes)), ("weight", f"{self.weight:.6g}")]
        if len(self.nodes):
            rows.append(("largest equivalent stress at a node", f"{_equivalent(self.at_nodes).max():.4g} MPa"))
        if self.displacement is not None and len(self.displacement):
            rows.append(("largest displacement", f"{np.linalg.norm(self.displacement, axis=1).max():.4g} mm"))
        return rows

    def _repr_html_(self) -> str:
        return table(f"Stress, load case {self.name}", self._rows())

    def __reduce__(self) -> tuple[Any, ...]:
        return _case, self._data.parts()


def _case(name: str, weight: float, nodes: Any, stress: Any, displacement: Any, runs: Any, sets: Any) -> StressCase:
    def array(given: Any, dtype: Any) -> npt.NDArray[Any]:
        # Buffers that came over a network may lie at any address.
        return np.require(given, dtype, ["C", "A"])

    moved = None if displacement is None else array(displacement, np.float64)
    elements = [(kind, array(rows, np.uint32)) for kind, rows in runs]
    parts = (name, weight, array(nodes, np.float64), array(stress, np.float64), moved, elements, sets)
    return StressCase(_grainpath.stress_from_parts(parts))


def _equivalent(stress: FloatArray) -> FloatArray:
    """Equivalent stress (von Mises) of tensors ``(n, 6)``."""
    xx, yy, zz, xy, yz, zx = stress.T
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    found: FloatArray = np.sqrt(0.5 * normal + 3.0 * (xy**2 + yz**2 + zx**2))
    return found


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

    def _repr_html_(self) -> str:
        rows = [(f"{case.name}: {name}", value) for case in self.cases for name, value in case._rows()]
        return table("Stress", rows)
