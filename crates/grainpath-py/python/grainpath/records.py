"""Programs as the viewer draws them: eight bytes a segment, as the studio has them (`crates/grainpath-studio/src/records.rs`)
but for the marks of retractions."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._checks import FloatArray
from .errors import InputError
from .gcode import ROLES, Program

#: A record: a point, in steps from the origin, and what is printed on the way to it from the point before. ``kind`` is an
#: index of :data:`CLASSES`, with :data:`SEAM` added where a closed wall begins; ``speed`` is an index of the table of speeds.
RECORD = np.dtype([("x", "<u2"), ("y", "<u2"), ("width_um", "<u2"), ("kind", "u1"), ("speed", "u1")])
#: Names of what a record can be. The first record of a layer is a start, which draws nothing.
CLASSES = (*ROLES, "Travel", "Start")
TRAVEL, START = len(ROLES), len(ROLES) + 1
#: Added to the kind of the first bead of a closed wall.
SEAM = 128
#: The angle of a record that has none, in halves of a degree.
NO_ANGLE = 255
#: Steps along the longer side of the box round all moves.
STEPS = 65535
#: Most speeds of a table.
SPEEDS = 256
#: Distance below which two ends are the same point, mm. Source: that of the studio; programs state 0.001 mm.
SAME_MM = np.float32(2e-3)
#: Roles that are no part of the part.
BESIDE = tuple(ROLES.index(name) for name in ("Skirt", "Brim", "Support material", "Support material interface"))
#: Roles whose closed paths have a seam.
WALLS = tuple(ROLES.index(name) for name in ("External perimeter", "Perimeter"))

_Mask = npt.NDArray[np.bool_]


class Records:
    """All that the viewer needs to know of a program.

    Points are rounded to steps of ``index["step_mm"]``, a 65535th of the longer side of the box round all moves; widths to
    0.001 mm and speeds to 0.1 mm/s, or down to the next of 256 where a program has more.
    """

    def __init__(self, program: Program) -> None:
        beads, n_layers = program.beads, len(program.z_mm)
        if len(beads) == 0:
            raise InputError("nothing is printed in the program")
        start, end, layer = beads["start"], beads["end"], beads["layer"]
        #: The first bead of each layer, and the number of all.
        first = np.searchsorted(layer, np.arange(n_layers + 1))
        extra, before, n_records = _between(program, first)
        #: The record of each bead.
        self.of_bead: npt.NDArray[np.int64] = np.arange(len(beads)) + np.cumsum(before)
        n = len(beads) + len(extra)
        is_bead = np.zeros(n, bool)
        is_bead[self.of_bead] = True
        points = np.empty((n, 2))
        points[is_bead] = end
        points[~is_bead] = extra[:, :2]
        ends = np.concatenate([start, end, *(program.travels[name] for name in ("start", "end"))]).astype(float)
        low, high = ends.min(axis=0), ends.max(axis=0)
        step = max(float((high - low).max()) / STEPS, 1e-6)
        rows = np.zeros(n, RECORD)
        rows["x"], rows["y"] = np.floor((points - low) / step + 0.5).clip(0, STEPS).T
        rows["width_um"][is_bead] = np.floor(beads["width_mm"].astype(float) * 1e3 + 0.5).clip(0, STEPS)
        seams = _seams(program, first)
        rows["kind"][is_bead] = beads["role"] + np.where(seams, SEAM, 0)
        rows["kind"][~is_bead] = extra[:, 2]
        # Tenths of mm/s; beads beside a table that is too short have the largest speed that is not above theirs.
        keys = np.floor(beads["speed_mm_s"].clip(0, 1e5) * np.float32(10) + np.float32(0.5)).astype(np.int64)
        speeds = np.unique(keys)
        if len(speeds) > SPEEDS:
            speeds = speeds[np.arange(SPEEDS) * (len(speeds) - 1) // (SPEEDS - 1)]
        rows["speed"][is_bead] = np.searchsorted(speeds, keys, side="right") - 1
        #: The records, layer by layer.
        self.rows: npt.NDArray[np.void] = rows
        #: What the records refer to: the studio's index, without the time of each layer, which is not known here.
        self.index: dict[str, Any] = {
            "origin_mm": low.tolist(),
            "step_mm": step,
            "classes": list(CLASSES),
            "speeds_mm_s": (speeds / 10).tolist(),
            "more": False,
            "records": n,
            "generator": program.summary["generator"],
            "time_s": program.summary["time_s"],
            "filament_mm": program.summary["filament_mm"],
            **_measured(program, first, n_records, seams),
        }

    def angles(self, of_beads: FloatArray) -> bytes:
        """A byte for each record: that of its bead in halves of a degree, or :data:`NO_ANGLE` where it is NaN."""
        found = np.full(len(self.rows), NO_ANGLE, np.uint8)
        known = np.isfinite(of_beads)
        found[self.of_bead[known]] = np.floor(2 * of_beads[known] + 0.5)
        return found.tobytes()


def _far(a: npt.NDArray[np.float32], b: npt.NDArray[np.float32]) -> _Mask:
    far: _Mask = (np.abs(a - b) > SAME_MM).any(axis=-1)
    return far


def _between(program: Program, first: npt.NDArray[np.int64]) -> tuple[FloatArray, npt.NDArray[np.int64], list[int]]:
    """Starts of layers and travels, as rows of x, y and kind; how many of them come before each bead; and the number of
    records of each layer.

    Travels are in the order of the program, and each begins where the last move ended. Where none leads to a bead, one is
    added: a layer may consist of several pieces.
    """
    beads, travels = program.beads, program.travels
    first_travel = np.searchsorted(travels["layer"], np.arange(len(first)))
    at = np.concatenate([beads["start"][:1], beads["end"][:-1]])
    begins = first[:-1][first[:-1] < first[1:]]
    # A layer begins where its first travel does.
    at[begins] = beads["start"][begins]
    moved = (first_travel[:-1] < first_travel[1:]) & (first[:-1] < first[1:])
    at[first[:-1][moved]] = travels["start"][first_travel[:-1][moved]]
    far = _far(at, beads["start"])
    stops = np.union1d(begins, np.flatnonzero(far))
    extra: list[tuple[float, float, int]] = []
    before = np.zeros(len(beads), np.int64)
    n_records = []
    same = float(SAME_MM)
    for k in range(len(first) - 1):
        n_before = len(extra)
        own = slice(first_travel[k], first_travel[k + 1])
        moves = list(zip(travels["start"][own].tolist(), travels["end"][own].tolist(), strict=True))
        if moves or first[k] < first[k + 1]:
            x, y = moves[0][0] if moves else beads["start"][first[k]].tolist()
            extra.append((x, y, START))
        done, counted = 0, n_before
        for i in stops[np.searchsorted(stops, first[k]) : np.searchsorted(stops, first[k + 1])]:
            (x, y), (to_x, to_y) = at[i].tolist(), beads["start"][i].tolist()
            while abs(x - to_x) > same or abs(y - to_y) > same:
                (from_x, from_y), to = moves[done] if done < len(moves) else ((np.inf, np.inf), (to_x, to_y))
                if abs(from_x - x) > same or abs(from_y - y) > same:
                    extra.append((to_x, to_y, TRAVEL))
                    break
                x, y = to
                done += 1
                extra.append((x, y, TRAVEL))
            before[i] = len(extra) - counted
            counted = len(extra)
        n_records.append(len(extra) - n_before + int(first[k + 1] - first[k]))
    return np.array(extra, float).reshape(-1, 3), before, n_records


def _seams(program: Program, first: npt.NDArray[np.int64]) -> _Mask:
    """Whether each bead is the first of a closed wall: one whose path ends within a bead's width of where it began."""
    beads = program.beads
    runs = beads["begins"].copy()
    runs[1:] |= beads["role"][1:] != beads["role"][:-1]
    runs[first[:-1][first[:-1] < first[1:]]] = True
    begin = np.flatnonzero(runs)
    last = np.append(begin[1:], len(beads)) - 1
    gap = np.linalg.norm(beads["start"][begin].astype(float) - beads["end"][last], axis=1)
    # Two beads forth and back enclose nothing.
    closed = (last - begin > 1) & (gap <= beads["width_mm"][begin])
    seams = np.zeros(len(beads), bool)
    seams[begin] = closed & beads["begins"][begin] & np.isin(beads["role"][begin], WALLS)
    return seams


