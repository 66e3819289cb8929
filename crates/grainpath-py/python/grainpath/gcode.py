"""G-code of any slicer as arrays."""

from __future__ import annotations

import json
import os
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _grainpath
from ._checks import FloatArray, name_of, number, read_only, watch, whole, whole_text
from .errors import InputError
from .layers import table
from .warning import Warning, warnings_of

if TYPE_CHECKING:
    from .job import Cancel, Job, Progress
    from .plan import Plan
    from .strength import Strength
    from .viewer import Viewer

#: Names of roles by number, as programs have them after ``;TYPE:``.
ROLES: tuple[str, ...] = tuple(_grainpath.roles())

#: A straight piece of bead: ends in machine coordinates, layer from 0, role as an index of :data:`ROLES`, and whether a
#: path begins here.
BEAD = np.dtype(
    {
        "names": ["start", "end", "width_mm", "volume_mm3", "speed_mm_s", "layer", "role", "begins"],
        "formats": [("f4", 2), ("f4", 2), "f4", "f4", "f4", "u4", "u1", "?"],
        "offsets": [0, 8, 16, 20, 24, 28, 32, 33],
        "itemsize": 36,
    }
)

#: A straight move in plan that prints nothing.
TRAVEL = np.dtype([("start", "f4", 2), ("end", "f4", 2), ("layer", "u4")])


