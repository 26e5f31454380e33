"""Class of a frame, and the interface of all sources of frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2

RATE = 30.0
"""Default number of frames a second."""
_FASTEST = 1000.0  # a stream without a rate reports its clock rate instead, 90000


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """Image of a camera, with its time and its number."""

    image: Image
    """BGR image (H, W, 3) or grey image (H, W), 8 bits. It may be read-only."""
    stamp: int
    """Time of the frame in nanoseconds: since 1970 for a live source, otherwise since the start of the recording."""
    number: int
    """Number of the frame at the source, from 0; a step above 1 means that frames were skipped."""
    frame_id: str = ""
    """Name of the camera's coordinate frame; empty if the source does not know it."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the image in pixels."""
        return size_of(self.image)


class FrameSource(Protocol):
    """Source that yields frames, oldest first. A context manager: on exit it closes the camera, and iterations end."""

    name: str
    """Name for messages."""
    live: bool
    """True for a camera or stream, whose frames come in real time and without an end."""
    rate: float
    """Number of frames a second according to the source; `RATE` if the source does not say it."""
    total: int | None
    """Number of all frames of the source; None if it is unknown, as for a camera."""

    def __iter__(self) -> Iterator[Frame]: ...

    def __enter__(self) -> FrameSource: ...

    def __exit__(self, *_: object) -> None: ...


def size_of(image: Image) -> tuple[int, int]:
    """Return width and height of an image in pixels."""
    height, width = image.shape[:2]
    return int(width), int(height)


def rate_of(capture: Any) -> float:
    """Return the frames a second that a `VideoCapture` reports, or `RATE` if it reports no plausible number."""
    rate = float(capture.get(cv2.CAP_PROP_FPS))
    return rate if 0 < rate <= _FASTEST else RATE
