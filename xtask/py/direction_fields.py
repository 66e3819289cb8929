"""Fill along given directions: gap, overlap, angle, number of paths and penalty of each, as lines of JSON.

usage: direction_fields.py FOLDER_OF_CHECKS WORK_FOLDER GRAINPATH

Four cases and the measure are those of the outside checks: a radial field on a disk, the flow past a hole, the principal
directions of a bar with a hole, and a straight field at 45 degrees. The others are the project's own: the field lines of
two charges, a spiral, the two kinds of point defects, waves, and the bar turned by 37 degrees.
"""
import contextlib
import json
import os
import sys

checks, work, program = map(os.path.abspath, sys.argv[1:4])
os.makedirs(work, exist_ok=True)
os.environ["FIELD_WORK"], os.environ["GRAINPATH"] = work, program
sys.path.insert(0, checks)
with contextlib.redirect_stdout(sys.stderr):
    # The module makes the bar's field when it is loaded.
    import bar_field  # noqa: E402, F401  (found in the folder that is named above)
    import gp  # noqa: E402
    import numpy as np  # noqa: E402
    import shapely  # noqa: E402
    from common import S, bead_union, box, cases, charges, disk, measure, spiral, timed  # noqa: E402
    from run_gp import plan_paths  # noqa: E402

FIELDS = {
    "radial": "v-radial-r5",
    "flow": "o-plate-hole",
    "bar": "o-bar-hole",
    "diagonal": "v-diagonal-20x10",
    "charges": "charges",
    "spiral": "spiral",
    "trisector": "trisector",
    "loop": "loop",
    "waves": "waves",
    "bar-37": "bar-37",
}
FILLS = {"stripes": "variable", "one width": "constant"}


def middle(low, high):
    return (np.asarray(low) + np.asarray(high)) / 2


def on_part(paths, offset, poly):
    """Paths in the coordinates of the part. Its mesh stands where the case lies, or around the middle of the plate."""
    points = np.vstack([points for points, _ in paths])
    there = middle(poly.bounds[:2], poly.bounds[2:])
    here = middle(points.min(axis=0), points.max(axis=0))
    shift = min((np.zeros(2), -offset, there - here), key=lambda s: round(float(np.hypot(*(here + s - there)))))
    return [(points + shift, widths) for points, widths in paths]


def point_defect(half_turns, x0, y0):
    """A field that makes this many half turns on the way around a point."""
    return lambda x, y: 0.5 * half_turns * np.arctan2(y - y0, x - x0) + 0.3


def turned(part, angle, degrees):
    """A part and its field, turned around the origin."""
    turn = np.radians(degrees)
    c, s = np.cos(turn), np.sin(turn)
    return shapely.affinity.rotate(part, degrees, origin=(0, 0)), lambda x, y: angle(c * x + s * y, c * y - s * x) + turn


all_cases = cases()
own = {
    "charges": (box(0, 0, 30, 20), charges([(8, 12), (20, 7)], [1, -0.7])),
    "spiral": (disk(10).difference(disk(2.5, 64)), spiral(np.radians(60))),
    "trisector": (box(0, 0, 20, 20), point_defect(-1, 9, 11)),
    "loop": (box(0, 0, 20, 20), point_defect(1, 9, 11)),
    "waves": (box(0, 0, 30, 20), lambda x, y: 0.6 * np.sin(x / 5) + 0.2 * np.cos(y / 4)),
    "bar-37": turned(*all_cases["o-bar-hole"][:2], 37),
}
all_cases.update({name: (part, angle, "") for name, (part, angle) in own.items()})
for field, case in FIELDS.items():
    poly, theta, _ = all_cases[case]
    folder = os.path.join(work, "runs", case)
    gp.write_case(case, poly, theta, folder)
    for fill, widths in FILLS.items():
        for ends in ("joined", "open"):
            name = f"{widths}-{ends}"
            gp.job(folder, name, "stripes")
            command = [program, "run", f"{name}.toml", "--out", "."]
            command += ["--set", f"fill.widths={widths}", "--set", f"fill.ends={ends}"]
            cost, out, err = timed(command, cwd=folder)
            if cost["rc"]:
                sys.exit(f"{case}, {fill}, {ends}: {out}{err}")
            paths, offset = plan_paths(os.path.join(folder, f"{name}.json"))
            paths = on_part(paths, offset, poly)
            found = measure(paths, poly, theta)
            kept = {key: found[key] for key in ("gap", "overlap", "spill", "angle", "paths", "penalty")}
            open_mm2 = shapely.area(shapely.get_parts(poly.difference(bead_union(paths))))
            # In squares as wide as a bead.
            kept["largest"] = float(open_mm2.max(initial=0.0)) / S**2
            kept["voids"] = int(np.count_nonzero(open_mm2 > S**2))
            print(json.dumps({"field": field, "fill": fill, "ends": ends, **kept}), flush=True)
