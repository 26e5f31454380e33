"""Last step of the compiler: compares the generated files with the disk, and writes them.

No other module writes generated files.
"""

from __future__ import annotations

import contextlib
import difflib
import os
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator.diagnostics import DiagnosticsError, Span
from roverlink.generator.emit.output_rules import CANNOT_WRITE
from roverlink.generator.emit.render import REGENERATE

_MARK_WITHIN = 400  # bytes; the header is at the top


@dataclass(frozen=True, slots=True)
class Change:
    """File that has to be written or removed. ``before`` is None for a new file, and ``after`` for a file to remove."""

    path: str
    before: str | None
    after: str | None

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


def compare(project: Path, files: Mapping[str, str], folders: Iterable[str]) -> list[Change]:
    """Return the changes that give the files on disk the wanted texts.

    ``folders`` are the folders of the project that may contain generated files. A generated file in them that is not
    among the wanted files is removed.
    """
    changes = [Change(path, _text(project, path), text) for path, text in files.items()]
    stale = [Change(path, _text(project, path), None) for path in _generated(project, folders) if path not in files]
    return sorted(
        (change for change in (*changes, *stale) if change.before != change.after), key=lambda change: change.path
    )


def write(project: Path, changes: Iterable[Change]) -> None:
    """Write and remove files as the changes say.

    All texts are first written to temporary files. Then each file is replaced atomically. Raises `DiagnosticsError` for
    a file that cannot be written.
    """
    changes = list(changes)
    with contextlib.ExitStack() as prepared:
        replacements = []
        for change in changes:
            if change.after is not None:
                with _reporting(change.path, "write"):
                    temporary = _prepare(project / change.path, change.after)
                prepared.callback(temporary.unlink, missing_ok=True)
                replacements.append((change.path, temporary))
        for path, temporary in replacements:
            with _reporting(path, "write"):
                temporary.replace(project / path)
    for change in changes:
        if change.after is None:
            with _reporting(change.path, "remove"):
                _remove(project / change.path, project / Path(change.path).parts[0])


@contextlib.contextmanager
def _reporting(path: str, action: str) -> Iterator[None]:
    """Convert an `OSError` to a diagnostic that says "cannot <action> the file"."""
    try:
        yield
    except OSError as error:
        raise DiagnosticsError([CANNOT_WRITE.at(Span(path), f"cannot {action} the file: {error.strerror}")]) from error


def _text(project: Path, path: str) -> str | None:
    with _reporting(path, "read"):
        try:
            return (project / path).read_bytes().decode("utf-8", errors="replace")
        except (FileNotFoundError, NotADirectoryError):
            return None


def _generated(project: Path, folders: Iterable[str]) -> Iterable[str]:
    """Yield the generated files in folders of the project. Their header tells that roverlink generated them."""
    for folder in folders:
        for path in sorted((project / folder).rglob("*")):
            if path.is_file() and path.suffix != ".pyc" and _is_ours(path):
                yield path.relative_to(project).as_posix()


def _is_ours(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return REGENERATE.encode() in file.read(_MARK_WITHIN)
    except PermissionError:  # files that roverlink wrote are readable
        return False


def _prepare(path: Path, text: str) -> Path:
    """Write a text to a temporary file beside ``path``, and return its path.

    The temporary file is in the same folder, because a file of another file system cannot be replaced atomically.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    temporary = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(text.encode())
        temporary.chmod(path.stat().st_mode if path.exists() else 0o666 & ~_umask())
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    return temporary


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _remove(path: Path, stop: Path) -> None:
    """Remove a file, and the folders above it that are empty afterwards; ``stop`` and the folders above it are kept."""
    path.unlink()
    for folder in path.parents:
        if folder == stop or any(child.name != "__pycache__" for child in folder.iterdir()):
            return
        for child in folder.iterdir():
            for compiled in child.iterdir():
                compiled.unlink()
            child.rmdir()
        folder.rmdir()
