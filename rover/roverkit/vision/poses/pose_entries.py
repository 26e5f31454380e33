"""Reading of poses in YAML files.

A pose has a `position` in metres, and a rotation as `rpy` or as `orientation`. `rpy` are angles in degrees about the
fixed x, y and z axes, applied in this order (as in URDF). `orientation` is a quaternion x y z w.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.poses.pose import Pose, rotation_of, rotation_of_quaternion
from roverkit.vision.yaml_file import Item

POSE = frozenset(("position", "rpy", "orientation"))
"""Keys of a pose."""
_UNIT = 0.01  # largest deviation of a quaternion's length from 1


def pose(item: Item, entries: Mapping[str, Item]) -> Pose:
    """Return the pose that a mapping in a YAML file describes. Raises `SetupError` if it describes no pose.

    `item` is the mapping, and `entries` are its values by their keys.
    """
    if "position" not in entries:
        raise item.error(f"{item.name} has no position; add 'position: [x, y, z]' in metres")
    if ("rpy" in entries) == ("orientation" in entries):
        raise item.error(f"{item.name} needs either rpy or orientation, and not both")
    rotation = _of_rpy(entries["rpy"]) if "rpy" in entries else _of_quaternion(entries["orientation"])
    return Pose(rotation, entries["position"].numbers(3))


def _of_rpy(rpy: Item) -> Floats:
    roll, pitch, yaw = (rotation_of(np.radians(angle) * axis) for angle, axis in zip(rpy.numbers(3), np.eye(3)))
    rotation: Floats = yaw @ pitch @ roll
    return rotation


def _of_quaternion(orientation: Item) -> Floats:
    quaternion = orientation.numbers(4)
    length = float(np.linalg.norm(quaternion))
    if abs(length - 1) > _UNIT:
        raise orientation.error(f"{orientation.name} has the length {length:.3g}; a quaternion x y z w has length 1")
    return rotation_of_quaternion(quaternion)
