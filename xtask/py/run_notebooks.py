"""Runs every notebook of the package in a kernel of Jupyter, and says how long each takes.

    python run_notebooks.py FOLDER

FOLDER gets the notebooks with their outputs, to be looked at.
"""

import json
import os
import sys
import time

import nbclient
import nbformat

from grainpath import notebooks

if __name__ == "__main__":
    os.makedirs(sys.argv[1], exist_ok=True)
    for name in notebooks.names():
        start = time.perf_counter()
        notebook = nbformat.reads(json.dumps(notebooks.notebook(name)), as_version=4)
        nbformat.validate(notebook)
        nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3").execute(cwd=sys.argv[1])
        nbformat.write(notebook, os.path.join(sys.argv[1], f"{name}.ipynb"))
        shown = sum(bool(cell.get("outputs")) for cell in notebook.cells)
        print(f"{name:<12} {time.perf_counter() - start:6.1f} s, {shown} cells with outputs", flush=True)
