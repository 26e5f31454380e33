"""Places in files: the line and column of what a launch file or parameter file says."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A place in a file. Line and column count from 1; 0 if they are not known."""

    file: str
    line: int = 0
    column: int = 0
