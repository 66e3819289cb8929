"""Measures how soon a run of grainpath ends after SIGINT or SIGTERM, in each of its stages.

    stop_times.py path/to/grainpath folder [signals [seed]]

The job goes through every stage. Its standard error is a pseudo-terminal, so that grainpath shows its progress line there;
the line tells the stage that a run is in, and `guide 0 of 2` and `guide 1 of 2` tell meshing from solving. A signal is
sent at a random part of the stage's length, SIGINT and SIGTERM by turns, and counts where the line names the stage at that
moment; otherwise the run is repeated with another moment. The time to exit is that until the process is reaped.

Prints one JSON object a stage: its length, the number of signals, the times to exit, exit codes other than 130, files with
a time after the signal or that change after the end, and temporary files that are left.
"""

import fcntl
import json
import os
import pty
import random
import re
import shutil
import signal
import statistics
import struct
import subprocess
import sys
import termios
import threading
import time
from pathlib import Path

JOB = """
[shape]
mesh = "bar.stl"

[process]
walls = 2
layer_height_mm = 0.25

[fill]
pattern = "stripes"
density = 1.0

[guide]
kind = "stress"
element_mm = 0.7

[[guide.fixture]]
on = { box_mm = [[-1, -1, -1], [3, 13, 7]] }
fix = "xyz"

[[guide.load]]
on = { box_mm = [[33, -1, -1], [37, 13, 7]] }
force_n = [0, 0, -100]

[strength]
enabled = true
corners = false
check = false
cell_mm = 0.9

[output]
gcode = "out/bar.gcode"
report = "out/bar.html"
preview = "out/pictures"
plan = "out/bar.json"
stress = "out/bar.vtu"
"""
SIZE_MM = (36.0, 12.0, 6.0)
# Length of the edges of the mesh, mm. The mesh has 1 152 000 triangles, so that reading it takes a while.
EDGE_MM = 0.05

# What the progress line calls a stage, and the number of steps that it counts; without a number of steps it tells the seconds.
LINE = re.compile(
    r"(reading|slicing|guide|walls and fill|support|ordering|writing|strength test)\s+(?:\d+s|.*?(\d+) of (\d+))"
)
NAMES = {"reading": "read", "walls and fill": "fill", "writing": "write", "strength test": "strength"}
STAGES = ["read", "mesh", "solve", "fill", "strength", "write"]
# Runs whose stage was over before the signal are repeated this often.
ATTEMPTS = 20
# The longest run, s.
LONGEST_S = 300


def write_bar(path):
    """A box of small triangles as ASCII STL."""
    rows = ["solid bar\n"]
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        n_u, n_v = round(SIZE_MM[u] / EDGE_MM), round(SIZE_MM[v] / EDGE_MM)
        for upper in (False, True):
            for i in range(n_u):
                for j in range(n_v):
                    corners = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        p = [0.0, 0.0, 0.0]
                        p[axis] = SIZE_MM[axis] if upper else 0.0
                        p[u], p[v] = SIZE_MM[u] * a / n_u, SIZE_MM[v] * b / n_v
                        corners.append("vertex %.9g %.9g %.9g\n" % tuple(p))
                    for facet in ((0, 1, 2), (0, 2, 3)):
                        order = facet if upper else facet[::-1]
                        rows.append("facet normal 0 0 0\nouter loop\n")
                        rows.extend(corners[k] for k in order)
                        rows.append("endloop\nendfacet\n")
    rows.append("endsolid bar\n")
    path.write_text("".join(rows))


