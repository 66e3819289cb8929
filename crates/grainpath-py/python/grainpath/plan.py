"""Plans: paths, G-code and measurements."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

from . import _grainpath
from ._checks import FloatArray, read_only, watch
from .gcode import ROLES, loads, viewer_class
from .layers import LayerStack, table
from .mesh import Mesh
from .pictures import slider
from .report import Report
from .strength import Strength
from .stress import StressCase, StressResult
from .warning import Warning, warnings_of

if TYPE_CHECKING:
    from .job import Cancel, Job, Progress
    from .viewer import Viewer

#: A path of a layer: its vertices are ``points[first:first + count]``; ``role`` is an index of ``grainpath.gcode.ROLES``,
#: ``speed`` one of :data:`SPEEDS`; ``retract`` says whether filament is retracted on the way to it.
PATH = np.dtype(
    {
        "names": ["first", "count", "role", "speed", "closed", "retract", "rank", "flow", "length_mm"],
        "formats": ["u4", "u4", "u1", "u1", "?", "?", "u1", "f8", "f8"],
        "offsets": [0, 4, 8, 9, 10, 11, 12, 16, 24],
        "itemsize": 32,
    }
)
#: Classes of speed, by number.
SPEEDS = ("normal", "small wall", "overhang", "bridge")


class Path:
    """One bead of a layer: views of the layer's arrays."""

    def __init__(self, layer: Layer, k: int) -> None:
        self._row = layer.paths[k]
        every = slice(int(self._row["first"]), int(self._row["first"]) + int(self._row["count"]))
        #: The middle of the bead, ``(n, 2)``, mm, in part coordinates. A closed path does not repeat its first point.
        self.points: FloatArray = layer.points[every]
        #: Width at each point, mm.
        self.widths_mm: FloatArray = layer.widths_mm[every]

    @property
    def role(self) -> str:
        """The purpose of the bead, as programs name it after ``;TYPE:``."""
        return ROLES[int(self._row["role"])]

    @property
    def closed(self) -> bool:
        """Whether the last point joins the first."""
        return bool(self._row["closed"])

    @property
    def length_mm(self) -> float:
        """Length of the middle."""
        return float(self._row["length_mm"])

    def __repr__(self) -> str:
        kind = "closed" if self.closed else "open"
        return f"<grainpath.Path: {self.role}, {kind}, {len(self.points)} points, {self.length_mm:.1f} mm>"


class Layer(Sequence[Path]):
    """The paths of a layer, in printing order. Arrays are read-only and live as long as they are used."""

    def __init__(self, plan: Plan, k: int) -> None:
        z, height = plan._heights[k]
        #: Height of the nozzle above the plate.
        self.z_top_mm = float(z)
        #: Thickness.
        self.height_mm = float(height)
        vertices, paths = plan._layer(k)
        #: All vertices, ``(n, 2)``, mm, in part coordinates.
        self.points: FloatArray = vertices[:, :2]
        #: Width of the bead at each vertex, mm.
        self.widths_mm: FloatArray = vertices[:, 2]
        #: The paths, a structured array of ``grainpath.plan.PATH``.
        self.paths: npt.NDArray[np.void] = paths

    def __len__(self) -> int:
        return len(self.paths)

    @overload
    def __getitem__(self, k: int) -> Path: ...
    @overload
    def __getitem__(self, k: slice) -> list[Path]: ...
    def __getitem__(self, k: int | slice) -> Path | list[Path]:
        if isinstance(k, slice):
            return [Path(self, i) for i in range(*k.indices(len(self)))]
        return Path(self, range(len(self))[k])

    def __repr__(self) -> str:
        return f"<grainpath.Layer: {len(self)} paths at {self.z_top_mm:.6g} mm>"


