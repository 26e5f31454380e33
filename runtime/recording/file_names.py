"""Where the files of a recording are.

``run.mcap`` for the topics, ``run.datagrams.mcap`` beside it, and the parts of both when they rotate: ``run_1.mcap``,
``run_1.datagrams.mcap`` and so on.
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
    """The file of a new recording: what was given, or one named by the time in a folder that was given.

    Raises `SetupError` where it cannot be: another suffix, no such folder, a recording that is there already.
    """
    path = given / time.strftime(f"%Y-%m-%d_%H-%M-%S{SUFFIX}") if given.is_dir() else given
    if path.suffix != SUFFIX or path.name.endswith(DATAGRAMS + SUFFIX):
        raise SetupError(f"{path}: a recording is named something{SUFFIX}")
    if not path.parent.is_dir():
        raise SetupError(f"{path}: there is no folder {path.parent}")
    for kind in (TOPICS, DATAGRAMS):
        if (there := part_of(path, kind, 0)).exists():
            raise SetupError(f"{there} is there already; move it away, or give another name")
    return path


def part_of(path: Path, kind: str, number: int) -> Path:
    """The file of one kind (`TOPICS` or `DATAGRAMS`) with a part of the recording; 0 is the first part."""
    counted = f"_{number}" if number else ""
    return path.with_name(f"{path.stem}{counted}{kind}{SUFFIX}")


def files_of(path: Path) -> list[Path]:
    """The files that belong to a recording, of which any was named: itself, its parts, and its other half.

    Raises `SetupError` where it is not there.
    """
    if not path.is_file():
        raise SetupError(f"{path}: there is no such recording")
    stem = path.name.removesuffix(SUFFIX).removesuffix(DATAGRAMS)
    base = path.with_name(stem + SUFFIX)
    found = [file for kind in (TOPICS, DATAGRAMS) for file in _parts(base, kind)]
    return found if path in found else [path]


def _parts(base: Path, kind: str) -> list[Path]:
    parts = (part_of(base, kind, number) for number in itertools.count())
    return list(itertools.takewhile(Path.is_file, parts))


def is_datagrams(path: Path) -> bool:
    """Whether a file is the half of a recording that has the datagrams."""
    return path.name.endswith(DATAGRAMS + SUFFIX)