class Program:
    """A program that was replayed, line by line.

    >>> import grainpath as gp
    >>> program = gp.gcode.loads(gp.Job(gp.box(20, 10, 1)).plan().to_gcode())
    >>> len(program.z_mm), program.beads.dtype.names[:3]
    (5, ('start', 'end', 'width_mm'))
    """

    _data: _grainpath.ProgramData
    _source: tuple[bytes, str, float]

    def __init__(self, text: bytes, *, name: str = "program", filament_mm: float = 1.75) -> None:
        filament_mm = number(filament_mm, "filament_mm")
        if not 0.01 <= filament_mm <= 10.0:
            raise InputError(f"filament_mm = {filament_mm} should be from 0.01 to 10")
        self._source = (text, name, filament_mm)
        self._data = _grainpath.program_from_bytes(text, name, filament_mm)

    @cached_property
    def _heights(self) -> FloatArray:
        return read_only(self._data.heights()).reshape(-1, 2)

    @property
    def z_mm(self) -> FloatArray:
        """Height of the nozzle in each layer."""
        return self._heights[:, 0]

    @property
    def height_mm(self) -> FloatArray:
        """Distance of each layer to the one below."""
        return self._heights[:, 1]

    @cached_property
    def beads(self) -> npt.NDArray[np.void]:
        """All beads in printing order, a structured array of :data:`BEAD`, read-only."""
        return read_only(self._data.beads().view(BEAD))

    @cached_property
    def travels(self) -> npt.NDArray[np.void]:
        """All travels in order, a structured array of :data:`TRAVEL`, read-only."""
        return read_only(self._data.travels().view(TRAVEL))

    @cached_property
    def summary(self) -> dict[str, Any]:
        """What was counted: lengths, filament, time, temperatures, the slicer's name."""
        found: dict[str, Any] = json.loads(self._data.summary())
        found.pop("warnings")
        return found

    @property
    def warnings(self) -> list[Warning]:
        """Lines that could not be read, and what was assumed."""
        return warnings_of(json.loads(self._data.summary())["warnings"])

    def strength(
        self, job: Job, *, progress: Progress | None = None, cancel: Cancel | None = None
    ) -> Strength:
        """Tests the printed part until it breaks. ``job`` has the part, its loads and its material."""
        watch(progress, cancel)
        text, name, _ = self._source
        return job._strength_of(text, name, (None, progress, cancel))

    def render(
        self,
        layer: int | None = None,
        *,
        color: str = "role",
        size: int = 1600,
        travels: bool = True,
        svg: bool = False,
        plan: Plan | None = None,
    ) -> bytes:
        """A picture of a layer, counted from 0, as PNG or SVG; without ``layer`` the whole part as PNG.

        ``color`` is role, width, speed or direction, which is the angle to what the guide of ``plan`` asks for.

        >>> import grainpath as gp
        >>> plan = gp.Job(gp.box(20, 10, 1)).plan()
        >>> gp.gcode.loads(plan.to_gcode()).render(0)[1:4]
        b'PNG'
        """
        if not isinstance(color, str) or color not in ("role", "width", "speed", "direction"):
            raise InputError(f"color = {color!r} should be role, width, speed or direction")
        if (color == "direction") != (plan is not None):
            raise InputError("color = 'direction' needs plan=, whose guide asks for directions, and only it does")
        size = whole(size, "size")
        if not 16 <= size <= 20000:
            raise InputError(f"size = {size} should be from 16 to 20000 pixels")
        n = len(self.z_mm)
        if n == 0:
            raise InputError("nothing is printed in the program")
        if layer is not None and not -n <= whole(layer, "layer") < n:
            raise InputError(f"layer = {layer} should be from 0 to {n - 1}")
        k = None if layer is None else layer % n
        data = None if plan is None else plan._data
        return bytes(self._data.render(k, color, size, travels, svg, data))

    def view(
        self, *, color: str = "role", layers: tuple[int, int] | None = None, height_px: int = 480
    ) -> Viewer:
        """The beads in three dimensions, in a notebook; see :class:`grainpath.viewer.Viewer`.

        ``color`` is role, speed, width, angle, flow, height or seam; ``layers`` are the lowest and the highest layer shown,
        from 0. It needs anywidget: ``pip install "grainpath[notebook]"``.

        >>> import grainpath as gp
        >>> gp.gcode.loads(gp.Job(gp.box(20, 10, 1)).plan().to_gcode()).view(layers=(1, 3)).color
        'role'
        """
        return viewer_class()(self, color=color, layers=layers, height_px=height_px)

    def __repr__(self) -> str:
        s = self.summary
        return f"<grainpath.gcode.Program: {s['layers']} layers, {s['printed_mm']:.0f} mm printed>"

    def _repr_html_(self) -> str:
        s = self.summary
        rows = [
            ("slicer", s["generator"] or "not stated"),
            ("layers", s["layers"]),
            ("printed", f"{s['printed_mm']:.0f} mm, {s['extruded_mm3']:.4g} mm³"),
            ("time", f"{s['time_s'] / 60:.1f} min"),
            ("warnings", len(self.warnings)),
        ]
        return table("Program", rows)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, self._source


def viewer_class() -> type[Viewer]:
    """The class of the viewer, whose packages few need."""
    try:
        from .viewer import Viewer
    except ImportError as error:
        raise ImportError(
            f'the viewer of notebooks needs anywidget ({error.name} is missing): pip install "grainpath[notebook]"'
        ) from error
    return Viewer


def _again(text: bytes, name: str, filament_mm: float) -> Program:
    return Program(text, name=name, filament_mm=filament_mm)


def read(path: str | os.PathLike[str], *, filament_mm: float = 1.75) -> Program:
    """Reads a program. ``filament_mm`` is the diameter of its filament."""
    name = name_of(path)
    try:
        with open(name, "rb") as file:
            text = file.read()
    except OSError as error:
        raise InputError(f"{name}: {(error.strerror or str(error)).lower()}", name) from error
    return Program(text, name=name, filament_mm=filament_mm)


def loads(text: bytes | str, *, filament_mm: float = 1.75) -> Program:
    """A program in memory."""
    if not isinstance(text, (str, bytes, bytearray, memoryview)):
        raise InputError(f"text is a {type(text).__name__}; bytes or a str are needed; files are read by grainpath.gcode.read")
    if isinstance(text, str):
        whole_text(text, "text")
        text = text.encode()
    return Program(bytes(text), filament_mm=filament_mm)
