"""The last phase: the one place that compares with the disk, and the one that writes."""

from __future__ import annotations

import contextlib
import difflib
import os
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from generator.findings import FindingsError, Rule, Severity, Span
from generator.targets.rendering import REGENERATE

CANNOT_WRITE = Rule("OUT101", "cannot-write", Severity.FATAL)

_FOLDER = "generated"
_MARK_WITHIN = 400  # bytes; the header is at the top


@dataclass(frozen=True, slots=True)
class Change:
    """A file that is not what it should be. ``before`` or ``after`` is None where there is no file."""

    path: str
    before: str | None
    after: str | None

    @property
    def verb(self) -> str:
        """What becomes of the file."""
        if self.before is None:
            return "added"
        return "removed" if self.after is None else "changed"

    def diff(self) -> str:
        """The change as a unified diff."""
        before, after = ((text or "").splitlines(keepends=True) for text in (self.before, self.after))
        return "".join(difflib.unified_diff(before, after, f"a/{self.path}", f"b/{self.path}"))


def compare(project: Path, files: Mapping[str, str]) -> list[Change]:
    """How the disk differs from the files that should be there, generated files that should not be included."""
    changes = [Change(path, _text(project / path), text) for path, text in files.items()]
    stale = [Change(path, _text(project / path), None) for path in _generated(project) if path not in files]
    return sorted(
        (change for change in (*changes, *stale) if change.before != change.after), key=lambda change: change.path
    )


def write(project: Path, changes: Iterable[Change]) -> None:
    """Make the disk what it should be; each file is replaced as a whole.

    Raises `FindingsError` for a file that cannot be written.
    """
    for change in changes:
        path = project / change.path
        try:
            if change.after is None:
                _remove(path, project / _FOLDER)
            else:
                _replace(path, change.after)
        except OSError as error:
            raise FindingsError([CANNOT_WRITE.at(Span(change.path), f"cannot be written: {error.strerror}")]) from error


def _text(path: Path) -> str | None:
    try:
        return path.read_bytes().decode("utf-8", errors="replace")
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise FindingsError([CANNOT_WRITE.at(Span(str(path)), f"cannot be read: {error.strerror}")]) from error


def _generated(project: Path) -> Iterable[str]:
    """The files that an earlier run generated, known by their header; what users put beside them is not ours."""
    for path in sorted((project / _FOLDER).rglob("*")):
        if path.is_file() and path.suffix != ".pyc" and _is_ours(path):
            yield path.relative_to(project).as_posix()


def _is_ours(path: Path) -> bool:
    with path.open("rb") as file:
        return REGENERATE.encode() in file.read(_MARK_WITHIN)


def _replace(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(text.encode())
        os.chmod(temporary, path.stat().st_mode if path.exists() else 0o666 & ~_umask())
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(temporary)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _remove(path: Path, stop: Path) -> None:
    """Remove a file, and the folders that it leaves empty."""
    path.unlink()
    for folder in path.parents:
        if folder == stop or any(child.name != "__pycache__" for child in folder.iterdir()):
            return
        for child in folder.iterdir():
            for compiled in child.iterdir():
                compiled.unlink()
            child.rmdir()
        folder.rmdir()
