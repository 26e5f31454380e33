"""Rate at which the images of a source come, which is often less than the camera promises."""

from __future__ import annotations

_PART = 1 / 16
"""Weight of the newest image in the average."""
_LONGEST_S = 2.0
"""Time in seconds from which two images say nothing about the rate: the source has stopped in between."""


class ImageRate:
    """Average rate of a source's images, by their stamps."""

    def __init__(self, first: float) -> None:
        """Begin with an assumed rate in Hz."""
        self._period = 1 / first
        self._stamp: int | None = None

    @property
    def hz(self) -> float:
        """Images a second."""
        return 1 / self._period

    def add(self, stamp: int, divisor: int = 1) -> None:
        """Take an image by its stamp in nanoseconds; with a divisor of 2, the source has twice as many images."""
        if self._stamp is not None:
            seconds = (stamp - self._stamp) / 1e9
            if 0 < seconds < _LONGEST_S:
                self._period += _PART * (seconds / divisor - self._period)
        self._stamp = stamp
