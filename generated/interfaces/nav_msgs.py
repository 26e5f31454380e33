# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package nav_msgs."""

from __future__ import annotations

from roverlink.runtime.interfaces.nav_msgs import Odometry

__all__ = [
    "Odometry",
]
