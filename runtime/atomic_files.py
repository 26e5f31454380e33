"""Replacement of files in one step: a reader of a file sees either its old content or its new content."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from roverlink.runtime.core.errors import SetupError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield the path of a temporary file that replaces the file ``path`` when the block ends.

    The block writes the new content to the temporary file. A concurrent reader of ``path`` sees the old content or the
    new content. If the block fails or writes nothing, ``path`` keeps its content. If ``path`` is a device or a pipe,
    which cannot be replaced, ``path`` itself is yielded. Raises `OSError` if the file cannot be replaced.
    """
    if path.exists() and not path.is_file():
        yield path
        return
    place = path.resolve()  # else replace() would turn a symbolic link into a file
    # In the same folder: rename(2) replaces a file in one step, but only within a file system. With the process id,
    # since two programs may write the same file.
    part = place.with_name(f".{place.name}.{os.getpid()}.part")
    try:
        yield part
        if part.exists():
            part.replace(place)
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes) -> None:
    """Create the file ``path``, or replace it in one step as `replacing` does.

    If the file cannot be written, raises `SetupError` and leaves an existing file unchanged.
    """
    try:
        with replacing(path) as part:
            part.write_bytes(content)
    except OSError as error:
        raise SetupError(f"{path}: cannot write the file: {error.strerror or error}") from error
