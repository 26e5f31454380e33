"""Pose of a rover from what its cameras have seen at nearly the same time.

The cameras of a rover are not synchronized. Their frames belong together if their stamps differ by at most `SLOP_NS`;
the rover's motion in this time is an error of the pose.
"""

from __future__ import annotations

from dataclasses import dataclass

from roverkit.vision.localization.landmarks import Landmarks
from roverkit.vision.localization.pose_from_landmarks import CameraDetections, FieldPose, localize_rover

SLOP_NS = 50_000_000
"""Largest difference in nanoseconds of the stamps of frames that belong together: one frame at 20 Hz."""


@dataclass(frozen=True, slots=True, eq=False)
class RoverPose:
    """Pose of the rover at a time."""

    stamp: int
    """Time of the newest frame in nanoseconds."""
    field_pose: FieldPose
    """Transform from the rover's frame to that of the field."""


class RoverLocalizer:
    """Localizer of a rover: it joins the frames of its cameras that belong together. Every frame is used once.

    A camera that stops delays the poses of the others by one frame.
    """

    def __init__(self, cameras: int, landmarks: Landmarks) -> None:
        """Locate a rover with this number of cameras."""
        self._cameras, self.landmarks = cameras, landmarks
        self._waiting: dict[str, tuple[int, CameraDetections]] = {}

    def add(self, camera: str, stamp: int, seen: CameraDetections | None) -> RoverPose | None:
        """Add what a camera has seen in a frame, and return the rover's pose if that completes it.

        `stamp` is the time of the frame in nanoseconds. `seen` is None if the mount of the camera is unknown.
        """
        found = None
        if camera in self._waiting or any(abs(stamp - other) > SLOP_NS for other, _ in self._waiting.values()):
            found = self._located()
        if seen is not None:
            self._waiting[camera] = (stamp, seen)
        return self._located() if len(self._waiting) == self._cameras else found

    def _located(self) -> RoverPose | None:
        """Return the pose from all frames that wait; None if they show no known landmark."""
        waiting, self._waiting = self._waiting, {}
        if not waiting:
            return None
        stamps, seen = zip(*waiting.values())
        field_pose = localize_rover(seen, self.landmarks)
        return RoverPose(max(stamps), field_pose) if field_pose else None
