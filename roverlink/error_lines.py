"""Lines about the errors that end a command: the part of the guard in `__main__` that is slow to import."""

from __future__ import annotations

import os
import sys
import traceback

from roverlink.installed_packages import cure

_DEBUG = "ROVERLINK_DEBUG"
"""Environment variable that shows where an error was raised."""
_OF_THE_SYSTEM = {MemoryError: "out of memory", RecursionError: "nested too deeply"}


def print_line(error: Exception) -> bool:
    """Print the reason why a command ended, in one line; return false for an exception that only a bug raises.

    With the environment variable ROVERLINK_DEBUG, its traceback is printed in front.
    """
    if (line := _line(error)) is None:
        return False
    if os.environ.get(_DEBUG):
        traceback.print_exception(error)
    print(f"roverlink: {line}", file=sys.stderr)  # not with `console`, which may be what cannot be imported
    try:
        sys.stdout.flush()
    except OSError:  # the disk is full; Python flushes stdout at exit, which must not fail again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return True


def _line(error: Exception) -> str | None:
    if isinstance(error, ImportError):
        return cure(error)
    from roverlink.runtime.core.errors import RoverlinkError

    if isinstance(error, RoverlinkError):
        return str(error)
    if isinstance(error, RuntimeError) and isinstance(error.__context__, OSError):
        return _line(error.__context__)  # before Python 3.13, `Path.resolve` raises it for a loop of links
    if isinstance(error, OSError) and error.filename and error.strerror:
        return " ".join(f"{error.filename}: {error.strerror}".split())
    if isinstance(error, (OSError, ValueError, OverflowError, RecursionError, MemoryError)):
        reason = _OF_THE_SYSTEM.get(type(error)) or getattr(error, "strerror", None) or str(error)
        return f"{' '.join(reason.split())} ({type(error).__name__}; {_DEBUG}=1 shows where)"
    return None
