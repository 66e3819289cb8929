"""What the Python package costs: import, call, handing over a scan, and sweeps on two workers.

    python bench_python.py [JOBS]

JOBS is the number of jobs of the sweep (100). Each line has the figure and its goal; the last line says how many goals
were missed. Processor time is that of this process and of the workers that have ended.
"""

import concurrent.futures
import os
import resource
import subprocess
import sys
import tempfile
import time
import tracemalloc

import numpy as np

import grainpath as gp

#: Voxels of the array that is handed over: 1 GB of uint16.
SHAPE = (477, 1024, 1024)
MISSED = []


def say(what, value, unit, goal, met):
    if not met:
        MISSED.append(what)
    print(f"{what:<44} {value:>10.3f} {unit:<6} goal {goal}{'' if met else '  MISSED'}", flush=True)


def importing():
    code = "import numpy, time; t = time.perf_counter(); import grainpath; print(time.perf_counter() - t)"
    ran = [subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True) for _ in range(7)]
    ms = 1e3 * min(float(one.stdout) for one in ran)
    say("import over numpy's", ms, "ms", "<= 60", ms <= 60)


def calling():
    """The time of a plan of a small part that its own stages do not account for."""
    job = gp.Job(gp.box(3, 3, 0.4))
    over = []
    for _ in range(50):
        start = time.perf_counter()
        plan = job.plan()
        took = time.perf_counter() - start
        stages = plan.report["stages_s"]
        over.append(took - sum(s for name, s in stages.items() if name not in ("write", "measure")))
    ms = 1e3 * float(np.median(over))
    say("overhead of a call", ms, "ms", "<= 5", ms <= 5)


def handing_over():
    with tempfile.TemporaryDirectory() as folder:
        scan = np.lib.format.open_memmap(os.path.join(folder, "scan.npy"), mode="w+", dtype=np.uint16, shape=SHAPE)
        tracemalloc.start()
        volume = gp.Volume(scan, spacing=0.1)
        kept = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        same = volume.array is scan
        say("copied of 1 GB handed over", kept if same else scan.nbytes, "bytes", "< 100 kB of objects", same and kept < 1e5)


def processor_s():
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def sweeping(n):
    # A part of about two seconds a job on one thread.
    job = gp.Job(gp.box(160, 120, 30), fill__pattern="gyroid", process__layer_height_mm=0.2)
    densities = {"fill.density": [0.15 + 0.2 * k / n for k in range(n)]}
    figures = {}
    for workers in (1, 2):
        with tempfile.TemporaryDirectory() as cache:
            before, start = processor_s(), time.perf_counter()
            with concurrent.futures.ProcessPoolExecutor(workers) as pool:
                table = gp.sweep(job, densities, executor=pool, cache=cache)
            figures[workers] = time.perf_counter() - start
            used = processor_s() - before
            of_jobs = sum(row["seconds"] for row in table)
            assert not table.failed, table.failed[0]
            if workers == 1:
                say("shortest job of the sweep", min(row["seconds"] for row in table), "s", ">= 2", of_jobs >= 2 * n)
                say("processor time over that of the jobs", used / of_jobs, "", "<= 1.1", used <= 1.1 * of_jobs)
            start = time.perf_counter()
            again = gp.sweep(job, densities, cache=cache)
            took = time.perf_counter() - start
            assert all(row["cached"] for row in again)
    say(f"{n} jobs, 2 workers over 1", figures[1] / figures[2], "times", ">= 1.7", figures[1] >= 1.7 * figures[2])
    say(f"{n} jobs from the cache", took, "s", "<= 3", took <= 3)


if __name__ == "__main__":
    importing()
    calling()
    handing_over()
    sweeping(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
    print(f"{len(MISSED)} goals missed")
    sys.exit(1 if MISSED else 0)