class Run:
    """A run of the job, and the stage that its progress line shows."""

    def __init__(self, program, folder):
        self.changes = []
        self.changed = threading.Condition()
        controller, terminal = pty.openpty()
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
        environment = dict(os.environ, TERM="xterm")
        self.process = subprocess.Popen(
            [program, "run", "bar.toml"],
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=terminal,
        )
        os.close(terminal)
        self.text = ""
        self.over = False
        self.reader = threading.Thread(target=self.read, args=(controller,))
        self.reader.start()

    def read(self, controller):
        while True:
            try:
                data = os.read(controller, 1 << 16)
            except OSError:
                data = b""
            with self.changed:
                if not data:
                    self.over = True
                    self.changed.notify_all()
                    break
                # A line may come in two pieces.
                self.text = (self.text + data.decode("utf-8", "replace"))[-4000:]
                found = LINE.findall(self.text)
                if found:
                    stage = self.name(*found[-1])
                    if not self.changes or self.changes[-1][0] != stage:
                        self.changes.append((stage, time.perf_counter()))
                        self.changed.notify_all()
        os.close(controller)

    @staticmethod
    def name(message, step, steps):
        if message == "guide":
            return ("mesh" if step == "0" else "solve") if steps == "2" else "directions"
        return NAMES.get(message, message)

    def shown(self, stage):
        """How often the line has shown a stage."""
        return sum(name == stage for name, _ in self.changes)

    def is_in(self, stage, nth):
        """Whether the line shows this stage, the nth time that it comes."""
        with self.changed:
            return bool(self.changes) and self.changes[-1][0] == stage and self.shown(stage) == nth and not self.over

    def wait_for(self, stage, nth):
        """Waits until the line shows a stage the nth time; false where the run ended before."""
        with self.changed:
            self.changed.wait_for(lambda: self.over or self.shown(stage) >= nth, LONGEST_S)
            return self.shown(stage) >= nth

    def end(self):
        """Waits for the end; the exit code and the moment."""
        # A wait with a time limit would look at the process every 50 ms only.
        watch = threading.Timer(LONGEST_S, self.process.kill)
        watch.start()
        code = self.process.wait()
        at = time.perf_counter()
        watch.cancel()
        self.reader.join()
        return code, at


def stages(program, folder):
    """The stages of a whole run in order, each with its seconds."""
    shutil.rmtree(folder / "out", ignore_errors=True)
    run = Run(program, folder)
    code, end = run.end()
    if code != 0:
        sys.exit(f"the run that is to be stopped ends with code {code} by itself: {run.text[-500:]}")
    marks = run.changes + [(None, end)]
    return [(stage, until - at) for (stage, at), (_, until) in zip(marks, marks[1:])]


def files(folder):
    """Every file below a folder, with its size and times."""
    found = {}
    for path in folder.rglob("*"):
        if path.is_file():
            s = path.stat()
            found[path] = (s.st_ino, s.st_size, s.st_mtime_ns, s.st_ctime_ns)
    return found


def stopped(program, folder, stage, nth, wait_s, number):
    """Stops a run some seconds after a stage came the nth time; nothing where the stage was over by then."""
    out = folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    run = Run(program, folder)
    if run.wait_for(stage, nth):
        time.sleep(wait_s)
    if not run.is_in(stage, nth):
        run.process.kill()
        run.end()
        return None
    sent_ns, sent = time.time_ns(), time.perf_counter()
    run.process.send_signal(number)
    code, end = run.end()
    if code == 0:
        # The run was over.
        return None
    after = files(out) if out.exists() else {}
    time.sleep(0.1)
    later = files(out) if out.exists() else {}
    late = [path for path, (_, _, changed, renamed) in after.items() if max(changed, renamed) > sent_ns]
    late += [path for path in later if later[path] != after.get(path)]
    left = [path for path in later if path.name.startswith(".grainpath-")]
    return {"s": end - sent, "code": code, "late": len(late), "left": len(left)}


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    n_signals = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    draw = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    folder.mkdir(parents=True, exist_ok=True)
    write_bar(folder / "bar.stl")
    (folder / "bar.toml").write_text(JOB)
    # The first run fills the caches of the system.
    stages(program, folder)
    whole = stages(program, folder)
    print(" ".join(f"{stage} {s:.2f} s," for stage, s in whole), file=sys.stderr, flush=True)
    for stage in STAGES:
        # Writing goes on behind the strength test; a stage that comes twice is stopped where it takes longer.
        each = [s for name, s in whole if name == stage]
        if not each:
            sys.exit(f"the progress line of a whole run never names the stage {stage}")
        length = max(each)
        nth = each.index(length) + 1
        results = []
        for k in range(n_signals):
            number = (signal.SIGINT, signal.SIGTERM)[k % 2]
            waits = (draw.random() * length for _ in range(ATTEMPTS))
            attempts = (stopped(program, folder, stage, nth, wait_s, number) for wait_s in waits)
            result = next((r for r in attempts if r), None)
            if result is None:
                sys.exit(f"no run was in the stage {stage} when it was to be stopped")
            results.append(result)
        times = sorted(r["s"] for r in results)
        row = {
            "stage": stage,
            "length_s": length,
            "signals": len(times),
            "median_s": statistics.median(times),
            "worst_s": times[-1],
            "other_codes": sum(r["code"] != 130 for r in results),
            "late": sum(r["late"] for r in results),
            "left": sum(r["left"] for r in results),
        }
        print(json.dumps(row), flush=True)


main()
