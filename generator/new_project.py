"""New project in a folder without a table: one board, one message, and a workflow that checks the project in CI."""

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
"""Path of each file that belongs to the user, and the template of the file."""


@dataclass(frozen=True, slots=True)
class NewProject:
    """Files of a new project."""

    changes: tuple[Change, ...]
    """Files to write."""
    kept: tuple[str, ...]
    """Paths of files that exist already and are not overwritten."""


def new_project(folder: Path, package: str) -> NewProject:
    """Return the files of a project with one board and one message, for a folder without a table. Nothing is written.

    ``package`` is the name of the ROS 2 package. Raises `DiagnosticsError` if the project would overwrite the user's
    files.
    """
    if findings := list(_foreign_protos(folder)):
        raise DiagnosticsError(findings)
    # A file that exists belongs to the user, who may have edited it.
    kept = tuple(path for path in _TEMPLATES if (folder / path).exists())
    own = {
        path: render(f"project/{template}", package=package)
        for path, template in _TEMPLATES.items()
        if path not in kept
    }
    with tempfile.TemporaryDirectory(
        prefix="roverlink-"
    ) as copy:  # so that an error does not leave half a project behind
        for path in (*kept, lock.NAME):  # without a table, the ledger still knows the taken numbers
            if (folder / path).is_file():
                _put(Path(copy, path), (folder / path).read_bytes())
        for path, text in own.items():
            _put(Path(copy, path), text.encode())
        compiled = compile_table(Path(copy, _TABLE))
    changes = compare(folder, {**own, **compiled.files}, compiled.folders)
    refuse_overwriting(changes)
    return NewProject(tuple(changes), kept)


def _put(target: Path, data: bytes) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(data)


def _foreign_protos(folder: Path) -> Iterable[Diagnostic]:
    """Yield a diagnostic for each .proto file in the folder, because the new project's table has no row for it."""
    for path in sorted((folder / _PROTOS).rglob("*.proto")):
        name = path.relative_to(folder).as_posix()
        if name not in _TEMPLATES:
            help = f"`roverlink init --from {_PROTOS}` drafts a table for the files in the folder"
            yield PROTOS_WITHOUT_TABLE.at(
                Span(name), "the file exists, and a new project would have no row for it", help
            )


def refuse_overwriting(changes: Iterable[Change], besides: Collection[str] = ()) -> None:
    """Raise `DiagnosticsError` if a change would overwrite a file that roverlink did not generate, except `besides`."""
    theirs = [
        change.path
        for change in changes
        if change.before is not None and change.path not in besides and REGENERATE not in change.before
    ]
    if theirs:
        raise DiagnosticsError(
            [
                IN_THE_WAY.at(Span(path), "the file exists and was not generated", "move it to another place")
                for path in theirs
            ]
        )
