"""Writes files whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

from runtime.errors import SetupError


def write_whole(path: Path, content: bytes) -> None:
    """Replace a file, or make it. Whoever reads it meanwhile sees the old content or the new, never a part.

    Raises `SetupError` where it cannot be written; then it is as it was.
    """
    place = path.resolve()  # a link stays a link
    part = place.with_name(f".{place.name}.{os.getpid()}.part")
    try:
        try:
            part.write_bytes(content)
            part.replace(place)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        raise SetupError(f"{path}: cannot be written: {error.strerror or error}") from error
