"""Last step of the compiler: compares the generated files with the disk, and writes them.

No other module writes generated files. Only files inside the project are written, and a file is replaced only if it
carries the header of generated files, or if the caller says that it belongs to roverlink.
"""

from __future__ import annotations

import contextlib
import difflib
import os
import re
from collections.abc import Collection, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from roverlink.bounded_files import RefusedFileError
from roverlink.generator import journal, source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.emit.output_rules import CannotWrite, ForeignFile, OutsideTheProject
from roverlink.generator.emit.render import carries_header

_TABLE = "mapping.yaml"
_MARK_WITHIN = 4096  # bytes; the header is at the top
_LARGEST = 64 << 20  # bytes of a generated file; larger ones were not generated


@dataclass(frozen=True, slots=True)
class Change:
    """File that has to be written or removed. ``before`` is None for a new file, and ``after`` for a file to remove."""

    path: str
    before: str | None
    after: str | None
    foreign: bool = False
    """True if there is a file that roverlink did not write, so that it may be replaced only if the user says so."""

    @property
    def verb(self) -> str:
        """Verb for the change: "added", "changed" or "removed"."""
        if self.before is None:
            return "added"
        return "removed" if self.after is None else "changed"

    def diff(self) -> str:
        """Return the change of the file as a unified diff."""
        before = f"a/{self.path}" if self.before is not None else os.devnull
        after = f"b/{self.path}" if self.after is not None else os.devnull
        return "".join(difflib.unified_diff(_lines(self.before), _lines(self.after), before, after))


def _lines(text: str | None) -> list[str]:
    """Return the lines of a text for a diff. If the last line has no newline, a note for this is added."""
    lines = re.findall(r"[^\n]*\n|[^\n]+", text or "")
    return [line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines]


def compare(
    project: Path, files: Mapping[str, str], folders: Mapping[str, str], own: Collection[str] = ()
) -> list[Change]:
    """Return the changes that make the files on disk equal to ``files``: the generated texts by path.

    ``folders`` are the folders of the project that may contain generated files, with what the names of these files end
    with. If a generated file in these folders is not in ``files``, it is removed. ``own`` are the paths of files that
    belong to roverlink although they do not carry the header of generated files, such as the ledger. Raises
    `DiagnosticsError` for paths outside the project, and for a file that cannot be read.
    """
    _must_be_inside(project, files)
    changes = [_change(project, path, text, own) for path, text in files.items()]
    left = {path for folder, suffix in folders.items() for path in _left(project, folder, suffix, files, own)}
    stale = [Change(path, _text(project, path), None) for path in sorted(left)]
    return sorted(
        (change for change in (*changes, *stale) if change.before != change.after), key=lambda change: change.path
    )


def write(project: Path, changes: Iterable[Change], overwrite: bool = False) -> None:
    """Write and remove the files of a project as the changes say, all of them or none.

    Raises `DiagnosticsError` for a file that cannot be written, and for a file that roverlink did not write, unless
    ``overwrite`` is set.
    """
    changes = list(changes)
    if not overwrite:
        refuse_foreign(changes)
    try:
        journal.switch(project, [(change.path, change.before, change.after) for change in changes])
    except OSError as error:
        removed = any(change.path == error.filename and change.after is None for change in changes)
        raise _unable(str(error.filename), "remove" if removed else "write", error) from error


def refuse_foreign(changes: Iterable[Change]) -> None:
    """Raise `DiagnosticsError` if a change would overwrite a file that roverlink did not write."""
    help = (
        "move it to another place, or replace it with `roverlink generate --overwrite`; "
        "an envelope that you edit yourself needs `owner: proto` in mapping.yaml"
    )
    theirs = [change.path for change in changes if change.foreign]
    if theirs:
        message = "the file exists and was not generated"
        raise DiagnosticsError([ForeignFile.at(Span(path), message, help) for path in theirs])


def _must_be_inside(project: Path, paths: Iterable[str]) -> None:
    outside = [path for path in paths if journal.place_of(project, path) is None]
    if outside:
        raise DiagnosticsError([_outside(path) for path in outside])


def _outside(path: str) -> Diagnostic:
    if ".." in Path(path).parts:
        message = f"cannot write {path!r}: it is outside the project"
        help = "if another project owns the envelope, write `owner: proto`; else move the .proto files into this one"
    else:
        message = f"cannot write {path!r}: a symbolic link in its path leads outside the project, or into .git"
        help = "replace the link by a folder or a file"
    return OutsideTheProject.at(Span(path), message, help)


def _change(project: Path, path: str, after: str, own: Collection[str]) -> Change:
    before = _text(project, path)
    # An empty file has nothing that could be lost.
    foreign = before is not None and path not in own and bool(before.strip()) and not carries_header(before)
    return Change(path, before, after, foreign)


@contextlib.contextmanager
def _reporting(path: str, action: str) -> Iterator[None]:
    """Convert an `OSError` to a diagnostic that says "cannot <action> the file"."""
    try:
        yield
    except OSError as error:
        raise _unable(path, action, error) from error


def _unable(path: str, action: str, error: OSError) -> DiagnosticsError:
    message = f"cannot {action} the file: {error.strerror}"
    help = "check the permissions of the file and its folder, and that no folder has the name of the file"
    return DiagnosticsError([CannotWrite.at(Span(path), message, help)])


def _text(project: Path, path: str) -> str | None:
    with _reporting(path, "read"):
        try:
            return source_files.read(project, path, _LARGEST).decode("utf-8", errors="replace")
        except (FileNotFoundError, NotADirectoryError):
            return None


def _left(project: Path, top: str, suffix: str, files: Container[str], own: Container[str]) -> Iterable[str]:
    """Yield the paths of files in a folder of the project that roverlink once generated, by their header or by ``own``.

    ``suffix`` is the end of their names. Those in ``files``, links, and folders that belong to another project or
    another repository, are left out.
    """
    for folder, folders_in, names in os.walk(project / top):
        folders_in[:] = [folder_name for folder_name in folders_in if not _is_other_project(Path(folder, folder_name))]
        for path in (Path(folder, name) for name in names if name.endswith(suffix) and not name.endswith(".pyc")):
            name = path.relative_to(project).as_posix()
            if name not in files and not path.is_symlink() and path.is_file() and (name in own or _is_ours(path)):
                yield name


def _is_other_project(folder: Path) -> bool:
    return folder.name == ".git" or any(os.path.lexists(folder / name) for name in (_TABLE, ".git"))


def _is_ours(path: Path) -> bool:
    try:
        with source_files.open_file(path.parent, path.name) as file:
            return carries_header(file.read(_MARK_WITHIN).decode("utf-8", errors="replace"))
    except (PermissionError, RefusedFileError):  # files that roverlink wrote are readable
        return False
