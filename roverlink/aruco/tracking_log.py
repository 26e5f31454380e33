"""Log of ``roverlink aruco track``: new landmarks (markers and boards), problems with them, and totals."""

from __future__ import annotations

import logging
import statistics
import time
from collections.abc import Iterable, Iterator

import numpy as np

from roverlink.console import counted
from roverlink.vision import CameraParameters, MarkerSet
from roverlink.vision.field.view import View
from roverlink.vision.frames import Frame
from roverlink.vision.markers.detection import Image
from roverlink.vision.markers.dictionaries import other_dictionary
from roverlink.vision.markers.marker_set import TargetId

_HINT_EVERY = 100
"""Number of frames between searches for other dictionaries, while no marker has been found.

A search takes as long as some tens of frames. Frames 1, 2, 4, 8 and so on are searched, too: a recording may be short.
"""


class TrackingLog:
    """Log of a tracker. A context manager: on exit it logs the totals.

    It logs each landmark when it is seen for the first time, each landmark that is not at its position on the field,
    and each number that several markers share. If no marker is found, it names the dictionary of the visible ones.
    """

    def __init__(self, logger: logging.Logger, camera: CameraParameters, markers: MarkerSet) -> None:
        self._logger, self._camera, self._markers = logger, camera, markers
        self._frames = self._with_landmarks = 0
        self._seen: set[TargetId] = set()
        self._rejected: tuple[TargetId, ...] = ()
        self._shared: set[TargetId] = set()
        self._hinted = False
        self._begin = 0.0
        self._times: list[float] = []

    def timed(self, frames: Iterable[Frame]) -> Iterator[Frame]:
        """Yield the frames, and measure for each frame the time until the next call of `add`."""
        for frame in frames:
            self._begin = time.perf_counter()
            yield frame

    def add(self, view: View) -> None:
        """Log the landmarks of a frame that were not seen before, and problems with its markers.

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
            if one.shared and one.id not in self._shared:
                self._shared.add(one.id)
                self._logger.warning(
                    "several markers with the number %s are visible; their frames are not on /tf, and none of them is "
                    "used as a landmark; print each marker with a number of its own",
                    one.id,
                )
        if not (self._seen or self._hinted) and (self._frames.bit_count() == 1 or self._frames % _HINT_EVERY == 0):
            self._hint(view.frame.image)
        rejected = view.place.rejected if view.place else ()
        for target in set(rejected) - set(self._rejected):
            self._logger.warning("landmark %s is not at the position in the landmarks file; ignoring it", target)
        self._rejected = rejected

    def _hint(self, image: Image) -> None:
        """Log the dictionary of the markers in an image in which no marker of the chosen dictionary was found."""
        if found := other_dictionary(image, self._camera, self._markers):
            dictionary, numbers = found
            self._hinted = True
            self._logger.warning(
                "no marker of %s was found, but the image shows %s of %s (%s); use --dictionary %s",
                self._markers.dictionary,
                counted(len(numbers), "marker"),
                dictionary,
                ", ".join(map(str, numbers)),
                dictionary,
            )

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
