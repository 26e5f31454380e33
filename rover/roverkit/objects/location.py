"""Positions of detected objects in space, from a depth image that is aligned to the camera's image."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from roverkit.objects.detected_objects import Box
from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.poses.pose import Pose

_CENTRE = 0.5
"""Part of a box, along both sides, whose depths are used: at the rim, the background may be seen."""
_VALID = 0.3
"""Least part of these pixels that must have a depth."""
_DEPTH_SIGMA = 0.01
"""Standard deviation of a depth as a fraction of it; the data sheet of the D435 allows 0.02 at 2 m."""
_BOX_SIGMA = 0.05
"""Standard deviation of a box's centre as a fraction of its side, as the tracker assumes it."""
_MAD = 1.4826  # standard deviation of a normal distribution divided by the median absolute deviation


@dataclass(frozen=True, slots=True, eq=False)
class Location:
    """Position of an object in a coordinate frame: the middle of the surface that the camera sees."""

    point: Floats
    """Position (3,) in metres."""
    covariance: Floats
    """Covariance (3, 3) of the position about the axes of the frame."""

    def through(self, pose: Pose) -> Location:
        """Return the position in another frame; `pose` is the transform to it, whose own error is not added."""
        return Location(pose.apply(self.point), pose.rotation @ self.covariance @ pose.rotation.T)

    def after(self, seconds: float, speed: float) -> Location:
        """Return the position after a time in which it becomes uncertain by `speed`, in metres per second."""
        return replace(self, covariance=self.covariance + (speed * seconds) ** 2 * np.eye(3))


def locate(box: Box, depth: Floats, camera: CameraParameters) -> Location | None:
    """Return the position of an object in the camera's optical frame (REP 103); None if too few depths are known.

    `depth` (H, W) has the depths in metres along the optical axis; NaN or 0 where they are missing.
    """
    centre = np.array([box.x + box.width / 2, box.y + box.height / 2])
    half = np.array([box.width, box.height]) * _CENTRE / 2
    (left, top), (right, bottom) = np.floor(centre - half).astype(int), np.ceil(centre + half).astype(int)
    inside = depth[max(top, 0) : bottom, max(left, 0) : right]
    valid = inside[(inside > 0) & np.isfinite(inside)].astype(float)
    if not valid.size or valid.size < _VALID * inside.size:
        return None
    distance = float(np.median(valid))
    spread = _MAD * float(np.median(np.abs(valid - distance)))
    ray = np.append(camera.undistort(centre[np.newaxis])[0], 1.0)
    # Errors of the box move the position across the ray, errors of the depth move it along the ray.
    across = _BOX_SIGMA * distance * np.array([box.width, box.height]) / camera.focal
    along = math.hypot(_DEPTH_SIGMA * distance, spread) * ray
    return Location(distance * ray, np.diag([*across**2, 0.0]) + np.outer(along, along))
