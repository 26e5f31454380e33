"""Log of ``roverlink objects track``: new objects, the latency of a camera's images, and totals."""

from __future__ import annotations

import logging
import statistics
import time
from collections.abc import Sequence

from roverkit.objects.detected_objects import TrackedObject
from roverkit.vision.frames import Frame
from roverlink.numerals import counted
from roverlink.runtime.ros_time.clock import Clock

_EVERY_S = 10.0
"""Time in seconds between two messages about the latency."""


class ObjectLog:
    """Log of a tracker. A context manager: on exit it logs the totals.

    It logs each object when it appears. The latency is the time from the stamp of a live image to the end of all
    outputs; with ROS 2, the objects are then on their way to the bridge.
    """

    def __init__(self, logger: logging.Logger, clock: Clock) -> None:
        self._logger, self._clock = logger, clock
        self._frames = self._skipped = 0
        self._newest = -1
        self.seen: dict[int, str] = {}
        """Classes of all objects so far by their numbers."""
        self._latencies: list[float] = []
        self._since = self._begin = time.monotonic()

    def add(self, frame: Frame, objects: Sequence[TrackedObject], *, live: bool) -> None:
        """Log the new objects of a frame, and from time to time the latency. Call this once for each frame."""
        self._frames += 1
        self._skipped += max(frame.number - self._newest - 1, 0)
        self._newest = frame.number
        for tracked in objects:
            if tracked.id not in self.seen:
                self.seen[tracked.id] = tracked.class_name
                self._logger.info("object %d appeared: %s", tracked.id, tracked.class_name)
        if live:
            self._latencies.append((self._clock.now() - frame.stamp) / 1e6)
        if time.monotonic() - self._since >= _EVERY_S:
            self._report()

    def _report(self) -> None:
        """Log rate and latency of the last images."""
        seconds = time.monotonic() - self._since
        if self._latencies:
            low, high = statistics.median(self._latencies), max(self._latencies)
            self._logger.info(
                "%.1f images a second (%d skipped); latency from the image's stamp: median %.0f ms, largest %.0f ms",
                len(self._latencies) / seconds,
                self._skipped,
                low,
                high,
            )
        self._latencies.clear()
        self._skipped, self._since = 0, time.monotonic()

    def __enter__(self) -> ObjectLog:
        return self

    def __exit__(self, *_: object) -> None:
        if not self._frames:
            return
        self._report()
        classes = ", ".join(f"{number} {name}" for number, name in sorted(self.seen.items())) or "none"
        self._logger.info("%s with %s: %s", counted(self._frames, "frame"), counted(len(self.seen), "object"), classes)
