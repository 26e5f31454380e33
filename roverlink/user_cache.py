"""Folder for roverlink's cache files in the user's home. The files make later runs faster, and may be deleted."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from pathlib import Path

_LARGEST = 64 * 2**20  # bytes of all files of a kind together


def cache_folder() -> Path:
    """Return the folder for roverlink's caches: ``$XDG_CACHE_HOME/roverlink``, or else ``~/.cache/roverlink``."""
    # XDG Base Directory specification: "All paths set in these environment variables must be absolute. If an
    # implementation encounters a relative path ... it should consider the path invalid and ignore it."
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (given if given.is_absolute() else Path(os.path.expanduser("~"), ".cache")) / "roverlink"


class CacheFile:
    """File with what a run has learned about one project or repository: a checksum, then the content.

    The checksum covers ``version``, too: a checksum of the code whose results the content holds. So files from another
    version of the program, and damaged files, are ignored.
    """

    def __init__(self, kind: str, subject: Path, version: bytes) -> None:
        # A path contains slashes, and may be longer than the name of a file may be. So its hash is the name.
        name = hashlib.sha256(os.fsencode(subject.resolve())).hexdigest()[:32]
        self._file = cache_folder() / kind / f"{name}.json"
        self._version = version

    def load(self) -> bytes | None:
        """Return the content; None if the file cannot be read, or was written by another version of the program."""
        try:
            checksum, _, body = self._file.read_bytes().partition(b"\n")
            # The time of the file is the time of its last use, for `_remove_oldest`. The access time does not tell:
            # most systems mount with relatime, and update it once a day (mount(8)).
            os.utime(self._file)
        except OSError:
            return None
        return body if checksum == self._checksum(body) else None

    def save(self, body: bytes) -> None:
        """Replace the content. If this is not possible, the next run does its work again."""
        if len(body) > _LARGEST:
            return
        with contextlib.suppress(OSError):
            folder = self._file.parent
            # 0700 as the XDG Base Directory Specification asks: names in a private repository do not concern other
            # users.
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            # Two runs may save at the same time. rename(2) replaces the file in one step, so a reader finds the old
            # cache or the new one. It works in one file system only, therefore the temporary file is in the same
            # folder.
            descriptor, temporary = tempfile.mkstemp(dir=folder)
            try:
                with open(descriptor, "wb") as file:
                    file.write(self._checksum(body) + b"\n" + body)
                os.replace(temporary, self._file)
            except OSError:
                os.unlink(temporary)
                raise
            _remove_oldest(folder)

    def _checksum(self, body: bytes) -> bytes:
        return hashlib.sha256(self._version + body).hexdigest().encode()


def _remove_oldest(folder: Path) -> None:
    """Remove the least recently used files of a folder until the others have at most 64 MiB together."""
    about = {path: path.stat() for path in folder.iterdir()}
    size = 0
    for path in sorted(about, key=lambda path: about[path].st_mtime, reverse=True):
        size += about[path].st_size
        if size > _LARGEST:
            path.unlink()
