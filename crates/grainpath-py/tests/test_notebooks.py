"""The notebooks: their format, that they are written whole, and the shortest one run. `cargo xtask python --release`
runs all of them in a kernel of Jupyter."""

import json
import subprocess
import sys

import pytest

import grainpath as gp
from grainpath import notebooks

#: The shortest in time.
SHORTEST = "sweeps"


def test_the_shortest_notebook_runs():
    names = {}
    code = [text for kind, text in notebooks.cells(SHORTEST) if kind == "code"]
    assert len(code) == 3
    for text in code:
        exec(compile(text, SHORTEST, "exec"), names)
    assert not names["second"].failed


@pytest.mark.parametrize("name", notebooks.names())
def test_notebooks_have_the_format_of_jupyter(name):
    made = notebooks.notebook(name)
    assert (made["nbformat"], made["nbformat_minor"]) == (4, 5)
    ids = [cell["id"] for cell in made["cells"]]
    assert len(set(ids)) == len(ids) >= 4
    assert made["cells"][0]["cell_type"] == "markdown" and made["cells"][0]["source"][0].startswith("# ")
    code = ["".join(cell["source"]) for cell in made["cells"] if cell["cell_type"] == "code"]
    assert len(code) >= 3 and any("import grainpath as gp" in text for text in code)
    for text in code:
        compile(text, name, "exec")
    # Nothing of a notebook may be a file that only its author has.
    assert not any("open(" in text for text in code)


def test_notebooks_are_written_and_never_over_others(tmp_path):
    ran = subprocess.run(
        [sys.executable, "-m", "grainpath.notebooks", tmp_path / "new"], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    paths = sorted((tmp_path / "new").glob("*.ipynb"))
    assert [path.stem for path in paths] == notebooks.names() and len(paths) == 6
    assert json.loads(paths[0].read_text()) == notebooks.notebook(paths[0].stem)
    with pytest.raises(gp.JobError, match="is there already"):
        notebooks.write(tmp_path / "new")
    with pytest.raises(gp.JobError, match="no notebook 'x'; there are continuous"):
        notebooks.notebook("x")
