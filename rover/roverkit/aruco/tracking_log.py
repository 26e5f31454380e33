"""Log of ``roverlink aruco track``: new landmarks (markers and boards), problems with them, and totals."""

from __future__ import annotations

import logging
import statistics
import time
from collections.abc import Iterable, Iterator
from typing import TypeVar

import numpy as np

from roverkit.vision import MarkerSet
from roverkit.vision.localization.field_tracker import LandmarkResult
from roverkit.vision.localization.pose_from_landmarks import FieldPose
from roverkit.vision.markers.dictionaries import other_dictionary
from roverkit.vision.markers.marker_set import TargetId
from roverlink.numerals import counted

_Frame = TypeVar("_Frame")

_HINT_EVERY = 100
"""Number of frames between searches for other dictionaries, while no marker has been found.

A search takes as long as some tens of frames. Frames 1, 2, 4, 8 and so on are searched, too: a recording may be short.
"""


class TrackingLog:
    """Log of a tracker. A context manager: on exit it logs the totals.

    It logs each landmark when it is seen for the first time, each landmark that is not at its position on the field,
    and each number that several markers share. If no marker is found, it names the dictionary of the visible ones.
    """

    def __init__(
        self,
        logger: logging.Logger,
        markers: MarkerSet,
        assumed_side: float | None = None,
    ) -> None:
        """Log with a logger; `assumed_side` is the side in metres of markers if the user has given none."""
        self._logger, self._markers, self._assumed_side = logger, markers, assumed_side
        self._frames = self._with_landmarks = 0
        self._seen: set[tuple[str, TargetId]] = set()
        self._rejected: tuple[TargetId, ...] = ()
        self._disagreed = False
        self._shared: set[TargetId] = set()
        self._hinted = False
        self._begin = 0.0
        self._times: list[float] = []

    def timed(self, frames: Iterable[_Frame]) -> Iterator[_Frame]:
        """Yield frames, and measure for each of them the time until the next call of `add`."""
        for frame in frames:
            self._begin = time.perf_counter()
            yield frame

    def look_for(self, markers: MarkerSet, assumed_side: float | None = None) -> None:
        """Set other markers; the landmarks that are seen from now on are new ones."""
        self._markers, self._assumed_side, self._hinted = markers, assumed_side, False
        self._seen.clear()
        self._shared.clear()

    def add(self, result: LandmarkResult) -> None:
        """Log the landmarks of a frame that were not seen before, and problems with its markers.

        Call this once for each frame.
        """
        self._times.append(time.perf_counter() - self._begin)
        self._frames += 1
        self._with_landmarks += bool(result.detections)
        by = f"{result.camera}: " if result.camera else ""
        for detection in result.detections:
            if (result.camera, detection.id) not in self._seen:
                self._seen.add((result.camera, detection.id))
                distance = np.linalg.norm(detection.pose.translation)
                self._logger.info("%sfound landmark %s at a distance of %.2f m", by, detection.id, distance)
                self._tell_assumption(detection.id)
            if detection.shared and detection.id not in self._shared:
                self._shared.add(detection.id)
                self._logger.warning(
                    "%sseveral markers with the number %s are visible; their frames are not on /tf, and none of them "
                    "is used as a landmark; print each marker with a number of its own",
                    by,
                    detection.id,
                )
        if not (self._seen or self._hinted) and (self._frames.bit_count() == 1 or self._frames % _HINT_EVERY == 0):
            self._hint(result)
        if result.rover:
            self._judge(result.rover.field_pose)
        elif not result.camera:
            self._judge(result.camera_pose)

    def _tell_assumption(self, target: TargetId) -> None:
        """Log once that the side of a marker is assumed, unless the landmark is a board or has a side of its own."""
        has_own_side = isinstance(target, str) or target in self._markers.sides
        if self._assumed_side is not None and not has_own_side:
            self._logger.warning(
                "no --side; assuming %g m for the black square of marker %s; measure it and give --side METRES, "
                "because a wrong side makes all distances wrong",
                self._assumed_side,
                target,
            )
            self._assumed_side = None

    def _judge(self, pose: FieldPose | None) -> None:
        """Log the landmarks that do not fit a pose, if they are others than before."""
        if pose and not pose.agreed:
            rejected, used = (", ".join(map(str, sorted(some, key=str))) for some in (pose.rejected, pose.used))
            if not self._disagreed:
                self._logger.warning(
                    "landmarks %s and %s contradict each other; there is no pose until most of them agree",
                    used,
                    rejected,
                )
        else:
            for target in sorted(set(pose.rejected if pose else ()) - set(self._rejected), key=str):
                self._logger.warning("landmark %s is not at the position in the landmarks file; ignoring it", target)
        self._disagreed = pose is not None and not pose.agreed
        self._rejected = pose.rejected if pose else ()

    def _hint(self, result: LandmarkResult) -> None:
        """Log the dictionary of the markers in an image in which no marker of the chosen dictionary was found."""
        if found := other_dictionary(result.frame.image, result.parameters, self._markers):
            dictionary, numbers = found
            self._hinted = True
            self._logger.warning(
                "no marker of %s was found, but the image shows %s of %s (%s); use --dictionary %s, or a larger one "
                "of this family",
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
            ", ".join(sorted({str(target) for _, target in self._seen})) or "none",
            1e3 * statistics.median(self._times),
        )
