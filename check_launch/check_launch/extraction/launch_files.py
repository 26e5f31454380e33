"""Descriptions of the launch files of a package: their arguments, and the nodes that they start."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest import mock

from check_launch.expansion.declarative_files import read_declarative
from check_launch.expansion.entities import UnreadableFileError
from check_launch.expansion.launch_context import Packages
from check_launch.expansion.python_files import NeedsMoreError, PythonFile
from check_launch.expansion.stored_files import stored_actions

_PATTERNS = ("*launch.py", "*launch.xml", "*launch.yaml")


def launch_files_of(folder: Path) -> Iterator[tuple[str, Any]]:
    """Yield the path and the description of each launch file of the package in a folder.

    Files that cannot be described are left out.
    """
    for path in sorted(found for pattern in _PATTERNS for found in (folder / "launch").glob(pattern)):
        try:
            if path.suffix == ".py":
                with mock.patch("tempfile.mktemp", _same_name):
                    actions = PythonFile(path, path.name, Packages([])).actions()
            else:
                actions, _ = read_declarative(path, path.name)
            yield path.relative_to(folder).as_posix(), stored_actions(actions)
        except (UnreadableFileError, NeedsMoreError, NotImplementedError):
            continue


def _same_name(suffix: str = "", prefix: str = "tmp", dir: str = "/tmp") -> str:  # noqa: S108  # as tempfile's
    """Return a name of a temporary file that is the same in each extraction."""
    return f"{dir}/{prefix}file{suffix}"
