# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package std_msgs."""

from __future__ import annotations

from roverlink.runtime.interfaces.std_msgs import Header

__all__ = [
    "Header",
]
