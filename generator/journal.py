"""Switch of several files from their old to their new content: both or neither, even if the process is killed.

The folder `FOLDER` exists only while files are switched:

1. Copies of the new and of the old contents are written to it. A process that is killed here has changed no file.
2. The journal appears in it, in one step. It has the path of each file, and the digests of the old and the new content.
3. The files are replaced, each in one step. If one of them cannot be replaced, the journal gets the name that means
   "roll back", and the old contents return.
4. The journal is removed, then the folder.

A process that is killed in steps 2 to 4 leaves the journal, and `finish` does the rest. A file whose content is neither
the old nor the new one was changed by somebody else since, and is left as it is.

The journal may come from a stranger, for example in a pull request. So it is followed only inside the project and
outside of ``.git``, where the pull request itself can put any file.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import hashlib
import json
import os
import re
import shutil
import stat
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

FOLDER = ".roverlink-unfinished"
"""Folder of a project in which the contents wait for the switch. If it exists, a command was interrupted, or runs."""

_PART, _COMPLETE, _ROLL_BACK = "journal.part", "complete.json", "roll-back.json"
_OURS = re.compile(r"(new|old)-[0-9]+|journal\.part|complete\.json|roll-back\.json")
_COMPILED = "__pycache__"


@dataclass(frozen=True, slots=True)
class Finished:
    """Result of `finish`: what became of an interrupted switch."""

    completed: bool
    """True if the files have their new content, False if they have their old one."""
    left: tuple[str, ...]
    """Paths of files that somebody else has changed since the interruption, and that were not touched."""


@dataclass(frozen=True, slots=True)
class _Step:
    """File to switch, with the digests of its old and its new content. A digest is None where there is no file."""

    path: str
    old: str | None
    new: str | None


@dataclass(frozen=True, slots=True)
class _Journal:
    steps: tuple[_Step, ...]
    folders: tuple[str, ...]
    """Folders that the switch creates, the outer ones first."""


def place_of(project: Path, path: str) -> Path | None:
    """Return where a file of the project is after all symbolic links; None if this is outside, or inside ``.git``."""
    root = os.path.realpath(project)  # as texts: this is asked for hundreds of files, and paths are slow
    place = os.path.realpath(os.path.join(root, path))
    inside = place.removeprefix(root.rstrip(os.sep) + os.sep)
    return None if inside == place or ".git" in inside.casefold().split(os.sep) else Path(place)


def switch(project: Path, changes: Iterable[tuple[str, str | None, str | None]]) -> None:
    """Give files of a project their new content: all of them or, if an error is raised, none.

    Each change is a path, the expected old text and the new text; a text is None where there is no file. Folders that
    become empty are removed. Raises `OSError`, whose filename is the path, for a file that cannot be written, or that
    somebody else has changed.
    """
    if not (changes := list(changes)):
        return
    with _locked(project):
        _finish(project)
        folder = project / FOLDER
        with _naming(FOLDER):
            folder.mkdir(mode=0o700)
        try:
            steps = tuple(_staged(project, index, *change) for index, change in enumerate(changes))
            journal = _Journal(steps, _missing_folders(project, steps))
            _write_journal(folder, journal)
        except BaseException:
            _discard(folder)
            raise
        try:
            _apply(project, journal, "new")
        except BaseException:
            _roll_back(project, journal)
            _discard(folder)
            raise
        _discard(folder)


def finish(project: Path) -> Finished | None:
    """Complete the switch that a killed process has left in a project, or roll it back; None if there is none.

    Waits for a process that is switching files right now. Raises `OSError` if this is not possible, or if `FOLDER` is
    not a folder that roverlink has left.
    """
    if not os.path.lexists(project / FOLDER):
        return None
    with _locked(project):
        return _finish(project)


def _finish(project: Path) -> Finished | None:
    folder = project / FOLDER
    if not os.path.lexists(folder):  # another process has done it
        return None
    _must_be_ours(project, folder)
    left: list[str] = []
    completed = False
    if (folder / _ROLL_BACK).exists():
        left = _roll_back(project, _read(folder / _ROLL_BACK))
    elif (folder / _COMPLETE).exists():
        journal = _read(folder / _COMPLETE)
        try:
            left, completed = _apply(project, journal, "new"), True
        except OSError:
            left = _roll_back(project, journal)
    _discard(folder)
    return Finished(completed, tuple(left))


def _must_be_ours(project: Path, folder: Path) -> None:
    """Raise `OSError` if a folder contains more than a switch leaves there, or if a stranger put it there."""
    about = folder.lstat()
    if not stat.S_ISDIR(about.st_mode):
        raise _not_ours("it is not a folder")
    # In a folder that several users share, such as /tmp, another user could leave a journal for us.
    if about.st_uid not in (os.geteuid(), project.stat().st_uid):
        raise _not_ours("it belongs to another user")
    for entry in folder.iterdir():
        if not _OURS.fullmatch(entry.name) or not stat.S_ISREG(entry.lstat().st_mode):
            raise _not_ours(f"it contains {entry.name!r}")


def _not_ours(why: str) -> OSError:
    return OSError(errno.EINVAL, f"roverlink has not written it ({why})", FOLDER)


@contextlib.contextmanager
def _locked(project: Path) -> Iterator[None]:
    """Keep other processes of roverlink from switching files of the project. The lock of a killed process is gone."""
    with _naming(FOLDER):
        descriptor = os.open(project, os.O_RDONLY)
    try:
        with contextlib.suppress(OSError):  # NFS has no locks on folders
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


@contextlib.contextmanager
def _naming(path: str) -> Iterator[None]:
    """Give an `OSError` the path of the project's file that it is about."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, path) from error