def _measured(
    program: Program, first: npt.NDArray[np.int64], n_records: list[int], seams: _Mask
) -> dict[str, Any]:
    """Extents, ends of scales, and what each class and each layer has."""
    beads = program.beads
    length = np.linalg.norm(beads["end"].astype(float) - beads["start"], axis=1)
    is_part = ~np.isin(beads["role"], BESIDE)
    part_layers = np.unique(beads["layer"][is_part])
    # The first layer is left out, because priming lines lie in it and have the role of walls.
    inside = is_part & (beads["layer"] > part_layers[0]) if len(part_layers) > 2 else is_part
    inside = inside if inside.any() else np.ones(len(beads), bool)
    half = beads["width_mm"][inside, None].astype(float) / 2
    ends = np.stack([beads["start"][inside], beads["end"][inside]]).astype(float)
    part_layers = part_layers if len(part_layers) else np.unique(beads["layer"])
    tops, heights = program.z_mm[part_layers], program.height_mm[part_layers]
    low = [*(ends - half).min(axis=(0, 1)), (tops - heights).min()]
    high = [*(ends + half).max(axis=(0, 1)), tops.max()]
    # A sample of each layer is enough for the ends of a scale.
    sampled = []
    for k in range(len(first) - 1):
        own = np.arange(first[k], first[k + 1])
        sampled.append(own[is_part[own]][:: 1 + len(own) // 200])
    some = beads[np.concatenate(sampled)] if is_part.any() else beads
    flow = some["volume_mm3"] * some["speed_mm_s"] / np.maximum(np.linalg.norm(some["end"] - some["start"], axis=1), 1e-9)
    widths, flows = np.sort(some["width_mm"]), np.sort(flow)
    n_beads, printed, volume, n_seams = (
        np.bincount(beads["layer"], weights, len(first) - 1).tolist() for weights in (None, length, beads["volume_mm3"], seams)
    )
    return {
        "part_mm": [np.round(low, 3).tolist(), np.round(high, 3).tolist()],
        "widths_mm": [round(float(widths[int((len(widths) - 1) * q)]), 3) for q in (0.01, 0.99)],
        "flow_mm3_s": round(float(flows[int((len(flows) - 1) * 0.99)]), 3),
        "shares": [
            {"beads": int(n), "length_mm": float(mm)}
            for n, mm in zip(
                np.bincount(beads["role"], minlength=len(CLASSES)),
                np.bincount(beads["role"], length, len(CLASSES)),
                strict=True,
            )
        ],
        "layers": [
            {
                "z_mm": float(z),
                "height_mm": float(height),
                "records": n_records[k],
                "beads": int(n_beads[k]),
                "printed_mm": printed[k],
                "volume_mm3": volume[k],
                "seams": int(n_seams[k]),
            }
            for k, (z, height) in enumerate(zip(program.z_mm, program.height_mm, strict=True))
        ],
    }
