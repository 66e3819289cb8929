"""Six notebooks, written out by ``python -m grainpath.notebooks FOLDER``.

Each is a page of text with blocks of Python, which :func:`notebook` divides into cells. They need no file: their parts
are made by the code in them.

>>> from grainpath import notebooks
>>> notebooks.names()
['continuous', 'ct', 'stress', 'supports', 'sweeps', 'woodgrain']
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from importlib import resources
from typing import Any

from ..errors import JobError


def names() -> list[str]:
    """The notebooks, by name."""
    files = (entry.name for entry in resources.files(__name__).iterdir())
    return sorted(name.removesuffix(".md") for name in files if name.endswith(".md"))


def page(name: str) -> str:
    """The page that a notebook is made of."""
    if name not in names():
        raise JobError(f"no notebook {name!r}; there are {', '.join(names())}")
    return resources.files(__name__).joinpath(f"{name}.md").read_text(encoding="utf-8")


def cells(name: str) -> list[tuple[str, str]]:
    """The cells of a notebook: ``markdown`` or ``code``, and the text.

    >>> from grainpath import notebooks
    >>> [kind for kind, _ in notebooks.cells("sweeps")][:2]
    ['markdown', 'code']
    """
    # With a group in the pattern every second piece is the inside of a block.
    pieces = re.split(r"^```python\n(.*?)^```$", page(name), flags=re.S | re.M)
    kinds = (("code" if k % 2 else "markdown", piece.strip()) for k, piece in enumerate(pieces))
    return [(kind, text) for kind, text in kinds if text]


def notebook(name: str) -> dict[str, Any]:
    """A notebook of Jupyter, format 4.5, without outputs. The same for the same page."""

    def cell(k: int, kind: str, text: str) -> dict[str, Any]:
        made: dict[str, Any] = {"cell_type": kind, "id": hashlib.sha256(f"{name} {k}".encode()).hexdigest()[:8]}
        made |= {"metadata": {}, "source": text.splitlines(keepends=True)}
        return made | {"execution_count": None, "outputs": []} if kind == "code" else made

    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    made = [cell(k, kind, text) for k, (kind, text) in enumerate(cells(name))]
    metadata = {"kernelspec": kernel, "language_info": {"name": "python"}}
    return {"cells": made, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}


def write(folder: str | os.PathLike[str]) -> list[str]:
    """Writes the notebooks into a folder, none over a file that is there already, and gives their paths."""
    folder = os.fspath(folder)
    paths = [os.path.join(folder, f"{name}.ipynb") for name in names()]
    for path in paths:
        # All names are looked at before the first is written.
        if os.path.exists(path):
            raise JobError(f"{path} is there already; name another folder", path)
    os.makedirs(folder, exist_ok=True)
    for path, name in zip(paths, names(), strict=True):
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            json.dump(notebook(name), file, indent=1, ensure_ascii=False)
            file.write("\n")
    return paths
