"""Holds the printing times that grainpath tells against those of Klipper's own planner.

    klipper_time.py path/to/grainpath path/to/klipper folder [path/to/data]

The second path is a checkout of Klipper with a built dictionary, `out/klipper.dict`; its `klippy` runs in batch mode, which
plans every move and drives no printer. Klippy is copied into the folder, and a module of a few lines beside its own adds
the command REPORT_TIME, which writes how far the planned moves reach in time. Each program stands between two of these.
Klipper gets the limits of the printer that grainpath is told; everything else has Klipper's defaults, arcs in pieces of
1 mm and `minimum_cruise_ratio` among them.

Nine programs are planned here; the tenth is that of another slicer, from the data, without its commands but moves and
positions. Its time is told by `grainpath inspect` alone. Prints one JSON object a program.
"""

import json
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

REPORT = r'''"""Writes the time up to which moves are planned."""


class ReportTime:
    def __init__(self, config):
        self.printer = config.get_printer()
        self.path = config.get("path")
        self.printer.lookup_object("gcode").register_command("REPORT_TIME", self.report)

    def report(self, command):
        with open(self.path, "a") as out:
            out.write("%.6f\n" % self.printer.lookup_object("toolhead").get_last_move_time())


def load_config(config):
    return ReportTime(config)
'''

# Pins that the simulated controller of Klipper's Linux build has.
AXIS = """[stepper_{axis}]
step_pin: gpio{pin}
dir_pin: gpio{pin_1}
enable_pin: !gpio{pin_2}
microsteps: 16
rotation_distance: {turn_mm}
endstop_pin: ^gpio{pin_3}
position_endstop: 0
position_min: -100
position_max: 500
homing_speed: 50
homing_positive_dir: False
"""
HEAT = """sensor_type: EPCOS 100K B57560G104F
sensor_pin: analog{sensor}
min_temp: 0
max_temp: 300
"""

# Limits of the printer of all programs but where they state others: the defaults of [printer].
SPEED_MM_S, Z_SPEED_MM_S, FILAMENT_SPEED_MM_S = 300.0, 12.0, 60.0
RETRACT_MM_S2 = 2000.0
USUAL = {"acceleration": 1500.0, "travel": 2000.0, "corner": 5.0}

BOX, CYLINDER, VASE = "box", "cylinder", "vase"
# Name, part, limits that are not the usual, settings.
PROGRAMS = [
    ("box", BOX, {}, []),
    ("gyroid", BOX, {}, ["fill.pattern=gyroid"]),
    ("honeycomb", BOX, {"acceleration": 3000.0, "travel": 5000.0, "corner": 12.0}, ["fill.pattern=honeycomb"]),
    ("cylinder as points", CYLINDER, {}, []),
    ("cylinder with arcs", CYLINDER, {}, ["process.arcs=true"]),
    ("gyroid with arcs", CYLINDER, {}, ["process.arcs=true", "fill.pattern=gyroid"]),
    (
        "fast",
        BOX,
        {"acceleration": 8000.0, "travel": 10000.0, "corner": 8.0},
        [
            "process.outer_wall_speed_mm_s=150",
            "process.inner_wall_speed_mm_s=200",
            "process.solid_speed_mm_s=200",
            "process.top_speed_mm_s=150",
            "process.sparse_speed_mm_s=250",
            "process.travel_speed_mm_s=300",
            "material.min_layer_time_s=0",
            "material.max_volumetric_mm3_s=40",
        ],
    ),
    ("slow to speed up", CYLINDER, {"acceleration": 500.0, "travel": 800.0, "corner": 2.0}, ["printer.z_hop_mm=0.4"]),
    ("adaptive layers", VASE, {}, ["process.adaptive_layers=true"]),
]
# Of the other slicer's program these commands are kept; it is run with one acceleration.
OTHER = ("another slicer's", "gcode/rrf_prusaslicer.gcode", {"acceleration": 1500.0, "travel": 1500.0, "corner": 5.0})
KEPT = re.compile(r"\s*(G0|G1|G2|G3|G90|G91|G92|M82|M83)\b")


def write_turned(path, profile, n):
    """A body of revolution: radius and height of its rings from below to above, each a polygon of n corners."""
    ring = lambda r, z: [(r * math.cos(a), r * math.sin(a), z) for a in (2 * math.pi * (k + 0.5) / n for k in range(n))]
    rings = [ring(r, z) for r, z in profile]
    facets = []
    for below, above in zip(rings, rings[1:]):
        for k in range(n):
            m = (k + 1) % n
            facets += [(below[k], below[m], above[m]), (below[k], above[m], above[k])]
    for k in range(1, n - 1):
        facets += [(rings[0][0], rings[0][k + 1], rings[0][k]), (rings[-1][0], rings[-1][k], rings[-1][k + 1])]
    rows = ["solid part"]
    for facet in facets:
        rows += ["facet normal 0 0 0", "outer loop"]
        rows += ["vertex %.6f %.6f %.6f" % p for p in facet]
        rows += ["endloop", "endfacet"]
    path.write_text("\n".join(rows + ["endsolid part", ""]))


def limits_of(changed):
    return {**USUAL, **changed}


def settings(limits):
    """The printer as grainpath is told it."""
    values = {
        "flavour": "klipper",
        "max_speed_mm_s": f"[{SPEED_MM_S}, {SPEED_MM_S}, {Z_SPEED_MM_S}, {FILAMENT_SPEED_MM_S}]",
        "acceleration_mm_s2": limits["acceleration"],
        "travel_acceleration_mm_s2": limits["travel"],
        "retract_acceleration_mm_s2": RETRACT_MM_S2,
        "square_corner_mm_s": limits["corner"],
        # Nothing that takes time by itself, or needs a macro.
        "start_gcode": '"G92 E0"',
        "end_gcode": '"M107"',
    }
    return [word for key, value in values.items() for word in ("--set", f"printer.{key}={value}")]


