"""Triangle meshes."""

from __future__ import annotations

import json
import os
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _grainpath
from ._checks import FloatArray, floats, name_of, plain, read_only
from .errors import InputError
from .layers import table
from .warning import Warning, warnings_of

#: Millimetres of each unit of length.
UNITS_MM = {"um": 1e-3, "mm": 1.0, "cm": 10.0, "inch": 25.4, "ft": 304.8, "m": 1000.0}


class Mesh:
    """A triangle mesh: vertices ``(n, 3)`` and faces ``(m, 3)``.

    The arrays are copied once, whatever their type, byte order or strides, and cannot be changed afterwards.

    >>> import grainpath as gp
    >>> corner = gp.Mesh([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> round(corner.volume_mm3, 3)
    166.667
    """

    _data: _grainpath.MeshData

    def __init__(self, vertices: npt.ArrayLike, faces: npt.ArrayLike, *, unit: str = "mm") -> None:
        if not isinstance(unit, str) or unit not in UNITS_MM:
            raise InputError(f"unit = {unit!r} should be one of {', '.join(UNITS_MM)}")
        points = floats(vertices, "vertices", (None, 3))
        corners = plain(faces, "faces")
        if corners.ndim != 2 or corners.shape[1] != 3:
            raise InputError(f"faces has the shape {corners.shape}; (n, 3) is needed, a row a triangle")
        if corners.dtype.kind not in "iu":
            raise InputError(f"faces has the type {corners.dtype}; integers are needed")
        if len(corners) == 0:
            raise InputError("faces is empty; a mesh needs triangles")
        outside = (corners < 0) | (corners >= len(points))
        if outside.any():
            k, i = (int(v) for v in np.argwhere(outside)[0])
            raise InputError(
                f"faces[{k}, {i}] is {corners[k, i]}; vertices are counted from 0 to {len(points) - 1}"
            )
        if len(points) > 2**32 - 1:
            raise InputError(f"{len(points)} vertices; at most {2**32 - 1} are handled")
        corners = np.require(corners, np.uint32, ["C", "A"])
        nothing = np.empty((0, 3)), np.empty((0, 3), np.uint32)
        self._data = _grainpath.mesh_from_parts(UNITS_MM[unit], [(None, (points, corners), nothing, nothing)], [], "[]")

    @classmethod
    def _of(cls, data: _grainpath.MeshData) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._data = data
        return mesh

    @cached_property
    def vertices(self) -> FloatArray:
        """Vertices of all bodies in the mesh's unit, ``(n, 3)``, read-only."""
        return read_only(self._data.vertices())

    @cached_property
    def faces(self) -> npt.NDArray[np.uint32]:
        """Vertices of each triangle, ``(m, 3)``, counter-clockwise seen from outside, read-only."""
        return read_only(self._data.faces())

    @property
    def bodies(self) -> list[tuple[str | None, int, int]]:
        """For each body its name, and its numbers of vertices and faces, which follow each other in the arrays."""
        return self._data.bodies()

    @property
    def unit_mm(self) -> float | None:
        """Millimetres of the mesh's unit; ``None`` for files that state none, which are taken for mm."""
        return self._data.unit_mm()

    @property
    def warnings(self) -> list[Warning]:
        """What was noticed in the file."""
        return warnings_of(self._data.warnings())

    @property
    def bounds_mm(self) -> FloatArray:
        """Lowest and highest corner, ``(2, 3)``, mm."""
        used = self.vertices[np.unique(self.faces)] * (self.unit_mm or 1.0)
        return np.stack([used.min(axis=0), used.max(axis=0)])

    @property
    def volume_mm3(self) -> float:
        """Volume, mm3; negative for a mesh that is wound inside out."""
        return self._data.volume() * (self.unit_mm or 1.0) ** 3

    def named_faces(self) -> list[dict[str, Any]]:
        """The 200 largest faces (planes, cylinders, cones, spheres and free surfaces), largest first, with names that survive
        another export of the part.

        Fixtures and loads take them: ``on = { face = "f:..." }``. Lengths are mm. A face is ``doubtful`` if another is so
        alike that the name finds neither.

        >>> import grainpath as gp
        >>> top = max(gp.box(20, 10, 5).named_faces(), key=lambda face: face["centre_mm"][2])
        >>> top["kind"], top["area_mm2"], top["normal"]
        ('plane', 200.0, [0.0, 0.0, 1.0])
        """
        found: list[dict[str, Any]] = json.loads(self._data.named_faces())
        return found

    def __repr__(self) -> str:
        size = np.ptp(self.bounds_mm, axis=0)
        shown = " x ".join(f"{s:.6g}" for s in size)
        return f"<grainpath.Mesh: {len(self.faces)} triangles, {len(self.bodies)} bodies, {shown} mm>"

    def _repr_html_(self) -> str:
        size = np.ptp(self.bounds_mm, axis=0)
        rows = [
            ("triangles", len(self.faces)),
            ("bodies", len(self.bodies)),
            ("size", " x ".join(f"{s:.6g}" for s in size) + " mm"),
            ("volume", f"{self.volume_mm3:.6g} mm³"),
        ]
        return table("Mesh", rows)

    def _parts(self) -> tuple[list[Any], list[npt.NDArray[Any]]]:
        """All that the mesh is: its unit, names and settings, and its arrays with what was painted on it."""
        unit_mm, bodies, modifiers, _ = self._data.parts()
        words = [unit_mm, [name for name, *_ in bodies], [(name, settings) for name, _, settings in modifiers]]
        surfaces = [surface for _, *all in bodies for surface in all] + [surface for _, surface, _ in modifiers]
        return words, [array for surface in surfaces for array in surface]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        (words, arrays), (words_of_other, arrays_of_other) = self._parts(), other._parts()
        return words == words_of_other and all(map(np.array_equal, arrays, arrays_of_other))

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, self._data.parts()


def _again(unit_mm: float | None, bodies: Any, modifiers: Any, warnings: str) -> Mesh:
    def surface(arrays: Any) -> tuple[FloatArray, npt.NDArray[np.uint32]]:
        # Buffers that came over a network may lie at any address.
        return np.require(arrays[0], np.float64, ["C", "A"]), np.require(arrays[1], np.uint32, ["C", "A"])

    made = [(name, surface(mesh), surface(on), surface(off)) for name, mesh, on, off in bodies]
    volumes = [(name, surface(mesh), settings) for name, mesh, settings in modifiers]
    return Mesh._of(_grainpath.mesh_from_parts(unit_mm, made, volumes, warnings))


def box(x_mm: float, y_mm: float, z_mm: float) -> Mesh:
    """A box with one corner in the origin.

    >>> import grainpath as gp
    >>> gp.box(20, 10, 5)
    <grainpath.Mesh: 12 triangles, 1 bodies, 20 x 10 x 5 mm>
    """
    size = floats([x_mm, y_mm, z_mm], "size", (3,))
    if (size <= 0).any():
        raise InputError(f"a box of {x_mm} x {y_mm} x {z_mm} mm; all sides should be above 0")
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) * size
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Mesh(corners, faces)


def read_mesh(path: str | os.PathLike[str]) -> Mesh:
    """The mesh of a file: STL, OBJ, PLY, OFF or 3MF."""
    return Mesh._of(_grainpath.mesh_from_file(name_of(path)))


