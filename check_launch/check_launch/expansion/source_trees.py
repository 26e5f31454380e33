"""Folders with sources, without those that colcon builds or ignores."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

_BUILT = frozenset({"build", "install", "log", "node_modules", "__pycache__"})
_IGNORED = frozenset({"COLCON_IGNORE", "AMENT_IGNORE"})


def source_folders(top: Path) -> Iterator[tuple[Path, list[str], list[str]]]:
    """Yield the folders below ``top``, each with the names of its folders and files, in the order of their names.

    Names that are removed from the list of folders are not entered, as with `os.walk`. Hidden folders, what colcon
    builds, and folders with a file COLCON_IGNORE are left out; ``top`` itself is not.
    """
    for folder, inner, files in os.walk(top):
        path = Path(folder)
        if path != top and _IGNORED & set(files):
            inner.clear()
            continue
        inner[:] = sorted(name for name in inner if not name.startswith(".") and name not in _BUILT)
        yield path, inner, sorted(files)
