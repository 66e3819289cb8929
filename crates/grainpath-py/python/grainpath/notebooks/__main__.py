"""``python -m grainpath.notebooks FOLDER``."""

from __future__ import annotations

import sys

from ..errors import GrainpathError
from . import write

if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
    sys.exit("usage: python -m grainpath.notebooks FOLDER")
try:
    print("\n".join(write(sys.argv[1])))
except (GrainpathError, OSError) as error:
    sys.exit(f"grainpath: {error}")
