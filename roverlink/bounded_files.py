"""Bounded reading of files from outside, which a user names or a stranger has written.

All modules that read such files use this one, in the compiler, in the runtime, and in other packages:

- Only regular files are opened. Opening a pipe would wait forever, and a device can have no end.
- The size of a file has a limit.
"""

from __future__ import annotations

import errno
import io
import os
import stat
from pathlib import Path
from typing import BinaryIO

LARGEST = 8 << 20
"""Largest size of a text file in bytes. The parser of .proto files needs about 13 s and 600 MB for so many bytes."""
_NO_FILE = "it is not a regular file, but a folder, a pipe or a device"
# Neither exists on Windows. Without O_NONBLOCK, opening a file that became a pipe after the check would wait.
_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


class RefusedFileError(OSError):
    """Raised for a file or folder that must not be read; ``strerror`` is the reason."""

    def __init__(self, reason: str, path: str | None = None) -> None:
        super().__init__(errno.EINVAL, reason, path)


def open_regular(path: str | Path, *, follow_links: bool = True) -> BinaryIO:
    """Open a file for reading.

    Raises `RefusedFileError` for anything but a regular file, and `OSError` if the file cannot be opened.
    """
    if not stat.S_ISREG(os.stat(path).st_mode):
        raise RefusedFileError(_NO_FILE, str(path))
    flags = _FLAGS if follow_links else _FLAGS | getattr(os, "O_NOFOLLOW", 0)
    file = open(os.open(path, flags), "rb")  # noqa: SIM115  # the caller closes it
    if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        return file
    file.close()
    raise RefusedFileError(_NO_FILE, str(path))


def content(file: BinaryIO, largest: int = LARGEST, path: str | Path | None = None) -> bytes:
    """Return the content of an open file. Raises `RefusedFileError` if it has more than ``largest`` bytes."""
    size = os.fstat(file.fileno()).st_size
    data = file.read(largest + 1) if size <= largest else b""
    if max(size, len(data)) > largest:
        raise RefusedFileError(too_large(max(size, len(data)), largest), str(path) if path else None)
    return data


def too_large(size: int, largest: int = LARGEST) -> str:
    """Return the reason why a file of ``size`` bytes is not read."""
    return f"it has {size} bytes; files of more than {largest} bytes are not read"


def read(path: str | Path, largest: int = LARGEST) -> bytes:
    """Return the content of a file.

    Raises `RefusedFileError` for anything but a regular file of at most ``largest`` bytes, and `OSError` if the file
    cannot be read. The error has the path.
    """
    with open_regular(path) as file:
        return content(file, largest, path)


def read_text(path: str | Path) -> str:
    """Return the text of a UTF-8 file; the line ends of all systems become line feeds.

    Raises the same errors as `read`, and `RefusedFileError` if the file is not UTF-8.
    """
    try:
        return decoded(read(path))
    except UnicodeDecodeError as error:
        raise RefusedFileError(f"it is not UTF-8 text: {error.reason} at byte {error.start}", str(path)) from error


def decoded(data: bytes) -> str:
    """Return UTF-8 as text; the line ends of all systems become line feeds."""
    return io.TextIOWrapper(io.BytesIO(data), encoding="utf-8").read()
