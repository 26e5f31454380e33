# Generated from mapping.yaml (row rover_localization) and components/basestation/rover_localization.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of BasestationRoverLocalization as nav_msgs/msg/Odometry.

The registry uses this class; programs import `OdometryGlobalTopic`
from `generated.extra_topics.odometry_global`.
"""

from __future__ import annotations

from generated.extra_topics.odometry_global import OdometryGlobalTopic
from generated.interfaces import nav_msgs, std_msgs
from generated.pb2.components.basestation import rover_localization_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.standard_handler import UNSTAMPED
from roverlink.runtime.interfaces import Time

# Constant fields are serialized only once. The bytes of the other fields are inserted between them.
_SERIALIZED = cdr.template(
    nav_msgs.Odometry(header=std_msgs.Header(frame_id="map")),
    [
        "header.stamp",
        "pose.pose.position",
    ],
)
_BEFORE_HEADER_STAMP_SEC, _BEFORE_POSE_POSE_POSITION_X, _END = _SERIALIZED.constants
_LAYOUT = _SERIALIZED.layout


class FastOdometryGlobalTopic(OdometryGlobalTopic):
    """OdometryGlobalTopic that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self,
        payload: rover_localization_pb2.BasestationRoverLocalization,
        stamp: Time = UNSTAMPED,
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            _BEFORE_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _BEFORE_POSE_POSE_POSITION_X,
            payload.x,
            payload.y,
            payload.z,
            _END,
        )
