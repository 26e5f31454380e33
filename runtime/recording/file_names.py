"""File names of a recording.

``run.mcap`` holds the topics and ``run.datagrams.mcap`` the datagrams. If a recording is split into parts of a certain
size, the next parts are ``run_1.mcap``, ``run_1.datagrams.mcap`` and so on.
"""

from __future__ import annotations

import itertools
import time
from pathlib import Path

from roverlink.runtime.core.errors import SetupError

SUFFIX = ".mcap"
TOPICS = ""
DATAGRAMS = ".datagrams"


def new_recording(given: Path) -> Path:
    """Return the path for a new recording; ``given`` is a file name or a folder.

    If ``given`` is a folder, the recording is a file in it that is named after date and time, such as
    ``2024-05-31_14-30-00.mcap``. Raises `SetupError` if the suffix is not ``.mcap``, the folder is missing, or the
    recording exists already.
    """
    path = given / time.strftime(f"%Y-%m-%d_%H-%M-%S{SUFFIX}") if given.is_dir() else given
    if path.suffix != SUFFIX or path.name.endswith(DATAGRAMS + SUFFIX):
        raise SetupError(f"{path}: the name of a recording must end with {SUFFIX} (and not with {DATAGRAMS}{SUFFIX})")
    if not path.parent.is_dir():
        raise SetupError(f"{path}: the folder {path.parent} does not exist")
    for kind in (TOPICS, DATAGRAMS):
        if (there := part_of(path, kind, 0)).exists():
            raise SetupError(f"{there}: exists already; move it away or choose another name")
    return path


def part_of(path: Path, kind: str, number: int) -> Path:
    """Return the path of one part of a recording: ``run.mcap`` -> ``run_1.datagrams.mcap``.

    ``kind`` is `TOPICS` or `DATAGRAMS`. ``number`` is 0 for the first part, which has no number in its name.
    """
    counted = f"_{number}" if number else ""
    return path.with_name(f"{path.stem}{counted}{kind}{SUFFIX}")


def files_of(path: Path) -> list[Path]:
    """Return all files of a recording from the path of any of its files: all parts, with topics and with datagrams.

    Raises `SetupError` if the file does not exist.
    """
    if not path.is_file():
        raise SetupError(f"{path}: no such file")
    stem = path.name.removesuffix(SUFFIX).removesuffix(DATAGRAMS)
    base = path.with_name(stem + SUFFIX)
    found = [file for kind in (TOPICS, DATAGRAMS) for file in _parts(base, kind)]
    return found if path in found else [path]


def _parts(base: Path, kind: str) -> list[Path]:
    parts = (part_of(base, kind, number) for number in itertools.count())
    return list(itertools.takewhile(Path.is_file, parts))


def is_datagrams(path: Path) -> bool:
    """Return true if a file holds the datagrams of a recording."""
    return path.name.endswith(DATAGRAMS + SUFFIX)
