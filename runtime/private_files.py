"""Files with secrets, which only their owner may read."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from roverlink.runtime.core.errors import SetupError


def read_private(path: Path, what: str, longest: int) -> bytes:
    """Return at most ``longest`` bytes of a file; ``what`` names its content for errors: ``the token of the page``.

    Raises `SetupError` if the file is not a regular one, or if other users can read or write it; and `OSError` if it
    cannot be read.
    """
    # Without O_NONBLOCK, opening a pipe would wait until something writes into it.
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        mode = os.fstat(descriptor).st_mode
        content = os.read(descriptor, longest) if stat.S_ISREG(mode) else None
    finally:
        os.close(descriptor)
    if content is None:
        raise SetupError(f"{path}: not a regular file; name another file for {what}")
    if mode & 0o077:
        raise SetupError(f"{path}: other users can read or write {what}; run: chmod 600 {path}")
    return content


def create_private(path: Path, content: str) -> None:
    """Create a file that only its owner can read. Raises `OSError`, also if the file exists."""
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as file:
        file.write(content)
