"""Files."""

from __future__ import annotations

import os
from typing import Any

from ._checks import name_of
from .gcode import read as read_gcode
from .mesh import read_mesh

#: Endings of programs.
PROGRAMS = (".gcode", ".g", ".gco", ".nc", ".bgcode")


def read(path: str | os.PathLike[str]) -> Any:
    """Reads a file: a mesh (STL, OBJ, PLY, OFF, 3MF), a program by its ending (.gcode, .g, .gco, .nc), or a scan in a
    folder that ends in .zarr, see :func:`grainpath.read_zarr`.

    Type checkers are told nothing of what it is, so that it may stand wherever one of these is needed; ``gp.gcode.read`` and
    ``gp.read_zarr`` say it.

    Other scans, drawings, photographs and results of finite elements are named in the job: ``Job(shape__ct__path="scan/")``.
    """
    name = name_of(path).lower()
    if name.rstrip("/\\").endswith(".zarr"):
        from .omezarr import read_zarr

        return read_zarr(path)
    if name.endswith(PROGRAMS):
        return read_gcode(path)
    return read_mesh(path)
