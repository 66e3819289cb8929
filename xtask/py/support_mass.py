"""Grams of support and of everything in a G-code file of any of the slicers we compare, as one JSON object.

usage: support_mass.py FILE.gcode [FILAMENT_MM] [DENSITY_G_CM3]
"""
import json
import math
import re
import sys

path = sys.argv[1]
filament = float(sys.argv[2]) if len(sys.argv) > 2 else 1.75
density = float(sys.argv[3]) if len(sys.argv) > 3 else 1.24
area = math.pi / 4 * filament**2
kind, relative, last = "", False, 0.0
sums = {}
word = re.compile(r"\bE(-?[0-9.]+)")
for line in open(path, encoding="utf-8", errors="replace"):
    if line.startswith(";TYPE:"):
        kind = line[6:].strip().lower()
    elif line.startswith("M83"):
        relative = True
    elif line.startswith("M82"):
        relative = False
    elif line.startswith("G92"):
        found = word.search(line)
        if found:
            last = float(found[1])
    elif line.startswith(("G0", "G1", "G2", "G3")):
        found = word.search(line.split(";")[0])
        if not found:
            continue
        value = float(found[1])
        e = value if relative else value - last
        last = value
        moves = re.search(r"[XY]-?[0-9.]", line)
        if not moves:
            continue  # retraction and its return
        sums[kind] = sums.get(kind, 0.0) + e
grams = {k: v * area * density / 1000 for k, v in sums.items()}
support = sum(v for k, v in grams.items() if "support" in k)
print(json.dumps({"support_g": round(support, 4), "total_g": round(sum(grams.values()), 4), "types": grams}))