class Layers(Sequence[Layer]):
    """The layers of a plan, lowest first; each is read when it is asked for."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan

    def __len__(self) -> int:
        return len(self._plan._heights)

    @overload
    def __getitem__(self, k: int) -> Layer: ...
    @overload
    def __getitem__(self, k: slice) -> list[Layer]: ...
    def __getitem__(self, k: int | slice) -> Layer | list[Layer]:
        if isinstance(k, slice):
            return [Layer(self._plan, i) for i in range(*k.indices(len(self)))]
        return Layer(self._plan, range(len(self))[k])

    def __iter__(self) -> Iterator[Layer]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        return f"<grainpath.Layers: {len(self)}>"


class Plan:
    """A planned job. Pickled, it is its job, which is planned again when it is loaded.

    >>> import grainpath as gp
    >>> plan = gp.Job(gp.box(20, 10, 1)).plan()
    >>> plan.layers[0]
    <grainpath.Layer: 4 paths at 0.2 mm>
    >>> plan.layers[0][0].role
    'Skirt'
    >>> round(plan.report["mass_g"], 2)
    0.26
    """

    _data: _grainpath.PlanData
    _job: Job

    @classmethod
    def _of(cls, job: Job, data: _grainpath.PlanData) -> Plan:
        plan = cls.__new__(cls)
        plan._job, plan._data = job, data
        return plan

    @cached_property
    def _heights(self) -> FloatArray:
        return read_only(self._data.heights()).reshape(-1, 2)

    def _layer(self, k: int) -> tuple[FloatArray, npt.NDArray[np.void]]:
        vertices, paths = self._data.layer(k)
        return read_only(vertices), read_only(paths.view(PATH))

    @property
    def job(self) -> Job:
        """The job that was planned."""
        return self._job

    @property
    def layers(self) -> Layers:
        """The layers, lowest first."""
        return Layers(self)

    @property
    def sections(self) -> list[list[list[FloatArray]]]:
        """The part's section of each layer: polygons, each an outer ring and its holes, ``(n, 2)``, mm."""
        return [section.polygons for section in self.stack]

    @cached_property
    def stack(self) -> LayerStack:
        """The sections with their heights, exact to the bit: a job of it has the same plan."""
        return LayerStack._of(self._data.stack())

    @property
    def plate_from_part_mm(self) -> FloatArray:
        """Where the part's origin stands on the plate."""
        return np.array(self._data.plate_from_part_mm())

    @property
    def warnings(self) -> list[Warning]:
        """Warnings of planning. The report has those of writing and measuring too."""
        return warnings_of(self._data.warnings())

    @cached_property
    def stress(self) -> StressResult | None:
        """The stress under the job's loads; ``None`` for jobs without a stress analysis."""
        cases = [StressCase(data) for data in self._data.stress()]
        return StressResult(cases) if cases else None

    def support_mesh(self) -> Mesh | None:
        """The surface of the supports; ``None`` where the job has none, and where nothing hangs over.

        >>> import grainpath as gp
        >>> gp.Job(gp.box(20, 10, 3), support__style="tree").plan().support_mesh() is None
        True
        """
        data = self._data.support()
        return None if data is None else Mesh._of(data)

    def strength(
        self, *, progress: Progress | None = None, cancel: Cancel | None = None
    ) -> Strength:
        """Tests the part until it breaks; the job needs fixtures and loads. See :class:`Strength`."""
        return self._job.strength(progress=progress, cancel=cancel)

    def to_gcode(self) -> bytes:
        """The program, byte for byte what ``grainpath run`` writes."""
        return self._data.gcode()

    def view(
        self, *, color: str = "role", layers: tuple[int, int] | None = None, height_px: int = 480
    ) -> Viewer:
        """The beads of the program in three dimensions, in a notebook; see :class:`grainpath.viewer.Viewer`.

        ``color`` is role, speed, width, angle, flow, height, seam, or direction: the angle to what the guide asks for, where
        it is stress, grain or a field. ``layers`` are the lowest and the highest layer shown, from 0. It needs anywidget:
        ``pip install "grainpath[notebook]"``.

        >>> import grainpath as gp
        >>> gp.Job(gp.box(20, 10, 1)).plan().view().layers
        (0, 4)
        """
        viewer, program = viewer_class(), loads(self.to_gcode(), filament_mm=self._data.filament_mm())
        angles = program._data.angles(self._data)
        return viewer(program, angles, color=color, layers=layers, height_px=height_px)

    @cached_property
    def report(self) -> Report:
        """Everything measured, as ``grainpath run --json`` prints it. Measured on the program, at the first use."""
        return self.measure()

    def measure(self, *, progress: Progress | None = None, cancel: Cancel | None = None) -> Report:
        """The report, with progress and a token to cancel; see :meth:`Job.plan`."""
        watch(progress, cancel)
        return Report("Report", json.loads(self._data.report(progress, cancel)))

    def __reduce__(self) -> tuple[Any, ...]:
        # A plan is a function of its job, and its arrays are larger than what they are made of.
        return _again, (self._job,)

    def __repr__(self) -> str:
        z = self._heights[-1, 0] if len(self._heights) else 0.0
        return f"<grainpath.Plan: {len(self.layers)} layers to {z:.6g} mm>"

    def _repr_html_(self) -> str:
        report = self.report
        rows = [
            ("layers", report["layers"]),
            ("height", f"{report['z_max_mm']:.6g} mm"),
            ("mass", f"{report['mass_g']:.3g} g"),
            ("time", f"{report['time_s'] / 60:.1f} min"),
            ("warnings", len(report["warnings"])),
        ]
        return table("Plan", rows) + slider(self)


def _again(job: Job) -> Plan:
    return job.plan()
