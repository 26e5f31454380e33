"""Starting a project in a folder without a table: one board, one message, and what checks them."""

from __future__ import annotations

import tempfile
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator import lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.emit.render import REGENERATE, render
from roverlink.generator.emit.writer import Change, compare
from roverlink.generator.init_rules import IN_THE_WAY, PROTOS_WITHOUT_TABLE
from roverlink.generator.pipeline import compile_table

_TABLE, _PROTOS = "mapping.yaml", "proto"
_TEMPLATES = {
    _TABLE: "mapping.yaml.j2",
    f"{_PROTOS}/board.proto": "board.proto.j2",
    ".github/workflows/roverlink.yml": "workflow.yml.j2",
    ".pre-commit-config.yaml": "pre-commit-config.yaml.j2",
    ".gitignore": "gitignore.j2",
}
"""The files that belong to the user, and the template of each."""


@dataclass(frozen=True, slots=True)
class NewProject:
    """The files of a project that is to be started."""

    changes: tuple[Change, ...]
    """The files that are to be written."""
    kept: tuple[str, ...]
    """The files that are there already, and stay as they are."""


def new_project(folder: Path, package: str) -> NewProject:
    """Make the files of a project with one board and one message, for a folder without a table. Nothing is written.

    ``package`` is the ROS 2 package's name. Raises `DiagnosticsError` where files are in the way.
    """
    if findings := list(_foreign_protos(folder)):
        raise DiagnosticsError(findings)
    kept = tuple(path for path in _TEMPLATES if (folder / path).exists())
    own = {
        path: render(f"project/{template}", package=package)
        for path, template in _TEMPLATES.items()
        if path not in kept
    }
    with tempfile.TemporaryDirectory(prefix="roverlink-") as copy:  # lest a fault leave half a project
        for path in (*kept, lock.NAME):  # a ledger without a table still knows which numbers are taken
            if (folder / path).is_file():
                _put(Path(copy, path), (folder / path).read_bytes())
        for path, text in own.items():
            _put(Path(copy, path), text.encode())
        compiled = compile_table(Path(copy, _TABLE))
    changes = compare(folder, {**own, **compiled.files}, compiled.folders)
    check_the_way(changes)
    return NewProject(tuple(changes), kept)


def _put(target: Path, data: bytes) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(data)


def _foreign_protos(folder: Path) -> Iterable[Diagnostic]:
    """Find .proto files that a new project would not know."""
    for path in sorted((folder / _PROTOS).rglob("*.proto")):
        name = path.relative_to(folder).as_posix()
        if name not in _TEMPLATES:
            help = f"`roverlink init --from {_PROTOS}` takes the folder over"
            yield PROTOS_WITHOUT_TABLE.at(Span(name), "is there already, and a new project has no row for it", help)


def check_the_way(changes: Iterable[Change], besides: Collection[str] = ()) -> None:
    """Refuse to overwrite what was not generated, but for some files. Raises `DiagnosticsError`."""
    theirs = [
        change.path
        for change in changes
        if change.before is not None and change.path not in besides and REGENERATE not in change.before
    ]
    if theirs:
        raise DiagnosticsError(
            [IN_THE_WAY.at(Span(path), "is there already, and was not generated", "move it away") for path in theirs]
        )