# --- before the switch ------------------------------------------------------------------------------------------


def _staged(project: Path, index: int, path: str, before: str | None, after: str | None) -> _Step:
    """Copy the old content of a file to `FOLDER`, and write the new one there."""
    with _naming(path):
        place = _writable_place(project, path)
        old, new = project / FOLDER / f"old-{index}", project / FOLDER / f"new-{index}"
        if _digest(place) is not None:
            shutil.copy2(place, old)
        found = old.read_bytes().decode(errors="replace") if old.exists() else None
        if found not in (before, after):
            raise OSError(errno.EBUSY, "somebody else has changed it while the command ran; run the command again")
        if after is not None:
            new.write_bytes(after.encode())
            if old.exists():
                shutil.copymode(old, new)
        return _Step(path, _digest(old), _digest(new))


def _missing_folders(project: Path, steps: Iterable[_Step]) -> tuple[str, ...]:
    """Return the folders that do not exist yet, of the files that will be written, the outer ones first."""
    written = [Path(step.path) for step in steps if step.new is not None]
    parents = {folder.as_posix() for path in written for folder in path.parents}
    return tuple(sorted(folder for folder in parents if not os.path.lexists(project / folder)))


def _write_journal(folder: Path, journal: _Journal) -> None:
    steps = [[step.path, step.old, step.new] for step in journal.steps]
    with _naming(FOLDER):
        (folder / _PART).write_text(json.dumps({"steps": steps, "folders": journal.folders}), encoding="utf-8")
        (folder / _PART).replace(folder / _COMPLETE)


# --- the switch -------------------------------------------------------------------------------------------------


def _read(path: Path) -> _Journal:
    """Read a journal. Raises `OSError` if roverlink has not written it."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        steps = tuple(_Step(*step) for step in content["steps"])
        journal = _Journal(steps, tuple(content["folders"]))
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise _not_ours(f"{path.name!r} is not a journal") from error
    texts = [*journal.folders, *(step.path for step in steps)]
    digests = [digest for step in steps for digest in (step.old, step.new) if digest is not None]
    if not all(isinstance(text, str) and "\0" not in text for text in [*texts, *digests]):
        raise _not_ours(f"{path.name!r} is not a journal")
    return journal


def _apply(project: Path, journal: _Journal, side: str) -> list[str]:
    """Give the files their ``new`` or their ``old`` content; return the paths of those that somebody else changed.

    A file that has this content already is not touched, so a switch that was interrupted can be repeated.
    """
    left = []
    for index, step in enumerate(journal.steps):
        wanted, other = (step.new, step.old) if side == "new" else (step.old, step.new)
        with _naming(step.path):
            place = _writable_place(project, step.path)
            if (found := _digest(place)) not in (wanted, other):
                left.append(step.path)
                continue
            if wanted is None:
                if found is not None:
                    place.unlink()
                if side == "new":  # when rolling back, the folders that the switch created are known
                    _remove_empty_folders(place, stop=project.resolve() / Path(step.path).parts[0])
            elif found != wanted:
                copy = project / FOLDER / f"{side}-{index}"
                if _digest(copy) != wanted:
                    raise _not_ours(f"{copy.name!r} differs from the journal")
                place.parent.mkdir(parents=True, exist_ok=True)
                copy.replace(place)
    return left


def _roll_back(project: Path, journal: _Journal) -> list[str]:
    """Give the files their old content, and remove the folders that the switch has created.

    Returns the paths of files that somebody else has changed.
    """
    folder = project / FOLDER
    if (folder / _COMPLETE).exists():
        (folder / _COMPLETE).replace(folder / _ROLL_BACK)
    left = _apply(project, journal, "old")
    for made in reversed(journal.folders):
        if place := place_of(project, made):
            with contextlib.suppress(OSError):  # it is not empty, or it was never created
                place.rmdir()
    return left


def _discard(folder: Path) -> None:
    """Remove `FOLDER`, the journal first: without a journal, the other files are leftovers."""
    with _naming(FOLDER):
        for name in (_COMPLETE, _ROLL_BACK):
            (folder / name).unlink(missing_ok=True)
        for entry in folder.iterdir():
            entry.unlink()
        folder.rmdir()


def _writable_place(project: Path, path: str) -> Path:
    if (place := place_of(project, path)) is None:
        raise OSError(errno.EPERM, "it is outside the project", path)
    return place


def _digest(place: Path) -> str | None:
    """Return the digest of a file's content; None if there is no file.

    Raises `OSError` for a folder or a device.
    """
    try:
        mode = place.lstat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "it is not a regular file")
    return hashlib.sha256(place.read_bytes()).hexdigest()


def _remove_empty_folders(place: Path, stop: Path) -> None:
    """Remove the folders above a removed file that are empty now; ``stop`` and the folders above it are kept."""
    for folder in place.parents:
        if not folder.is_dir():  # removed before the interruption
            continue
        if (
            not folder.is_relative_to(stop)
            or folder == stop
            or any(path.name != _COMPILED for path in folder.iterdir())
        ):
            return
        for child in folder.iterdir():
            for compiled in child.iterdir():
                compiled.unlink()
            child.rmdir()
        folder.rmdir()
