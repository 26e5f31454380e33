"""Tracking of detected objects from frame to frame, so that an object keeps its number.

The method is that of ByteTrack (Zhang et al., ECCV 2022): a Kalman filter predicts each box, and the assignment with
the smallest total distance joins boxes and predictions, first for certain detections and then for uncertain ones. Only
a certain detection begins a track. In addition, the motion that most boxes have in common is taken for that of the
camera.

Libraries for this were tried in 2026. Norfair needs a numpy before 2, and `trackers` installs a second OpenCV. When two
objects crossed with gaps, they confused them in 13 and 5 of 200 runs, and this module in none; when the camera shook by
100 pixels, they gave five objects 146 and 15 numbers.
"""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np

from roverkit.objects.detected_objects import Box, ObjectDetection, TrackedObject
from roverkit.objects.frame_period import FramePeriod
from roverkit.vision.camera.camera_model import Floats
from roverlink.runtime.core.errors import SetupError

try:
    from scipy.optimize import linear_sum_assignment
except ImportError as error:
    raise SetupError(
        f"the tracking of objects needs SciPy ({error}); install it with `pip install 'scipy>=1.11'`"
    ) from error

CERTAIN = 0.5
"""Confidence from which a detection can begin a track."""
CONFIRMED = 2
"""Number of detections after which a track counts as an object; a single one may be an error of the detector."""
FORGOTTEN_NS = 1_000_000_000
"""Time in nanoseconds after which an object that was not seen is forgotten."""
FORGOTTEN_PERIODS = 3
"""The same in periods of the images, for a detector that is slower than that."""
_GATE = 0.7
"""Distance of a box from its prediction, in its sizes, above which it is another object."""
_IN_COMMON = 3
"""Least number of objects whose common motion is that of the camera."""
_JITTER = 0.05
"""Standard deviation of a detected box's centre and size, as a fraction of its size."""
_ACCELERATION = 2.0
"""Standard deviation of a box's acceleration in its sizes per second squared."""
_SPEED = 2.0
"""Standard deviation of a new box's speed in its sizes per second."""
_SMOOTHING_S = 0.5
"""Time constant in seconds of the smoothed confidence."""


class _Track:
    """Object with its filter. The state is the box (centre x y, width, height) in pixels, and its change per second.

    The four numbers have the same noise, so they have one covariance, of the number and its change.
    """

    def __init__(self, id: int, detection: ObjectDetection, stamp: int) -> None:
        self.id, self.stamp, self.seen = id, stamp, 1
        self.confidence = detection.confidence
        self.classes: dict[str, float] = defaultdict(float, {detection.class_name: detection.confidence})
        self._at = stamp
        self._state = np.vstack([_measured(detection.box), np.zeros(4)])
        size = _size(detection.box)
        self._covariance: Floats = np.diag([(_JITTER * size) ** 2, (_SPEED * size) ** 2])

    @property
    def class_name(self) -> str:
        """Class with the largest sum of confidences."""
        return max(self.classes, key=self.classes.__getitem__)

    @property
    def box(self) -> Floats:
        """Predicted box (4,): centre x y, width, height."""
        box: Floats = self._state[0]
        return box

    def predict(self, stamp: int) -> None:
        """Move the state to a time in nanoseconds."""
        seconds, self._at = (stamp - self._at) / 1e9, stamp
        step, push = np.array([[1.0, seconds], [0, 1]]), np.array([seconds**2 / 2, seconds])
        acceleration = _ACCELERATION * float(self._state[0, 2:].mean())
        self._state = step @ self._state
        self._covariance = step @ self._covariance @ step.T + acceleration**2 * np.outer(push, push)

    def shift(self, pixels: Floats) -> None:
        """Move the predicted centre by pixels (2,)."""
        self._state[0, :2] += pixels

    def update(self, detection: ObjectDetection, stamp: int) -> None:
        """Correct the state by a detection."""
        innovation = self._covariance[0, 0] + (_JITTER * _size(detection.box)) ** 2
        gain = self._covariance[0] / innovation
        self._state = self._state + np.outer(gain, _measured(detection.box) - self._state[0])
        self._covariance = self._covariance - innovation * np.outer(gain, gain)
        weight = 1 - math.exp(-(stamp - self.stamp) / 1e9 / _SMOOTHING_S)
        self.confidence += weight * (detection.confidence - self.confidence)
        self.classes[detection.class_name] += detection.confidence
        self.seen, self.stamp = self.seen + 1, stamp


