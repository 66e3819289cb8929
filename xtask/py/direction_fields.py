"""Fill along given directions: gap, overlap, angle, number of paths and penalty of each, as lines of JSON.

usage: direction_fields.py FOLDER_OF_CHECKS WORK_FOLDER GRAINPATH

The cases and the measure are those of the outside checks: a radial field on a disk, the flow past a hole, the principal
directions of a bar with a hole, and a straight field at 45 degrees.
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
    from common import cases, measure, timed  # noqa: E402
    from run_gp import plan_paths  # noqa: E402

FIELDS = {
    "radial": "v-radial-r5",
    "flow": "o-plate-hole",
    "bar": "o-bar-hole",
    "diagonal": "v-diagonal-20x10",
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


all_cases = cases()
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
            found = measure(on_part(paths, offset, poly), poly, theta)
            kept = {key: found[key] for key in ("gap", "overlap", "angle", "paths", "penalty")}
            print(json.dumps({"field": field, "fill": fill, "ends": ends, **kept}), flush=True)
