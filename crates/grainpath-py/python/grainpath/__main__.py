"""The command line: ``python -m grainpath`` and the script ``grainpath``."""

from __future__ import annotations

import os
import sys

from ._grainpath import cli


def main() -> int:
    """Runs the command of ``sys.argv``."""
    # `grainpath run --scheduler` starts Python again: this one, which has the package.
    os.environ.setdefault("GRAINPATH_PYTHON", sys.executable)
    return cli(["grainpath", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
