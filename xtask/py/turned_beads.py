"""Tests one and the same set of beads, turned and moved on the plate, in the virtual strength test.

    turned_beads.py path/to/grainpath job.toml folder [copies [seed]]

The job is planned once. Each copy of its program is turned about z by any angle and moved by up to 20 mm along x and y;
E words stay, so that the beads are the same. The part and its loads are turned by the job (`shape.rotate_deg` with
`guide.frame = "part"`). `grainpath strength PROGRAM --job JOB` tests each copy with the nominal card on the same cells as
the unturned program, which is also tested at the corners of the card and tells the interval.

Prints one JSON object: the peak load of the unturned program with its interval, and the peak loads of the copies.
"""

import json
import math
import random
import re
import subprocess
import sys
from pathlib import Path

CELL_MM = 0.45
# The furthest that a copy is moved along an axis, mm: many cells, and no whole number of them.
FURTHEST_MM = 20.0
MOVE = re.compile(r"G[01] ")
WORD = re.compile(r"([XY])(-?[0-9.]+)")


def turned(text, angle, shift):
    """A program of straight moves, turned about the origin and then moved."""
    c, s = math.cos(angle), math.sin(angle)
    at = [0.0, 0.0]
    out = []
    for line in text.splitlines():
        if re.match(r"G[23] |G91", line):
            sys.exit(f"only straight moves to positions are turned: {line}")
        if MOVE.match(line):
            code, comment, rest = line.partition(";")
            found = dict(WORD.findall(code))
            if found:
                at = [float(found.get("X", at[0])), float(found.get("Y", at[1]))]
                x = c * at[0] - s * at[1] + shift[0]
                y = s * at[0] + c * at[1] + shift[1]
                # A word of the program's may stand for one axis alone; a turned move needs both. Five decimals are a
                # hundredth of what the program is rounded to.
                others = WORD.sub("", code).split()
                code = " ".join([others[0], f"X{x:.5f}", f"Y{y:.5f}", *others[1:]])
            line = code + comment + rest
        out.append(line)
    return "\n".join(out) + "\n"


def tested(program, gcode, job, sets):
    """The report of the strength test of a program."""
    words = [program, "strength", gcode, "--job", job, "--json"]
    words += [word for setting in sets for word in ("--set", setting)]
    out = subprocess.run(list(map(str, words)), capture_output=True, text=True)
    if out.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: {out.stderr.strip()}")
    return json.loads(out.stdout)["strength"]


def main():
    program, job, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    n_copies = int(sys.argv[4]) if len(sys.argv) > 4 else 50
    draw = random.Random(int(sys.argv[5]) if len(sys.argv) > 5 else 1)
    folder.mkdir(parents=True, exist_ok=True)
    gcode = folder / "unturned.gcode"
    plan = [program, "run", job, "--out", folder, "--json"]
    for key, value in (("gcode", gcode.name), ("report", ""), ("preview", ""), ("stress", ""), ("lines", "")):
        plan += ["--set", f'output.{key}="{value}"']
    plan += ["--set", "process.skirt_loops=0", "--set", "process.arcs=false"]
    subprocess.run(list(map(str, plan)), check=True, stdout=subprocess.DEVNULL)
    text = gcode.read_text()
    cell = [f"strength.cell_mm={CELL_MM}", 'guide.frame="part"']
    whole = tested(program, gcode, job, cell)
    copies = []
    for _ in range(n_copies):
        angle = draw.uniform(0.0, 2.0 * math.pi)
        shift = [draw.uniform(-FURTHEST_MM, FURTHEST_MM) for _ in range(2)]
        copy = folder / "turned.gcode"
        copy.write_text(turned(text, angle, shift))
        nominal = ["strength.corners=false", "strength.check=false"]
        rotation = f"shape.rotate_deg=[0, 0, {math.degrees(angle):.9f}]"
        found = tested(program, copy, job, [*cell, *nominal, rotation])
        copies.append(found["peak_load_n"])
        print(f"{math.degrees(angle):7.2f} degrees, {shift[0]:+6.2f}, {shift[1]:+6.2f} mm: {copies[-1]:.1f} N", file=sys.stderr)
    row = {"cell_mm": CELL_MM, "copies_n": copies}
    row.update({key: whole[key] for key in ("peak_load_n", "low_n", "high_n")})
    print(json.dumps(row))


main()
