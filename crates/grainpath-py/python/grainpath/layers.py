"""Parts as sections: layers in and out as rings."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from . import _grainpath
from ._checks import FloatArray, floats, read_only
from .errors import InputError

#: The rule by which rings become an area.
RULES = ("even-odd", "non-zero")


class Section:
    """The section of one layer: polygons, each an outer ring and its holes."""

    def __init__(self, stack: LayerStack, k: int) -> None:
        z, height = stack._heights[k]
        #: Height of the layer's top above the plate, mm.
        self.z_top_mm = float(z)
        #: Thickness, mm.
        self.height_mm = float(height)
        #: Area, mm2.
        self.area_mm2 = float(stack.areas_mm2[k])
        #: For each polygon its outer ring, counter-clockwise, and its holes: ``(n, 2)``, mm, read-only. The last point joins
        #: the first.
        self.polygons: list[list[FloatArray]] = [
            [read_only(ring) for ring in polygon] for polygon in stack._data.section(k)
        ]

    @property
    def rings(self) -> list[FloatArray]:
        """All rings, one after the other."""
        return [ring for polygon in self.polygons for ring in polygon]

    def __repr__(self) -> str:
        n = len(self.polygons)
        return f"<grainpath.Section: {n} polygons, {self.area_mm2:.6g} mm2, to {self.z_top_mm:.6g} mm>"

    def _repr_svg_(self) -> str:
        return svg(self.rings)


class LayerStack(Sequence[Section]):
    """A part as sections with heights, lowest first: what a mesh or a scan becomes before it is filled, and what a part
    may be given as.

    ``sections`` are the rings of each layer, ``(n, 2)``, mm, in any order and direction; they may cross and overlap, and
    ``rule`` says which points are inside: around which an odd number of rings run (``even-odd``), or any (``non-zero``).
    Polygons with holes, as :attr:`Section.polygons` has them, do as well. A section is that of the middle of its layer.
    ``height_mm`` is one thickness for all, or one for each. Coordinates go to a grid of 0.1 micrometres.

    >>> import numpy as np, grainpath as gp
    >>> turn = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    >>> circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    >>> cup = gp.LayerStack([[20 * circle]] * 3 + [[20 * circle, 17 * circle]] * 7, height_mm=0.2)
    >>> cup
    <grainpath.LayerStack: 10 layers to 2 mm>
    >>> len(gp.Job(cup).plan().layers), gp.LayerStack.from_bytes(cup.to_bytes()) == cup
    (10, True)
    """

    _data: _grainpath.StackData

    def __init__(
        self,
        sections: Sequence[Sequence[Any]],
        *,
        height_mm: float | Sequence[float] | npt.NDArray[Any],
        rule: str = "even-odd",
    ) -> None:
        if rule not in RULES:
            raise InputError(f"rule = {rule!r} should be one of {', '.join(RULES)}")
        if not hasattr(sections, "__len__"):
            raise InputError(f"sections is a {type(sections).__name__}; a list with the rings of each layer is needed")
        n = len(sections)
        thick = floats(np.full(n, height_mm) if np.ndim(height_mm) == 0 else height_mm, "height_mm", (n,))
        if (thick <= 0).any():
            raise InputError(f"height_mm[{int(np.argmax(thick <= 0))}] should be above 0")
        rings: list[FloatArray] = []
        counts: list[list[int]] = []
        for k, section in enumerate(sections):
            if not hasattr(section, "__len__"):
                raise InputError(f"sections[{k}] is a {type(section).__name__}; a list of rings is needed")
            own = [floats(r, f"sections[{k}][{i}]", (None, 2)) for i, r in enumerate(_flat(section))]
            rings += own
            counts.append([len(r) for r in own])
        points = np.concatenate(rings) if rings else np.empty((0, 2))
        if points.size and np.abs(points).max() > 1e5:
            raise InputError("rings reach beyond 100 m; mm are needed")
        heights = np.stack([np.cumsum(thick), thick], axis=1).reshape(-1)
        points = np.ascontiguousarray(points)
        self._data = _grainpath.stack_from_rings(heights, points, counts, rule == "even-odd")

    @classmethod
    def _of(cls, data: _grainpath.StackData) -> LayerStack:
        stack = cls.__new__(cls)
        stack._data = data
        return stack

    @classmethod
    def from_bytes(cls, data: bytes) -> LayerStack:
        """The stack in bytes of :meth:`to_bytes`."""
        try:
            given = memoryview(data).tobytes()
        except TypeError as error:
            raise InputError(f"data is a {type(data).__name__}; bytes of LayerStack.to_bytes are needed") from error
        return cls._of(_grainpath.stack_from_bytes(given))

    def to_bytes(self) -> bytes:
        """The stack as bytes: compact, exact, and the same for the same stack on any machine."""
        return self._data.to_bytes()

    @cached_property
    def _heights(self) -> FloatArray:
        return read_only(self._data.heights()).reshape(-1, 2)

    @property
    def z_top_mm(self) -> FloatArray:
        """Height of the top of each layer above the plate."""
        return self._heights[:, 0]

    @property
    def height_mm(self) -> FloatArray:
        """Thickness of each layer."""
        return self._heights[:, 1]

    @cached_property
    def areas_mm2(self) -> FloatArray:
        """Area of each section."""
        return read_only(self._data.areas())

    @property
    def volume_mm3(self) -> float:
        """The sum of area times thickness."""
        return float(self.areas_mm2 @ self.height_mm)

    def __len__(self) -> int:
        return len(self._heights)

    @overload
    def __getitem__(self, k: int) -> Section: ...
    @overload
    def __getitem__(self, k: slice) -> list[Section]: ...
    def __getitem__(self, k: int | slice) -> Section | list[Section]:
        if isinstance(k, slice):
            return [Section(self, i) for i in range(*k.indices(len(self)))]
        return Section(self, range(len(self))[k])

    def __iter__(self) -> Iterator[Section]:
        return (self[k] for k in range(len(self)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, LayerStack):
            return NotImplemented
        return self.to_bytes() == other.to_bytes()

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return LayerStack.from_bytes, (self.to_bytes(),)

    def __repr__(self) -> str:
        z = self._heights[-1, 0] if len(self) else 0.0
        return f"<grainpath.LayerStack: {len(self)} layers to {z:.6g} mm>"

    def _repr_html_(self) -> str:
        rows = [("layers", str(len(self))), ("volume", f"{self.volume_mm3:.6g} mm³")]
        if len(self):
            rows.insert(1, ("height", f"{self.z_top_mm[-1]:.6g} mm"))
        drawn = svg(self[len(self) // 2].rings) if len(self) else ""
        return table("LayerStack", rows) + drawn


def _flat(section: Any) -> list[Any]:
    """The rings of a section: of rings, or of polygons that are lists of rings."""
    rings: list[Any] = []
    for entry in section:
        # A ring has rows of two numbers, and a polygon has rings.
        if isinstance(entry, (list, tuple)) and len(entry) and np.ndim(entry[0]) == 2:
            rings += list(entry)
        else:
            rings.append(entry)
    return rings


def svg(rings: Sequence[FloatArray], width: int = 320) -> str:
    """Rings as a drawing, with Y upwards."""
    used = [ring for ring in rings if len(ring)]
    if not used:
        return ""
    points = np.concatenate(used)
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.maximum(high - low, 1e-6)
    steps = " ".join(
        "M" + "L".join(f"{x - low[0]:.4g} {high[1] - y:.4g}" for x, y in ring.tolist()) + "Z" for ring in used
    )
    box = f"{-0.02 * size[0]:.4g} {-0.02 * size[1]:.4g} {1.04 * size[0]:.4g} {1.04 * size[1]:.4g}"
    height = min(width, width * size[1] / size[0])
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="{width}" height="{height:.0f}">'
        f'<path d="{steps}" fill="#8aa9c8" stroke="#24435f" stroke-width="{0.004 * size.max():.4g}" '
        'fill-rule="evenodd"/></svg>'
    )


def table(caption: str, rows: Sequence[tuple[str, object]]) -> str:
    """Names and values as a table of HTML."""
    cells = "".join(
        f"<tr><th>{html.escape(name)}</th><td>{html.escape(str(value))}</td></tr>" for name, value in rows
    )
    return f"<table><caption>{html.escape(caption)}</caption>{cells}</table>"
