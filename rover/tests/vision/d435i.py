"""A rendered RealSense D435i on a rover: colour, depth aligned to it, the camera's parameters, and its mount."""

from __future__ import annotations

from typing import Any

import numpy as np
from roverkit.demo.field import parameters
from roverkit.vision.poses.pose import Pose, quaternion_of, rotation_of

from rover.bench.vision.circling_film import render_film
from rover.tests.vision.ros_images import FRAME, camera_info, header, image
from roverlink.runtime.interfaces import geometry_msgs, tf2_msgs
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, Image

COLOUR, INFO = "/camera/camera/color/image_raw", "/camera/camera/color/camera_info"
DEPTH = "/camera/camera/aligned_depth_to_color/image_raw"
TOPICS = {COLOUR: Image, DEPTH: Image, INFO: CameraInfo}
PERIOD_NS = 33_333_333
BEGAN_NS = 1_700_000_000_000_000_000
_MOUNT = Pose(rotation_of(np.radians([0, 0, 8.0])), np.array([0.31, -0.04, 0.42]))  # camera_link in base_link
_COLOUR = Pose(np.eye(3), np.array([0.0, 0.015, 0.0]))  # as in the driver's description of the D435i
_OPTICAL = Pose(np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]), np.zeros(3))
_CHAIN = (
    ("base_link", "camera_link", _MOUNT),
    ("camera_link", "camera_color_frame", _COLOUR),
    ("camera_color_frame", FRAME, _OPTICAL),
)
_DEPTH_MM = np.tile(np.array([[2000] * 320 + [5000] * 320], np.uint16), (480, 1))  # a wall beside a nearer one
_CHI2_95 = 7.815  # of three degrees of freedom


class RenderedD435i:
    """The camera on a rover that drives past the landmarks of the demo, again and again."""

    def __init__(self, frames: int) -> None:
        self._film = render_film(frames)

    @property
    def transforms(self) -> tf2_msgs.TFMessage:
        """What the robot's description and the driver put on /tf_static."""
        return tf2_msgs.TFMessage([_transform(*link) for link in _CHAIN])

    def messages(self, number: int) -> tuple[Image, Image, CameraInfo]:
        """Colour, depth in millimetres, and the camera's parameters, with one stamp."""
        stamp, index = BEGAN_NS + PERIOD_NS * number, number % len(self._film.frames)
        colour = image(self._film.frames[index][:, :, ::-1], "rgb8", stamp)
        return colour, image(_DEPTH_MM, "16UC1", stamp), camera_info(parameters(), stamp)

    def rover(self, stamp: int) -> Pose:
        """The true pose of base_link on the field in the frame with this stamp."""
        number, rest = divmod(stamp - BEGAN_NS, PERIOD_NS)
        assert not rest
        return self._film.truth[number % len(self._film.truth)] @ (_MOUNT @ _COLOUR @ _OPTICAL).inverse()

    def is_inside(self, stamp: int, position: Any, covariance: Any) -> bool:
        """True if base_link is inside the 95 % ellipsoid of a position that was found for it."""
        off = np.array(position) - self.rover(stamp).translation
        return float(off @ np.linalg.solve(np.reshape(covariance, (6, 6))[:3, :3], off)) < _CHI2_95


def _transform(parent: str, child: str, pose: Pose) -> geometry_msgs.TransformStamped:
    turn = geometry_msgs.Quaternion(*quaternion_of(pose.rotation).tolist())
    way = geometry_msgs.Vector3(*pose.translation.tolist())
    return geometry_msgs.TransformStamped(header(0, parent), child, geometry_msgs.Transform(way, turn))
