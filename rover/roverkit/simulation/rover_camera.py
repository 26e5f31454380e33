"""Camera of a simulated rover: it sees the markers of a field at their places."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import math
from pathlib import Path

import numpy as np
from roverkit.demo.field import AHEAD, HEIGHT_M, LENS, SIDE, parameters
from roverkit.driving.arcs import PlanarPose
from roverkit.vision import Pose, read_landmarks
from roverkit.vision.images.rendering import Pose as PrintPose
from roverkit.vision.images.rendering import Print, marker_print, outline, render, texture
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverkit.vision.poses.pose import rotation_of
from roverkit.vision.ros.landmark_messages import FrameNames, camera_info_of

from roverlink.runtime import SetupError
from roverlink.runtime.interfaces import sensor_msgs
from roverlink.runtime.ros_time.headers import header_of

FRAME = "camera_optical"
"""Name of the camera's frame."""
_NEAREST_M, _FARTHEST_M = 0.3, 12.0
_FACING = math.cos(math.radians(80))  # of the angle at which a marker is too slanted to be seen


class RoverCamera:
    """Camera at the height of the demo's, above the origin of base_link; it looks ahead."""

    def __init__(self, landmarks: Path, seed: int) -> None:
        """Read the file with the landmarks. Raises `SetupError` if it cannot be used, or names a board."""
        known = read_landmarks(landmarks)
        boards = [name for name in known.places if not isinstance(name, int)]
        if boards:
            raise SetupError(f"{landmarks}: {boards[0]!r} is a board; the simulated rover sees only single markers")
        self._places = {number: landmark.pose for number, landmark in known.places.items()}
        self._prints = {number: _marker(landmarks, number) for number in self._places}
        self._rng = np.random.default_rng(seed)
        self._background = texture(LENS.size, self._rng)

    def image(self, rover: PlanarPose) -> Image:
        """Return the image (H, W) of the camera when base_link has a pose in the frame of the field."""
        place = _on_field(rover) @ Pose(AHEAD, np.array([0.0, 0.0, HEIGHT_M]))
        to_camera = place.inverse()
        seen = [(number, to_camera @ pose) for number, pose in self._places.items()]
        # A print hides those that are painted before it, so that the farthest is the first.
        ordered = sorted(seen, key=lambda plane: -float(np.linalg.norm(plane[1].translation)))
        planes = [(self._prints[number], PrintPose(pose.rotation, pose.translation)) for number, pose in ordered]
        image: Image = render(LENS, self._background, [plane for plane in planes if self._sees(*plane)], self._rng)
        return image

    def messages(self, rover: PlanarPose, stamp: int) -> tuple[sensor_msgs.Image, sensor_msgs.CameraInfo]:
        """Return the messages of an image and of the camera's parameters; ``stamp`` is in nanoseconds."""
        image = self.image(rover)
        height, width = image.shape
        info = camera_info_of(parameters(), (width, height), stamp, FrameNames(FRAME, ""))
        return sensor_msgs.Image(header_of(stamp, FRAME), height, width, "mono8", 0, width, image.tobytes()), info

    def _sees(self, plane: Print, pose: PrintPose) -> bool:
        """Return true if a part of a print is in the image, and it faces the camera."""
        distance = float(np.linalg.norm(pose.translation))
        facing = -float(pose.rotation[:, 2] @ pose.translation) / distance
        if not (_NEAREST_M < distance < _FARTHEST_M and facing > _FACING):
            return False
        if pose.translation[2] < sum(plane.half_size) + _NEAREST_M:
            return False
        rim, (width, height) = outline(LENS, plane, pose), LENS.size
        low, high = rim.min(axis=0), rim.max(axis=0)
        return bool((high > 0).all() and low[0] < width and low[1] < height)


def _marker(landmarks: Path, number: int | str) -> Print:
    try:
        return marker_print(cv2.aruco.DICT_5X5_250, int(number), SIDE, texels=8)
    except cv2.error as error:
        raise SetupError(f"{landmarks}: the dictionary DICT_5X5_250 has no marker {number}") from error


def _on_field(rover: PlanarPose) -> Pose:
    return Pose(rotation_of(np.array([0.0, 0.0, rover.yaw])), np.array([rover.x, rover.y, 0.0]))
