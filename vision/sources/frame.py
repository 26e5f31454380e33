"""What every source gives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from vision.detection import Image


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One image of a camera."""

    image: Image
    """(H, W, 3), blue green red, 8 bits."""
    stamp: int
    """When it was taken, in nanoseconds: since 1970 where the source is live, else since the recording began."""
    number: int
    """Counts from 0 what the source had; where it grows by more than 1, frames came faster than they were taken."""


class FrameSource(Protocol):
    """Frames, oldest first. A context manager: leaving it closes the camera, and ends an iteration."""

    name: str
    """What was opened, for messages."""
    live: bool
    """Whether frames come as they are taken, without an end."""
    total: int | None
    """How many frames there are, where that is known."""

    def __iter__(self) -> Iterator[Frame]: ...

    def __enter__(self) -> FrameSource: ...

    def __exit__(self, *_: object) -> None: ...
