# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package geometry_msgs."""

from __future__ import annotations

from roverlink.runtime.interfaces.geometry_msgs import Quaternion, Vector3

__all__ = [
    "Quaternion",
    "Vector3",
]
