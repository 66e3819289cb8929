"""A user's own directions."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ._checks import FloatArray, floats, plain, read_only
from .errors import InputError
from .mesh import Mesh

#: Points of a call of a user's function. A larger batch gains nothing in numpy, and shows Ctrl-C later.
BATCH = 65_536
#: Places at each level, and between each and the next, at which a function is compared with its grid: as many cells of a
#: grid of 64 x 64, and few calls beside those of any grid that is larger.
CHECKED = 4096
#: Steps of the places within their cells, which fill a cell evenly in three directions and never repeat: powers of 1 / g,
#: where g^4 = g + 1. Source: M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
STEPS = 1.2207440846057596 ** -np.arange(1.0, 4.0)
#: Most points of a grid, which is what the planner reads of tables.
MAX_POINTS = 4_000_000

Function = Callable[[FloatArray], npt.ArrayLike]


class Field:
    """Directions that infill follows: an undirected axis in the plane at each point of a grid.

    ``axes`` are the positions of the grid along x, y and perhaps z, mm, in the coordinates of the part. ``directions``
    is one of

    - angles from +X counter-clockwise, radians, of shape ``(len(x), len(y)[, len(z)])``;
    - vectors, with a last index of 2 or 3 more;
    - a function of points ``(n, 2)`` or ``(n, 3)`` that returns ``n`` angles or vectors. It is called in this thread, in
      batches, once for each point of the grid; its exceptions come back as they are. :attr:`error_deg` says how far the
      grid is off the function between its points.

    NaN, infinite numbers and vectors of length 0 are points without a direction. ``strength`` (0 to 1, how much a direction matters) and
    ``spacing_mm`` (distance of beads) have the shape of the grid. Between points directions are interpolated as axes,
    without a sign; outside, the nearest point counts.

    >>> import numpy as np, grainpath as gp
    >>> x, y = np.linspace(0, 20, 41), np.linspace(0, 10, 21)
    >>> rings = gp.Field((x, y), lambda p: np.arctan2(p[:, 1], p[:, 0] + 5) + np.pi / 2)
    >>> bool(rings.error_deg < 0.2)
    True
    """

    def __init__(
        self,
        axes: Sequence[npt.ArrayLike],
        directions: npt.ArrayLike | Function,
        *,
        strength: npt.ArrayLike | None = None,
        spacing_mm: npt.ArrayLike | None = None,
    ) -> None:
        if not hasattr(axes, "__len__") or len(axes) not in (2, 3):
            found = f"{len(axes)} entries" if hasattr(axes, "__len__") else f"the type {type(axes).__name__}"
            raise InputError(f"axes has {found}; positions along x, y and perhaps z are needed")
        # Copied, as all arrays of a field are: the memory is the user's, and a field does not change.
        self.axes = tuple(read_only(floats(a, f"axes[{k}]", (None,))) for k, a in enumerate(axes))
        for k, axis in enumerate(self.axes):
            if len(axis) == 0 or (np.diff(axis) <= 0).any():
                raise InputError(f"axes[{k}] should rise from entry to entry and have at least one")
        self.shape = tuple(len(a) for a in self.axes)
        _count(self.shape)
        #: Greatest angle that was found between the function and the grid, degrees, at places between its points on every
        #: level and between the levels; 0 for arrays, NaN where no place has a direction of both.
        self.error_deg = 0.0
        if callable(directions):
            flat = _called(directions, self._points())
            self.vectors = read_only(flat.reshape(*self.shape, 2 if flat.shape[1] == 2 else 3))
        else:
            self.vectors = read_only(self._vectors(directions))
        self.strength = self._others(strength, "strength")
        self.spacing_mm = self._others(spacing_mm, "spacing_mm")
        if self.strength is not None and not ((self.strength >= 0) & (self.strength <= 1)).all():
            raise InputError("strength should be from 0 to 1")
        if self.spacing_mm is not None and not (self.spacing_mm > 0).all():
            raise InputError("spacing_mm should be above 0")
        if not np.isfinite(self.vectors).all(axis=-1).any():
            raise InputError("no point of the field has a direction: all are NaN")
        if callable(directions):
            self.error_deg = self._error(directions)

    @classmethod
    def over(cls, part: Mesh, function: Function, *, cell_mm: float = 1.0) -> Field:
        """The field of a function over a part, on a grid of about ``cell_mm``.

        >>> import grainpath as gp
        >>> gp.Field.over(gp.box(20, 10, 2), lambda p: p[:, 0] * 0.1).shape
        (21, 11)
        """
        if not isinstance(part, Mesh):
            raise InputError(f"part is a {type(part).__name__}; a Mesh is needed, or give axes: Field((x, y), function)")
        if not floats(cell_mm, "cell_mm", ()) > 0:
            raise InputError(f"cell_mm = {cell_mm} should be above 0")
        low, high = part.bounds_mm[:, :2]
        cells = np.maximum(np.ceil((high - low) / cell_mm), 1)
        _count(cells + 1)
        n = cells.astype(int) + 1
        return cls(tuple(np.linspace(low[k], high[k], n[k]) for k in range(2)), function)

    def _points(self) -> FloatArray:
        return np.stack(np.meshgrid(*self.axes, indexing="ij"), axis=-1).reshape(-1, len(self.axes))

    def _vectors(self, directions: npt.ArrayLike) -> FloatArray:
        array = plain(directions, "directions")
        if array.dtype.kind not in "fiu":
            raise InputError(f"directions has the type {array.dtype}; numbers are needed")
        array = array.astype(np.float64)
        if array.shape == self.shape:
            return _of_angles(array)
        if array.shape[:-1] == self.shape and array.shape[-1] in (2, 3):
            return _handy(array)
        raise InputError(
            f"directions has the shape {array.shape}; {self.shape} is needed for angles, with a last index of 2 or 3 "
            "more for vectors"
        )

    def _others(self, values: npt.ArrayLike | None, name: str) -> FloatArray | None:
        if values is None:
            return None
        array = floats(values, name, (None,) * np.ndim(values))
        if array.ndim not in (0, len(self.shape)) or array.shape not in ((), self.shape):
            raise InputError(f"{name} has the shape {array.shape}; {self.shape} is needed, as the grid has")
        return read_only(np.broadcast_to(array, self.shape))

    def _error(self, function: Function) -> float:
        """Greatest angle between the function and the grid between its points, degrees."""
        levels = 1 if len(self.axes) == 2 else self.shape[2]
        with np.errstate(invalid="ignore", divide="ignore"):
            # What is interpolated: the doubled angle, weighted by the part of the direction in the plane and its strength.
            size = np.linalg.norm(self.vectors, axis=-1)
            double = ((self.vectors[..., 0] + 1j * self.vectors[..., 1]) / size) ** 2
        if self.strength is not None:
            double = double * self.strength
        double = double.reshape(*self.shape[:2], levels)
        # A plane with even steps is read as a picture, bilinearly. Other points are joined by triangles, which halve a cell
        # along either diagonal.
        ways = (_bilinear,) if self._even() else (_falling, _rising)
        places = 0.5 + np.arange(CHECKED)[:, None] * STEPS
        cells = self._cells()
        worst = -1.0
        for level in range(levels):
            for step in (0, 1) if level + 1 < levels else (0,):
                # Places go on from level to level, so that none is looked at twice.
                u, v, w = ((places + (2 * level + step) * CHECKED * STEPS) % 1.0).T
                w = w * step
                (x0, x1, x), (y0, y1, y) = _along(self.axes[0], cells[0], u), _along(self.axes[1], cells[1], v)
                points = [x, y]
                if len(self.axes) == 3:
                    z = self.axes[2]
                    points.append(z[level] + (z[level + step] - z[level]) * w)
                asked = _double(_called(function, np.stack(points, -1)))
                corners = ((x0, y0), (x1, y0), (x0, y1), (x1, y1))
                held = [(1 - w) * double[i, j, level] + w * double[i, j, level + step] for i, j in corners]
                for way in ways:
                    grid = sum(share * at for share, at in zip(way(u, v), held, strict=True))
                    angle = np.abs(np.angle(asked * np.conj(grid)))
                    known = np.isfinite(angle) & (np.abs(asked) > 0) & (np.abs(grid) > 0)
                    worst = max(worst, float(angle[known].max(initial=-1.0)))
        return float(np.rad2deg(0.5 * worst)) if worst >= 0 else float("nan")

    def _cells(self) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """The cell of each place that is checked: all cells in turn, or a share of them that is spread evenly."""
        nx, ny = (max(n - 1, 1) for n in self.shape[:2])
        k = np.arange(CHECKED)
        cell = k % (nx * ny) if nx * ny <= CHECKED else k * (nx * ny) // CHECKED
        return cell // ny, cell % ny

    def _even(self) -> bool:
        """Whether the grid is a plane whose steps along x and y are all equal."""
        steps = [np.diff(a) for a in self.axes[:2]]
        cell = float(steps[0].mean()) if len(steps[0]) else 0.0
        return len(self.axes) == 2 and all(len(s) and np.allclose(s, cell, rtol=1e-9, atol=0) for s in steps)

    def _file(self) -> tuple[bytes, dict[str, Any]]:
        """The field as a ``.npz``, and the settings that say how it lies."""
        arrays: dict[str, FloatArray] = {}
        settings: dict[str, Any] = {
            "guide.kind": "field",
            "guide.field.path": "grainpath.Field",
            "guide.field.frame": "part",
            "guide.field.length_unit": "mm",
        }
        if self._even():
            cell = float(np.diff(self.axes[0]).mean())
            arrays["vectors"] = self.vectors
            settings["guide.field.axes"] = "xy"
            settings["guide.field.array"] = "vectors"
            settings["guide.field.cell_mm"] = cell
            # Positions are those of the centres of cells.
            settings["guide.field.origin_mm"] = [float(a[0]) - 0.5 * cell for a in self.axes]
            others = {"strength": self.strength, "spacing": self.spacing_mm}
            arrays.update({name: a for name, a in others.items() if a is not None})
        else:
            names = ("x", "y", "z")
            arrays.update({names[k]: column for k, column in enumerate(self._points().T)})
            flat = self.vectors.reshape(-1, self.vectors.shape[-1])
            arrays.update({f"v{names[k]}": column for k, column in enumerate(flat.T)})
            if self.strength is not None:
                arrays["strength"] = self.strength.ravel()
            if self.spacing_mm is not None:
                arrays["spacing"] = self.spacing_mm.ravel()
        file = io.BytesIO()
        np.savez(file, **{name: np.ascontiguousarray(a) for name, a in arrays.items()})  # type: ignore[arg-type]
        return file.getvalue(), settings

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.axes, self.vectors, self.strength, self.spacing_mm, self.error_deg)

    def __repr__(self) -> str:
        return f"<grainpath.Field: {' x '.join(map(str, self.shape))} points>"


def _again(axes: Any, vectors: Any, strength: Any, spacing_mm: Any, error_deg: float) -> Field:
    field = Field(axes, vectors, strength=strength, spacing_mm=spacing_mm)
    field.error_deg = error_deg
    return field


def _along(
    axis: FloatArray, cell: npt.NDArray[np.intp], t: FloatArray
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], FloatArray]:
    """The points of the axis on both sides of places, and the places: ``t`` of the way through their cells."""
    after = np.minimum(cell + 1, len(axis) - 1)
    return cell, after, axis[cell] + (axis[after] - axis[cell]) * t


def _bilinear(u: FloatArray, v: FloatArray) -> tuple[FloatArray, ...]:
    """Shares of the corners of a cell at a place in it: (0, 0), (1, 0), (0, 1), (1, 1)."""
    return (1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v


def _rising(u: FloatArray, v: FloatArray) -> tuple[FloatArray, ...]:
    """As :func:`_bilinear`, in the triangles on both sides of the diagonal from (0, 0) to (1, 1)."""
    return 1 - np.maximum(u, v), np.maximum(u - v, 0), np.maximum(v - u, 0), np.minimum(u, v)


def _falling(u: FloatArray, v: FloatArray) -> tuple[FloatArray, ...]:
    """As :func:`_bilinear`, in the triangles on both sides of the diagonal from (1, 0) to (0, 1)."""
    beyond = np.maximum(u + v - 1, 0)
    return np.maximum(1 - u - v, 0), u - beyond, v - beyond, beyond


def _of_angles(angles: FloatArray) -> FloatArray:
    # The cosine of an infinite angle is NaN, which is no direction.
    with np.errstate(invalid="ignore"):
        return np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def _double(vectors: FloatArray) -> npt.NDArray[np.complex128]:
    """Vectors of the doubled angle, which have no sign, as complex numbers of length 1."""
    v = vectors[..., 0] + 1j * vectors[..., 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        double: npt.NDArray[np.complex128] = np.asarray((v / np.abs(v)) ** 2, dtype=np.complex128)
    return double


def _called(function: Function, points: FloatArray) -> FloatArray:
    """What a user's function says at points, as vectors."""
    parts = []
    for first in range(0, len(points), BATCH):
        batch = points[first : first + BATCH]
        found = plain(function(batch), "what the function returned")
        if found.dtype.kind not in "fiu":
            raise InputError(f"the function returned the type {found.dtype}; numbers are needed")
        found = found.astype(np.float64)
        if found.shape == (len(batch),):
            found = _of_angles(found)
        elif found.ndim != 2 or len(found) != len(batch) or found.shape[1] not in (2, 3):
            raise InputError(
                f"the function returned the shape {found.shape} for {len(batch)} points; an angle ({len(batch)},) or a "
                f"vector ({len(batch)}, 2) for each is needed"
            )
        parts.append(_handy(found))
    return np.concatenate(parts)


def _count(shape: Iterable[float]) -> None:
    """Refuses a grid that is too large, before it is made."""
    n = math.prod(shape)
    if n > MAX_POINTS:
        raise InputError(f"a grid of {n:.0f} points; at most {MAX_POINTS} are read, so take larger steps")


def _handy(vectors: FloatArray) -> FloatArray:
    """Vectors whose squares are in the range of numbers: only their direction counts. Steps of 2 change no digit."""
    _, exponent = np.frexp(np.abs(vectors).max(axis=-1, keepdims=True))
    return np.asarray(np.ldexp(vectors, np.where(np.abs(exponent) > 400, -exponent, 0)))
