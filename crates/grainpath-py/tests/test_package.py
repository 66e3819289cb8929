"""The package itself: stubs, documentation, the command line, and what a call costs."""

import importlib.metadata
import pathlib
import re
import subprocess
import sys
import time

import numpy as np
import pytest

import grainpath as gp
from grainpath import _grainpath

TOP = pathlib.Path(__file__).parents[3]


def run(*args):
    return subprocess.run([sys.executable, *args], capture_output=True, text=True, check=False)


def test_stubs_agree_with_the_module():
    ran = run("-m", "mypy.stubtest", "grainpath._grainpath", "--ignore-positional-only")
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_types_are_sound():
    ran = run("-m", "mypy", "--strict", "-p", "grainpath")
    assert ran.returncode == 0, ran.stdout + ran.stderr


def python_blocks(page):
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.S | re.M)


@pytest.mark.parametrize("page", ["crates/grainpath-py/README.md", "docs/python.md"])
def test_examples_of_pages_run(page, tmp_path, monkeypatch, stl):
    monkeypatch.chdir(tmp_path)
    blocks = python_blocks(TOP / page)
    assert blocks
    names = {"np": np, "gp": gp}
    for block in blocks:
        exec(compile(block, page, "exec"), names)


def test_calls_of_the_table_exist():
    """The calls that docs/python.md gives for commands exist. A test of the command line holds its rows against clap."""
    rows = [line for line in (TOP / "docs/python.md").read_text().splitlines() if line.startswith("| `")]
    commands = {line.split("`")[1] for line in rows}
    assert {name for name, _ in _grainpath.cli_commands()} - {"help"} <= commands
    calls = re.findall(r"`gp\.([\w.]+)", "\n".join(rows))
    assert len(calls) >= 15
    for call in calls:
        found = gp
        for name in call.split("."):
            found = getattr(found, name)


def test_every_public_name_is_documented():
    for name in gp.__all__:
        if not name.startswith("__"):
            assert getattr(gp, name).__doc__, name


def test_the_command_line_is_in_the_package():
    ran = run("-m", "grainpath", "--version")
    assert ran.stdout == f"grainpath {gp.__version__}\n"
    assert run("-m", "grainpath", "run", "no.toml").returncode == 2


def test_the_wheel_has_the_licences_of_all_that_is_in_it():
    (file,) = [f for f in importlib.metadata.files("grainpath") if f.match("*.dist-info/licenses/licences.txt")]
    assert importlib.metadata.metadata("grainpath")["License-File"] == "licences.txt"
    text = file.read_text(encoding="utf-8")

    def table(of):
        return {tuple(line.split()[:2]) for line in of.split("\n\n")[1].splitlines()}

    told = run("-m", "grainpath", "licences").stdout
    beside = {name for name, _ in table(text) - table(told)}
    assert len(table(told)) > 100 and table(told) < table(text) and {"pyo3", "numpy", "ndarray"} <= beside
    # Our own texts, and those of the packages in the viewer.
    assert (TOP / "LICENSE-MIT").read_text() in text and (TOP / "LICENSE-APACHE").read_text() in text
    assert "three.js authors" in text


def test_a_call_costs_little():
    box = gp.box(3, 3, 0.4)
    times = []
    for _ in range(20):
        start = time.perf_counter()
        gp.Job(box).plan()
        times.append(time.perf_counter() - start)
    assert sorted(times)[2] < 0.05


def test_memory_stays_flat():
    import resource

    def many(n):
        for _ in range(n):
            gp.Mesh([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).vertices
            gp.Job(fill__density=0.3)
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = many(1000)
    assert many(10_000) - before < 8 * 1024
