"""Reading of the files of a project, which may come from a stranger's pull request.

All modules that read sources use this one. A checkout can contain a link to a device or to a private file, and other
programs can leave a pipe in the tree. Therefore:

- Links are followed only inside the git repository, and never into its folder ``.git``, which can hold passwords. In no
  repository, links are followed only inside the folder that is read.
- Only regular files of a limited size are opened (`bounded_files`).
- The number of entries of a folder tree has a limit.
"""

from __future__ import annotations

import functools
import os
import unicodedata
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from roverlink import bounded_files
from roverlink.bounded_files import LARGEST, RefusedFileError

_MOST_ENTRIES = 100_000  # of one folder tree; links between folders can make a small tree look endless
_LEADS_OUT = "it is a link that leads out of the repository, or of the folder if there is none"


def read(root: Path, name: str, largest: int = LARGEST) -> bytes:
    """Return the content of the file ``name`` below the folder ``root``.

    Raises `RefusedFileError` for a link that leads out of the repository, for anything but a regular file, and for a
    file of more than ``largest`` bytes. Raises `OSError` if the file does not exist or cannot be read.
    """
    with open_file(root, name) as file:
        return bounded_files.content(file, largest)


def read_text(root: Path, name: str) -> str:
    """Return the content of a UTF-8 file; the line ends of all systems become line feeds.

    Raises the same errors as `read`, and `UnicodeDecodeError` if the file is not UTF-8.
    """
    return bounded_files.decoded(read(root, name))


def quoted_text(path: Path) -> str:
    """Return the text of a file whose lines are quoted in messages; empty if it cannot be read."""
    if not path.is_file():  # reading a pipe or a device may never end
        return ""
    try:
        return read(path.parent, path.name).decode("utf-8", errors="replace")
    except OSError:
        return ""


def open_file(root: Path, name: str) -> BinaryIO:
    """Open the file ``name`` below the folder ``root`` for reading. Raises the same errors as `read`."""
    return bounded_files.open_regular(_inside(os.path.join(root, name), root), follow_links=False)


def walk(root: Path, report: Callable[[str, str], None]) -> list[str]:
    """Return the paths of all files below a folder, relative to the folder and sorted.

    Links to folders inside the repository are followed; the folder ``.git`` is left out. Pipes, devices and broken
    links count as files. ``report`` is called with the path and the fault of each folder that is not read.
    """
    found: list[str] = []
    entries = 0
    top = _top(root)
    target_of = functools.cache(lambda link: _below(os.path.realpath(link), top))  # each way to a link meets it again
    # A stack instead of recursion: a path can have more levels than Python has stack frames. Each item is a folder, its
    # real path, and the real paths of the folders in which links were followed to reach it.
    pending: list[tuple[str, str, tuple[str, ...]]] = [("", os.path.realpath(root), ())]
    while pending:
        folder, real, left = pending.pop()
        try:
            children = list(os.scandir(real))
        except OSError as error:
            report(folder or ".", f"the folder cannot be listed: {error.strerror}")
            continue
        entries += len(children)
        if entries > _MOST_ENTRIES:
            report(".", f"the folder has more than {_MOST_ENTRIES} entries, links included; the rest was not read")
            break
        for child in children:
            path = os.path.join(folder, child.name)
            if child.name == ".git":
                continue
            try:
                if not child.is_dir():
                    found.append(path)
                elif not child.is_symlink():
                    pending.append((path, os.path.join(real, child.name), left))
                else:
                    target = target_of(child.path)
                    if any(_is_below(place, target) for place in (real, *left)):
                        raise RefusedFileError("it is a link to a folder that contains it")
                    pending.append((path, target, (*left, real)))
            except OSError as error:
                report(path, f"the folder was not read: {error.strerror}")
    return sorted(Path(path).as_posix() for path in found)


def printable(path: str) -> str:
    """Return a path as text for messages and files: bytes that are not UTF-8 are escaped."""
    # Python reads such bytes as lone surrogates (PEP 383). They cannot be written to JSON or to a terminal.
    return os.fsencode(path).decode("utf-8", errors="backslashreplace")


def visible(text: str) -> str:
    r"""Return a text without characters that a terminal would obey, or that a reader cannot see.

    They are escaped as in Python and YAML: ``\x1b`` for an escape, ``\u202e`` for a mark that turns the direction of
    writing. Line feeds, tabs and spaces of all widths stay.
    """
    if text.isprintable():
        return text
    return text.translate(
        {
            ord(character): character.encode("unicode_escape").decode()
            for character in set(text)
            if not (character.isprintable() or character in "\n\t" or unicodedata.category(character) == "Zs")
        }
    )


def repository_top(folder: str) -> str | None:
    """Return the top folder of the git repository that contains a folder; None if it is in no repository.

    The path of the folder must be absolute.
    """
    # A submodule and a linked worktree have a file `.git` (gitrepository-layout(5)).
    while not os.path.lexists(os.path.join(folder, ".git")):
        if folder == (folder := os.path.dirname(folder)):
            return None
    return folder


def leads_out(project: Path, folder: Path) -> bool:
    """Return True if the project is in a git repository, and the folder is outside the repository."""
    top = repository_top(os.path.realpath(project))
    return top is not None and not _is_below(os.path.realpath(folder), top)


def _inside(path: str, root: Path) -> str:
    """Return the real path of a file or folder that is read for ``root``. Raises `RefusedFileError` if it leads out."""
    return _below(os.path.realpath(path), _top(root))


def _top(root: Path) -> str:
    """Return the real path of the folder that links must not leave: that of the git repository, or else ``root``."""
    folder = os.path.realpath(root)
    return repository_top(folder) or folder


def _below(real: str, top: str) -> str:
    if not _is_below(real, top):
        raise RefusedFileError(_LEADS_OUT)
    if ".git" in os.path.relpath(real, top).casefold().split(os.sep):
        raise RefusedFileError("it leads into the folder .git")
    return real


def _is_below(path: str, folder: str) -> bool:
    return path == folder or path.startswith(folder.rstrip(os.sep) + os.sep)
