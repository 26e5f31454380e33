"""What every source gives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

from roverlink.vision.markers.detection import Image
from roverlink.vision.opencv import cv2

RATE = 30.0
"""Frames a second where nobody says otherwise."""
_FASTEST = 1000.0  # a stream without a rate says its clock's, 90000


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One image of a camera."""

    image: Image
    """(H, W, 3), blue green red, 8 bits."""
    stamp: int
    """When it was taken, in nanoseconds: since 1970 where the source is live, else since the recording began."""
    number: int
    """Counts from 0 what the source had; where it grows by more than 1, frames came faster than they were taken."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return size_of(self.image)


class FrameSource(Protocol):
    """Frames, oldest first. A context manager: leaving it closes the camera, and ends an iteration."""

    name: str
    """What was opened, for messages."""
    live: bool
    """Whether frames come as they are taken, without an end."""
    rate: float
    """Frames a second, as the source says; where it says nothing, `RATE`."""
    total: int | None
    """How many frames there are, where that is known."""

    def __iter__(self) -> Iterator[Frame]: ...

    def __enter__(self) -> FrameSource: ...

    def __exit__(self, *_: object) -> None: ...


def size_of(image: Image) -> tuple[int, int]:
    """Width and height of an image in pixels."""
    height, width = image.shape[:2]
    return int(width), int(height)


def rate_of(capture: Any) -> float:
    """Frames a second of a `VideoCapture`. Many cameras and streams say nothing, or what cannot be."""
    rate = float(capture.get(cv2.CAP_PROP_FPS))
    return rate if 0 < rate <= _FASTEST else RATE
