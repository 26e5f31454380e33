"""Results of one frame: the landmarks in it, and the camera's pose."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.field.landmarks import Landmarks
from roverlink.vision.field.localization import FieldPose, localize
from roverlink.vision.frames import Frame
from roverlink.vision.markers.tracker import Sighting, Tracker
from roverlink.vision.poses.pose import Pose, quaternion_of

_DIGITS = 9  # significant digits, because covariances are small numbers


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Frame with the landmarks that were found in it, and the camera's pose that follows from them."""

    frame: Frame
    sightings: tuple[Sighting, ...]
    place: FieldPose | None = None
    """Camera's pose on the field; None if the frame shows no known landmark."""

    def as_dict(self) -> dict[str, Any]:
        """Return the results as JSON values: metres, pixels, quaternions x y z w, covariances row by row."""
        markers = [_sighting(one) for one in self.sightings]
        frame = {"stamp": self.frame.stamp, "frame": self.frame.number, "frame_id": self.frame.frame_id}
        found = {**frame, "markers": markers}
        return {**found, "camera": _place(self.place)} if self.place else found


def look(frames: Iterable[Frame], tracker: Tracker, landmarks: Landmarks | None = None) -> Iterator[View]:
    """Yield the results of each frame: the markers in it and, if landmarks are given, the camera's pose."""
    for frame in frames:
        sightings = tracker.track(frame.image, frame.stamp)
        yield View(frame, sightings, localize(sightings, landmarks) if landmarks else None)


def _sighting(one: Sighting) -> Mapping[str, Any]:
    return {
        "id": one.id,
        **_pose(one.pose, one.covariance),
        "corners": [_numbers(corner) for corner in one.corners],
        "error": _number(one.error),
        "other_pose": _other(one),
    }


def _other(one: Sighting) -> Mapping[str, Any] | None:
    """Return the pose of a landmark that was not chosen, as JSON values; None if there is only one possible pose.

    `ambiguity` is the ratio of its reprojection error to that of the chosen pose.
    """
    for solution in one.solutions:
        if solution.pose is not one.pose:
            return {**_pose(solution.pose, solution.covariance), "ambiguity": _number(one.ambiguity)}
    return None


def _place(place: FieldPose) -> Mapping[str, Any]:
    known = {"used": list(place.used), "rejected": list(place.rejected)}
    return {"frame": place.frame, **_pose(place.pose, place.covariance), **known}


def _pose(pose: Pose, covariance: Floats) -> Mapping[str, Any]:
    return {
        "position": _numbers(pose.translation),
        "orientation": _numbers(quaternion_of(pose.rotation)),
        "covariance": _numbers(covariance.ravel()),
    }


def _numbers(values: Floats) -> list[float]:
    return [_number(float(value)) for value in values]


def _number(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
