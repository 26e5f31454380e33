"""Files of a new project for `roverlink init`, in a folder without a mapping.yaml.

The project has one board, one message, and a GitHub workflow that checks the project in CI.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator import lock, source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.emit.render import render
from roverlink.generator.emit.writer import Change
from roverlink.generator.init_rules import FileInTheWay, ProtosWithoutTable
from roverlink.generator.pipeline import compile_table

_TABLE, _PROTOS, _PROTO = "mapping.yaml", "proto", "proto/board.proto"
_TEMPLATES = {
    _TABLE: "mapping.yaml.j2",
    _PROTO: "board.proto.j2",
    ".github/workflows/roverlink.yml": "workflow.yml.j2",
    ".pre-commit-config.yaml": "pre-commit-config.yaml.j2",
    ".gitignore": "gitignore.j2",
}
"""Files that the user edits after roverlink has created them: path and template of each."""


@dataclass(frozen=True, slots=True)
class NewProject:
    """Result of `new_project`: the files that a new project needs."""

    changes: tuple[Change, ...]
    """Files to write."""
    kept: tuple[str, ...]
    """Paths of files that exist already and are not overwritten."""
    source: str
    """Argument of ``pip install`` in the GitHub workflow; empty if the user has to fill it in."""


def new_project(folder: Path, package: str, source: str = "") -> NewProject:
    """Return the files of a new project with one board and one message. Nothing is written.

    ``folder`` has no mapping.yaml yet. ``package`` is the name of the ROS 2 package. ``source`` is the argument of
    ``pip install`` from which the GitHub workflow installs roverlink; empty if the user has to fill it in. Raises
    `DiagnosticsError` if the project would overwrite the user's files.
    """
    if findings := list(_foreign_protos(folder)):
        raise DiagnosticsError(findings)
    # A file that exists belongs to the user, who may have edited it.
    kept = tuple(path for path in _TEMPLATES if (folder / path).exists())
    own = {
        path: render(f"project/{template}", package=package, source=source)
        for path, template in _TEMPLATES.items()
        if path not in kept
    }
    with tempfile.TemporaryDirectory(
        prefix="roverlink-"
    ) as copy:  # so that an error does not leave half a project behind
        for path in (*kept, lock.NAME):  # without a table, the ledger still knows the taken numbers
            if (folder / path).exists():
                _put(Path(copy, path), _content(folder, path))
        for path, text in own.items():
            _put(Path(copy, path), text.encode())
        try:
            compiled = compile_table(Path(copy, _TABLE))
        except DiagnosticsError as error:
            if _PROTO in kept and any(finding.span.file == _TABLE for finding in error.findings):
                raise DiagnosticsError([_foreign(_PROTO)]) from error  # the table does not fit the user's file
            raise DiagnosticsError(error.findings, own) from error
    changes = compiled.changes(folder, own)
    refuse_overwriting(changes)
    return NewProject(tuple(changes), kept, source)


def _content(folder: Path, path: str) -> bytes:
    try:
        return source_files.read(folder, path)
    except OSError as error:
        message = f"the file cannot be read: {error.strerror}"
        raise DiagnosticsError([FileInTheWay.at(Span(path), message, "move it to another place")]) from error


def _put(target: Path, data: bytes) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(data)


def _foreign_protos(folder: Path) -> Iterable[Diagnostic]:
    """Yield a diagnostic for each .proto file of the user, because the new mapping.yaml would have no row for it."""
    for path in sorted((folder / _PROTOS).rglob("*.proto")):
        name = path.relative_to(folder).as_posix()
        if name not in _TEMPLATES:
            yield _foreign(name)


def _foreign(path: str) -> Diagnostic:
    """Return the diagnostic for a .proto file of the user, which the table of a new project does not fit."""
    help = f"use `roverlink init --from {_PROTOS}`, which drafts a table for the files in the folder"
    return ProtosWithoutTable.at(
        Span(path), "the file exists already, and a new project would have no row for it", help
    )


def refuse_overwriting(changes: Iterable[Change]) -> None:
    """Raise `DiagnosticsError` if a change would overwrite a file that roverlink did not generate."""
    theirs = [change.path for change in changes if change.foreign]
    if theirs:
        raise DiagnosticsError(
            [
                FileInTheWay.at(Span(path), "the file exists and was not generated", "move it to another place")
                for path in theirs
            ]
        )
