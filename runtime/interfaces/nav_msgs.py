# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package nav_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import geometry_msgs, std_msgs


@dataclass(slots=True)
class Odometry(Message):
    """nav_msgs/msg/Odometry."""

    __msgtype__: ClassVar[str] = "nav_msgs/msg/Odometry"
    __typehash__: ClassVar[str] = "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    child_frame_id: str = ""
    pose: geometry_msgs.PoseWithCovariance = dataclasses.field(default_factory=geometry_msgs.PoseWithCovariance)
    twist: geometry_msgs.TwistWithCovariance = dataclasses.field(default_factory=geometry_msgs.TwistWithCovariance)


@dataclass(slots=True)
class Path(Message):
    """nav_msgs/msg/Path."""

    __msgtype__: ClassVar[str] = "nav_msgs/msg/Path"
    __typehash__: ClassVar[str] = "RIHS01_1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    poses: list[geometry_msgs.PoseStamped] = dataclasses.field(default_factory=list)
