"""Exceptions of grainpath. Each message says what is wrong, where, and what would be right.

All derive from :class:`GrainpathError`, so that one ``except`` catches them; wrong input is a ``ValueError`` too.
"""

from __future__ import annotations


class GrainpathError(Exception):
    """The base of all exceptions of grainpath.

    ``file`` and ``line`` are the place in a job or an input file, where the error has one.

    >>> import grainpath as gp
    >>> try:
    ...     gp.Job.from_text("[process]\\nwals = 3")
    ... except gp.GrainpathError as e:
    ...     print(e, e.line)
    job:2: unknown key `wals` in [process]; did you mean `walls`? 2
    """

    file: str | None
    line: int | None

    def __init__(self, message: str, file: str | None = None, line: int | None = None) -> None:
        super().__init__(message)
        self.file = file
        self.line = line


class JobError(GrainpathError, ValueError):
    """A job names something that does not exist, or contradicts itself; or an output cannot be written."""


class InputError(GrainpathError, ValueError):
    """A file or an array cannot be used."""


class PhysicsError(GrainpathError, RuntimeError):
    """A job cannot be met: the part is off the bed, no density gives the mass, or there is no solution."""


class Cancelled(GrainpathError):
    """The ``cancel`` token of a call was set."""


class InternalError(GrainpathError, RuntimeError):
    """An error of grainpath itself. Please report it with the job."""