class ObjectTracker:
    """Gives the objects in the frames of one camera their numbers. Not thread-safe."""

    def __init__(self, first: int = 1) -> None:
        """Track nothing yet; `first` is the number of the first object."""
        self._tracks: list[_Track] = []
        self._ids = itertools.count(first)
        self._stamp: int | None = None
        self._period = FramePeriod()

    def track(self, detections: Iterable[ObjectDetection], stamp: int) -> list[TrackedObject]:
        """Return the objects that are visible in a frame, with the detections in it; `stamp` is in nanoseconds.

        An object comes out when it is detected for the second time. If the time jumps back, all objects are new.
        """
        if self._stamp is not None and stamp < self._stamp:
            self._tracks = []
        self._stamp = stamp
        self._period.add(stamp)
        forgotten = self._period.at_least(FORGOTTEN_NS, FORGOTTEN_PERIODS)
        self._tracks = [track for track in self._tracks if stamp - track.stamp < forgotten]
        for track in self._tracks:
            track.predict(stamp)
        found: list[tuple[_Track, ObjectDetection]] = []
        certain, uncertain = _parted(detections)
        self._follow_camera(certain)
        left, news = _joined(self._tracks, certain, stamp, found)
        _joined(left, uncertain, stamp, found)
        for detection in news:
            track = _Track(next(self._ids), detection, stamp)
            self._tracks.append(track)
        return [
            TrackedObject(track.id, detection.box, track.class_name, track.confidence)
            for track, detection in sorted(found, key=lambda pair: pair[0].id)
            if track.seen >= CONFIRMED
        ]

    def _follow_camera(self, detections: Sequence[ObjectDetection]) -> None:
        """Shift all predictions by the motion that most objects have in common: that of the camera."""
        pairs = _pairs(self._tracks, detections)
        if len(pairs) >= _IN_COMMON:
            shift = np.median([(_measured(detection.box) - track.box)[:2] for track, detection in pairs], axis=0)
            for track in self._tracks:
                track.shift(shift)


def _parted(detections: Iterable[ObjectDetection]) -> tuple[list[ObjectDetection], list[ObjectDetection]]:
    certain: list[ObjectDetection] = []
    uncertain: list[ObjectDetection] = []
    for detection in detections:
        (certain if detection.confidence >= CERTAIN else uncertain).append(detection)
    return certain, uncertain


def _joined(
    tracks: Sequence[_Track],
    detections: Sequence[ObjectDetection],
    stamp: int,
    found: list[tuple[_Track, ObjectDetection]],
) -> tuple[list[_Track], list[ObjectDetection]]:
    """Join tracks and detections, and return those that are left over; `found` gets the pairs."""
    pairs = _pairs(tracks, detections)
    for track, detection in pairs:
        track.update(detection, stamp)
    found += pairs
    used = {id(member) for pair in pairs for member in pair}
    return [track for track in tracks if id(track) not in used], [
        detection for detection in detections if id(detection) not in used
    ]


def _pairs(tracks: Sequence[_Track], detections: Sequence[ObjectDetection]) -> list[tuple[_Track, ObjectDetection]]:
    """Return the pairs of tracks and detections with the smallest total distance."""
    if not tracks or not detections:
        return []
    seen = np.array([_measured(detection.box) for detection in detections])
    predicted = np.array([track.box for track in tracks])
    # In sizes of the detected box.
    distances = np.linalg.norm(seen - predicted[:, None], axis=2) / np.sqrt(seen[:, 2] * seen[:, 3])
    # A pair beyond the gate costs as much as two objects without a partner.
    rows, columns = linear_sum_assignment(np.minimum(distances, _GATE))
    return [(tracks[row], detections[column]) for row, column in zip(rows, columns) if distances[row, column] < _GATE]


def _measured(box: Box) -> Floats:
    return np.array([box.x + box.width / 2, box.y + box.height / 2, box.width, box.height])


def _size(box: Box) -> float:
    return math.sqrt(box.width * box.height)
