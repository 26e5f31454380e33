"""Files of a new project for `roverlink init`, in a folder without a mapping.yaml.

The project has one board, one message, and a GitHub workflow that checks the project in CI.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator import lock, source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.emit.render import render
from roverlink.generator.emit.writer import Change
from roverlink.generator.git import Repository
from roverlink.generator.init_rules import FileInTheWay, ProtosWithoutTable
from roverlink.generator.pipeline import compile_table

_TABLE, _PROTOS, _PROTO = "mapping.yaml", "proto", "proto/board.proto"
_TEMPLATES = {
    _TABLE: "mapping.yaml.j2",
    _PROTO: "board.proto.j2",
}
"""Files of the example: path and template of each."""
_ABOUT_REPOSITORY = {
    ".github/workflows/roverlink.yml": "workflow.yml.j2",
    ".pre-commit-config.yaml": "pre-commit-config.yaml.j2",
    ".gitignore": "gitignore.j2",
}
"""Files of every new project that the user edits after roverlink has created them: path and template of each."""


@dataclass(frozen=True, slots=True)
class NewProject:
    """Result of `new_project`: the files that a new project needs."""

    changes: tuple[Change, ...]
    """Files to write."""
    kept: tuple[str, ...]
    """Paths of files that exist already and are not overwritten."""
    source: str
    """Argument of ``pip install`` in the GitHub workflow; empty if the user has to fill it in."""


@dataclass(frozen=True, slots=True)
class UserFiles:
    """Files that a new project needs, and that the user edits from then on."""

    texts: dict[str, str]
    """Text of each file that does not exist yet, by path."""
    kept: tuple[str, ...]
    """Paths of files that exist already. They belong to the user, who may have edited them."""


def files_about_repository(folder: Path, source: str) -> UserFiles:
    """Return the workflow, the configuration for pre-commit and the .gitignore file of a project in a folder.

    They fit the git repository: its default branch, its submodules, and the place of the project in it. ``source`` is
    the argument of ``pip install`` in the workflow.
    """
    top = Path(source_files.repository_top(str(folder.resolve())) or folder.resolve())
    place = folder.resolve().relative_to(top).as_posix()
    return _rendered(
        folder,
        _ABOUT_REPOSITORY,
        source=source,
        place="" if place == "." else place,
        branch=Repository(folder).branch_to_compare().rpartition("/")[2] or "main",
        submodules=(top / ".gitmodules").exists(),
    )


def _rendered(folder: Path, templates: Mapping[str, str], **facts: object) -> UserFiles:
    kept = tuple(path for path in templates if (folder / path).exists())
    texts = {path: render(f"project/{template}", **facts) for path, template in templates.items() if path not in kept}
    return UserFiles(texts, kept)


def new_project(folder: Path, package: str, source: str = "") -> NewProject:
    """Return the files of a new project with one board and one message. Nothing is written.

    ``folder`` has no mapping.yaml yet. ``package`` is the name of the ROS 2 package. ``source`` is the argument of
    ``pip install`` from which the GitHub workflow installs roverlink; empty if the user has to fill it in. Raises
    `DiagnosticsError` if the project would overwrite the user's files.
    """
    if findings := list(_foreign_protos(folder)):
        raise DiagnosticsError(findings)
    example, about = _rendered(folder, _TEMPLATES, package=package), files_about_repository(folder, source)
    own, kept = {**example.texts, **about.texts}, (*example.kept, *about.kept)
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
