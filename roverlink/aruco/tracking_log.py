"""Log of ``roverlink aruco track``: new landmarks (markers and boards), misplaced landmarks, and totals at the end."""

from __future__ import annotations

import logging
import statistics
import time
from collections.abc import Iterable, Iterator

import numpy as np

from roverlink.console import counted
from roverlink.vision.field.view import View
from roverlink.vision.frames import Frame
from roverlink.vision.markers.marker_set import TargetId


class TrackingLog:
    """Log of a tracker. A context manager: on exit it logs the totals.

    It logs each landmark when it is seen for the first time, and each landmark that is not at its position on the
    field.
    """

    def __init__(self, logger: logging.Logger) -> None:
        self._logger = logger
        self._frames = self._with_landmarks = 0
        self._seen: set[TargetId] = set()
        self._rejected: tuple[TargetId, ...] = ()
        self._begin = 0.0
        self._times: list[float] = []

    def timed(self, frames: Iterable[Frame]) -> Iterator[Frame]:
        """Yield the frames, and measure for each frame the time until the next call of `add`."""
        for frame in frames:
            self._begin = time.perf_counter()
            yield frame

    def add(self, view: View) -> None:
        """Log the landmarks of a frame that were not seen before, and those that are not at their known position.

        Call this once for each frame.
        """
        self._times.append(time.perf_counter() - self._begin)
        self._frames += 1
        self._with_landmarks += bool(view.sightings)
        for one in view.sightings:
            if one.id not in self._seen:
                self._seen.add(one.id)
                distance = np.linalg.norm(one.pose.translation)
                self._logger.info("found landmark %s at a distance of %.2f m", one.id, distance)
        rejected = view.place.rejected if view.place else ()
        for target in set(rejected) - set(self._rejected):
            self._logger.warning("landmark %s is not at the position in the landmarks file; ignoring it", target)
        self._rejected = rejected

    def __enter__(self) -> TrackingLog:
        return self

    def __exit__(self, *_: object) -> None:
        if not self._frames:
            return
        self._logger.info(
            "%s, %d of them with landmarks (%s); median computing time %.1f ms per frame",
            counted(self._frames, "frame"),
            self._with_landmarks,
            ", ".join(sorted(map(str, self._seen))) or "none",
            1e3 * statistics.median(self._times),
        )
