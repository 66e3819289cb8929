"""Files."""

from __future__ import annotations

import os

from .gcode import Program
from .gcode import read as read_gcode
from .mesh import Mesh, read_mesh
from .volume import Volume

#: Endings of programs.
PROGRAMS = (".gcode", ".g", ".gco", ".nc", ".bgcode")


def read(path: str | os.PathLike[str]) -> Mesh | Program | Volume:
    """Reads a file: a mesh (STL, OBJ, PLY, OFF, 3MF), a program by its ending (.gcode, .g, .gco, .nc), or a scan in a
    folder that ends in .zarr, see :func:`grainpath.read_zarr`.

    Other scans, drawings, photographs and results of finite elements are named in the job: ``Job(shape__ct__path="scan/")``.
    """
    if os.fspath(path).rstrip("/\\").lower().endswith(".zarr"):
        from .omezarr import read_zarr

        return read_zarr(path)
    if os.fspath(path).lower().endswith(PROGRAMS):
        return read_gcode(path)
    return read_mesh(path)
