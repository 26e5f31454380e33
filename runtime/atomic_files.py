"""Files that are written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from roverlink.runtime.core.errors import SetupError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Where to write what takes a file's place once all of it is there.

    Whoever reads the file meanwhile sees the old content or the new, never a part. Where writing fails, or nothing was
    written, it is as it was. A device or a pipe is written to as it is. Raises `OSError`.
    """
    if path.exists() and not path.is_file():
        yield path
        return
    place = path.resolve()  # a link stays a link
    part = place.with_name(f".{place.name}.{os.getpid()}.part")
    try:
        yield part
        if part.exists():
            part.replace(place)
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes) -> None:
    """Replace a file, or make it. Raises `SetupError` where it cannot be written; then it is as it was."""
    try:
        with replacing(path) as part:
            part.write_bytes(content)
    except OSError as error:
        raise SetupError(f"{path}: cannot be written: {error.strerror or error}") from error
