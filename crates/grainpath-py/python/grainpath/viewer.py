"""The studio's view of a program in notebooks: beads in three dimensions. It needs the package anywidget."""

from __future__ import annotations

import pathlib
from typing import TYPE_CHECKING, Any

import anywidget
import numpy as np
import traitlets

from ._checks import whole
from .errors import InputError
from .records import Records

if TYPE_CHECKING:
    from ._checks import FloatArray
    from .gcode import Program

#: What colours can show: as for ``Program.render``, and the direction of beads in the plane, flow, height and seams.
#: ``direction`` is the angle to what the guide of a plan asks for.
COLORS = ("role", "speed", "width", "angle", "flow", "height", "seam", "direction")


class Viewer(anywidget.AnyWidget):
    """Beads of a program in three dimensions, as the studio shows them; :meth:`grainpath.Plan.view` makes it.

    Drag to turn the view, click it and scroll to zoom. The slider has two ends, the lowest and the highest layer shown.
    Keys are those of the studio: A, D, W and S turn (with shift they move), + and - zoom, 1 to 4 choose the side, arrow keys
    up and down and the page keys move the ends of the slider, L shows one layer alone, C takes the next colours, and T
    shows travels. What is chosen comes back to :attr:`color` and :attr:`layers`, and what is set there is shown.

    >>> import grainpath as gp
    >>> viewer = gp.Job(gp.box(20, 10, 1)).plan().view(color="width")
    >>> viewer.layers
    (0, 4)
    >>> viewer.layers = (2, 2)
    """

    _esm = pathlib.Path(__file__).with_name("viewer.js")
    _index = traitlets.Dict().tag(sync=True)
    _records = traitlets.Bytes().tag(sync=True)
    _angles = traitlets.Bytes().tag(sync=True)
    #: What colours show, one of :data:`COLORS`.
    color = traitlets.Unicode("role").tag(sync=True)
    #: The lowest and the highest layer shown, from 0.
    layers = traitlets.Tuple(traitlets.Int(), traitlets.Int()).tag(sync=True)
    #: Height of the view, pixels; it is as wide as its cell.
    height_px = traitlets.Int(480).tag(sync=True)

    def __init__(
        self,
        program: Program,
        angles_deg: FloatArray | None = None,
        *,
        color: str = "role",
        layers: tuple[int, int] | None = None,
        height_px: int = 480,
    ) -> None:
        records = Records(program)
        last = len(records.index["layers"]) - 1
        if layers is not None and not (isinstance(layers, (tuple, list)) and len(layers) == 2):
            raise InputError(f"layers = {layers!r}; the lowest and the highest layer shown are needed")
        if not isinstance(color, str):
            raise InputError(f"color = {color!r} should be one of {', '.join(COLORS)}")
        super().__init__(
            _index=records.index,
            _records=records.rows.tobytes(),
            _angles=b"" if angles_deg is None else records.angles(angles_deg),
            layers=(0, last) if layers is None else tuple(whole(k, "layers") for k in layers),
            color=color,
            height_px=whole(height_px, "height_px"),
        )

    @traitlets.validate("layers")
    def _within(self, proposal: Any) -> tuple[int, int]:
        low, high = proposal["value"]
        last = len(self._index["layers"]) - 1
        if not 0 <= low <= high <= last:
            raise InputError(f"layers = ({low}, {high}) should be two of 0 to {last}, the lower first")
        return low, high

    @traitlets.validate("color")
    def _known(self, proposal: Any) -> str:
        color: str = proposal["value"]
        if color not in COLORS:
            raise InputError(f"color = {color!r} should be one of {', '.join(COLORS)}")
        if color == "direction" and not self._angles:
            raise InputError("color = 'direction' needs a plan whose guide asks for directions: stress, grain or a field")
        return color

    @traitlets.validate("height_px")
    def _tall(self, proposal: Any) -> int:
        height: int = proposal["value"]
        if not 100 <= height <= 4000:
            raise InputError(f"height_px = {height} should be from 100 to 4000 pixels")
        return height

    def __repr__(self) -> str:
        low, high = self.layers
        return f"<grainpath.viewer.Viewer: layers {low} to {high} of {len(self._index['layers'])} by {self.color}>"