def config(limits, report, log):
    """The printer as Klipper is told it."""
    text = f"[mcu]\nserial: /nowhere\n[report_time]\npath: {report}\n[gcode_arcs]\n[fan]\npin: gpio18\n"
    text += f"[printer]\nkinematics: cartesian\nmax_velocity: {SPEED_MM_S}\nmax_accel: {limits['acceleration']}\n"
    text += f"max_z_velocity: {Z_SPEED_MM_S}\nsquare_corner_velocity: {limits['corner']}\n"
    for k, (axis, turn_mm) in enumerate((("x", 40), ("y", 40), ("z", 8))):
        pins = {name: 4 * k + 1 + i for i, name in enumerate(("pin", "pin_1", "pin_2", "pin_3"))}
        text += AXIS.format(axis=axis, turn_mm=turn_mm, **pins)
    text += "[extruder]\nstep_pin: gpio13\ndir_pin: gpio14\nenable_pin: !gpio15\nmicrosteps: 16\n"
    text += "rotation_distance: 33.5\nnozzle_diameter: 0.4\nfilament_diameter: 1.75\nheater_pin: gpio16\n"
    text += "control: pid\npid_Kp: 22\npid_Ki: 1\npid_Kd: 114\nmin_extrude_temp: 0\nmax_extrude_cross_section: 50\n"
    text += f"max_extrude_only_distance: 500\nmax_extrude_only_velocity: {FILAMENT_SPEED_MM_S}\n"
    text += f"max_extrude_only_accel: {RETRACT_MM_S2}\n" + HEAT.format(sensor=0)
    text += "[heater_bed]\nheater_pin: gpio17\ncontrol: watermark\n" + HEAT.format(sensor=1)
    return text


def told(program, arguments):
    """The time in the report of a command, s."""
    out = subprocess.run([program, *arguments, "--json"], capture_output=True, text=True)
    if out.returncode != 0:
        sys.exit(f"grainpath {' '.join(map(str, arguments))}: {out.stderr.strip()}")
    return json.loads(out.stdout)["time_s"]


def planned(klippy, dictionary, folder, name, text, limits):
    """The time that Klipper plans for a program, s."""
    report, log, machine = folder / "report.txt", folder / f"{name}.log", folder / f"{name}.cfg"
    report.unlink(missing_ok=True)
    machine.write_text(config(limits, report, log))
    batch = folder / f"{name}.batch.gcode"
    batch.write_text(f"G28\nG1 X0 Y0 F6000\nREPORT_TIME\n{text}\nREPORT_TIME\n")
    words = [sys.executable, klippy, machine, "-i", batch, "-o", "/dev/null", "-d", dictionary, "-l", log]
    run = subprocess.run(list(map(str, words)), capture_output=True, text=True)
    times = [float(line) for line in report.read_text().split()] if report.exists() else []
    if len(times) != 2:
        last = [line for line in log.read_text().splitlines() if line][-3:] if log.exists() else []
        sys.exit(f"Klipper did not plan {name} to its end: {run.stderr.strip()[-300:]} {' | '.join(last)} (see {log})")
    return times[1] - times[0]


def main():
    program, klipper, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]).absolute()
    data = Path(sys.argv[4]) if len(sys.argv) > 4 else None
    folder.mkdir(parents=True, exist_ok=True)
    copy = folder / "klippy"
    shutil.rmtree(copy, ignore_errors=True)
    # Times of files are kept, so that the compiled helper in the checkout is not compiled again.
    shutil.copytree(klipper / "klippy", copy)
    (copy / "extras" / "report_time.py").write_text(REPORT)
    write_turned(folder / f"{BOX}.stl", [(21.0, 0.0), (21.0, 8.0)], 4)
    write_turned(folder / f"{CYLINDER}.stl", [(15.0, 0.0), (15.0, 8.0)], 240)
    waist = [(12.0 - 4.0 * math.sin(math.pi * k / 24) ** 2, 12.0 * k / 24) for k in range(25)]
    write_turned(folder / f"{VASE}.stl", waist, 120)

    def row(name, limits, gcode, by_slice, by_inspect, text):
        klipper_s = planned(copy / "klippy.py", klipper / "out/klipper.dict", folder, gcode.stem, text, limits)
        print(json.dumps({"program": name, "klipper_s": klipper_s, "slice_s": by_slice, "inspect_s": by_inspect}), flush=True)

    for name, part, changed, more in PROGRAMS:
        limits, gcode = limits_of(changed), folder / f"{name.replace(' ', '-')}.gcode"
        sets = settings(limits) + [word for setting in more for word in ("--set", setting)]
        by_slice = told(program, ["slice", folder / f"{part}.stl", "-o", gcode, *sets])
        by_inspect = told(program, ["inspect", gcode, *settings(limits)])
        row(name, limits, gcode, by_slice, by_inspect, gcode.read_text())
    if data is not None:
        name, path, changed = OTHER
        limits, gcode = limits_of(changed), folder / "another.gcode"
        lines = (data / path).read_text(errors="replace").splitlines()
        gcode.write_text("\n".join(line.split(";")[0] for line in lines if KEPT.match(line)) + "\n")
        row(name, limits, gcode, None, told(program, ["inspect", gcode, *settings(limits)]), gcode.read_text())


main()
