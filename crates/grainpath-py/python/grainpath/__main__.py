"""The command line: ``python -m grainpath`` and the script ``grainpath``."""

from __future__ import annotations

import sys

from ._grainpath import cli


def main() -> int:
    """Runs the command of ``sys.argv``."""
    return cli(["grainpath", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
