"""Files with secrets, which only their owner may read."""

from __future__ import annotations

import os
from pathlib import Path

from roverlink import bounded_files
from roverlink.runtime.core.errors import SetupError


def read_private(path: Path, what: str, longest: int) -> bytes:
    """Return at most ``longest`` bytes of a file; ``what`` names its content for errors: ``the token of the page``.

    Raises `SetupError` if other users can read or write the file, and `OSError` if it cannot be read or is not a
    regular one.
    """
    with bounded_files.open_regular(path) as file:
        mode, content = os.fstat(file.fileno()).st_mode, file.read(longest)
    if mode & 0o077:
        raise SetupError(f"{path}: other users can read or write {what}; run: chmod 600 {path}")
    return content


def create_private(path: Path, content: str) -> None:
    """Create a file that only its owner can read. Raises `OSError`, also if the file exists; then nothing is left."""
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as file:
        try:
            file.write(content)
            file.flush()
        except OSError:  # the disk is full; the next attempt must not find a file without a secret
            path.unlink()
            raise
