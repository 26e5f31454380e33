"""Results of one frame: the landmarks in it, the camera's pose, and the rover's pose."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.field.landmarks import Landmarks
from roverkit.vision.field.localization import FieldPose, Shot, localize
from roverkit.vision.field.rover import RoverLocalizer, RoverPose
from roverkit.vision.frames import Frame
from roverkit.vision.markers.tracker import Sighting, Tracker
from roverkit.vision.poses.pose import Pose, quaternion_of

_DIGITS = 9  # significant digits, because covariances are small numbers


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Frame with the landmarks that were found in it, and the camera's pose that follows from them."""

    frame: Frame
    sightings: tuple[Sighting, ...]
    place: FieldPose | None = None
    """Camera's pose on the field; None if the frame shows no known landmark."""
    camera: str = ""
    """Name of the camera, if the rover has several."""
    rover: RoverPose | None = None
    """Rover's pose, if the frame completes what its cameras have seen at one time; None if it is unknown."""

    def as_dict(self) -> dict[str, Any]:
        """Return the results as JSON values: metres, pixels, quaternions x y z w, covariances row by row."""
        markers = [_sighting(sighting) for sighting in self.sightings]
        frame = {"stamp": self.frame.stamp, "frame": self.frame.number, "frame_id": self.frame.frame_id}
        found = {**({"name": self.camera} if self.camera else {}), **frame, "markers": markers}
        if self.place:
            found["camera"] = _place(self.place)
        if self.rover:
            found["rover"] = {"stamp": self.rover.stamp, **_place(self.rover.place)}
        return found


@dataclass(eq=False)
class Eye:
    """Camera of a rover, as far as poses need it."""

    tracker: Tracker
    name: str = ""
    """Name, if the rover has several cameras."""
    mount: Callable[[Frame], Pose | None] = lambda _: None
    """Function that returns the transform from the optical frame to the rover's at the time of a frame, if known."""


class Lookout:
    """Finder of landmarks in frames, and of the poses of cameras and rover that follow from them."""

    def __init__(self, eyes: int = 1, landmarks: Landmarks | None = None) -> None:
        """Look with a number of cameras; without landmarks, no poses on the field are computed."""
        self._eyes = eyes
        self.use(landmarks)

    def use(self, landmarks: Landmarks | None) -> None:
        """Use other landmarks from the next frame on."""
        self._rover = RoverLocalizer(self._eyes, landmarks) if landmarks else None

    def view(self, eye: Eye, frame: Frame) -> View:
        """Return the results of a camera's frame. Call this once for each frame."""
        rover = self._rover
        sightings = tuple(eye.tracker.track(frame.image, frame.stamp))
        if rover is None:
            return View(frame, sightings, camera=eye.name)
        mount = eye.mount(frame)
        shot = None if mount is None else Shot(sightings, mount)
        place = localize(sightings, rover.landmarks)
        return View(frame, sightings, place, eye.name, rover.add(eye.name, frame.stamp, shot))


def _sighting(sighting: Sighting) -> Mapping[str, Any]:
    return {
        "id": sighting.id,
        **_pose(sighting.pose, sighting.covariance),
        "corners": [_numbers(corner) for corner in sighting.corners],
        "error": _number(sighting.error),
        "other_pose": _other(sighting),
        "shared": sighting.shared,
    }


def _other(sighting: Sighting) -> Mapping[str, Any] | None:
    """Return the pose of a landmark that was not chosen, as JSON values; None if there is only one possible pose.

    `ambiguity` is the ratio of its reprojection error to that of the chosen pose.
    """
    for solution in sighting.solutions:
        if solution.pose is not sighting.pose:
            return {**_pose(solution.pose, solution.covariance), "ambiguity": _number(sighting.ambiguity)}
    return None


def _place(place: FieldPose) -> Mapping[str, Any]:
    pose = _pose(place.pose, place.covariance) if place.agreed else {}
    return {"frame": place.frame, **pose, "used": list(place.used), "rejected": list(place.rejected)}


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
