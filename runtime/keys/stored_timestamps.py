"""File with the latest timestamp of each key, so that a restart accepts no recording and repeats no timestamp.

It is replaced in one step, and the disk has it before the old one is gone. After a power failure it is therefore
complete, and about a second old.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from roverlink.bounded_files import read_text
from roverlink.runtime.atomic_files import replacing

_HEADER = "# The latest timestamp of each key. roverlink writes this file; if it is lost, see docs/security.md.\n"
_END = "end"


def read_timestamps(path: Path) -> dict[int, int] | None:
    """Return the stored timestamps by key id; an empty dict if there is no file; None if the file is damaged."""
    try:
        *lines, last = read_text(path).splitlines()[1:] or [""]
    except FileNotFoundError:
        return {}
    except OSError:
        return None
    try:
        found = {int(id): int(timestamp) for id, timestamp in map(str.split, lines)}
    except ValueError:
        return None
    return found if last == _END else None


def write_timestamps(path: Path, timestamps: Mapping[int, int]) -> None:
    """Replace the file. Raises `OSError` if it cannot be written."""
    lines = (f"{id} {timestamp}\n" for id, timestamp in sorted(timestamps.items()))
    with replacing(path) as part, part.open("w", encoding="ascii") as file:
        file.write(f"{_HEADER}{''.join(lines)}{_END}\n")
        file.flush()
        os.fsync(file.fileno())
    folder = os.open(path.resolve().parent, os.O_RDONLY)
    try:
        os.fsync(folder)  # the replacement itself
    finally:
        os.close(folder)
