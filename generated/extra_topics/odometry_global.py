# Generated from mapping.yaml (row rover_localization) and components/basestation/rover_localization.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the topic odometry/global: BasestationRoverLocalization and nav_msgs/msg/Odometry."""

from __future__ import annotations

from generated.interfaces import geometry_msgs, nav_msgs, std_msgs
from generated.pb2.components.basestation import rover_localization_pb2
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.standard_handler import UNSTAMPED, StandardHandler, single
from roverlink.runtime.interfaces import Time


class OdometryGlobalTopic(
    StandardHandler[
        rover_localization_pb2.BasestationRoverLocalization, nav_msgs.Odometry
    ]
):
    """Position of the rover on the field.

    Extra topic of the row rover_localization, number 21 of the envelope, from the topic
    odometry/global to the peer basestation.
    """

    route = Route(
        number=21,
        name="rover_localization",
        topic="odometry/global",
        direction="ros_to_basestation",
    )
    payload_type = rover_localization_pb2.BasestationRoverLocalization
    message_type = nav_msgs.Odometry

    @staticmethod
    def to_ros(
        payload: rover_localization_pb2.BasestationRoverLocalization,
        stamp: Time = UNSTAMPED,
    ) -> nav_msgs.Odometry:
        """Convert BasestationRoverLocalization to nav_msgs/msg/Odometry; `stamp` is the time of reception."""
        return nav_msgs.Odometry(
            header=std_msgs.Header(stamp=stamp, frame_id="map"),
            pose=geometry_msgs.PoseWithCovariance(
                pose=geometry_msgs.Pose(
                    position=geometry_msgs.Point(x=payload.x, y=payload.y, z=payload.z)
                )
            ),
        )

    @staticmethod
    def from_ros(
        message: nav_msgs.Odometry,
    ) -> rover_localization_pb2.BasestationRoverLocalization:
        """Convert nav_msgs/msg/Odometry to BasestationRoverLocalization."""
        return rover_localization_pb2.BasestationRoverLocalization(
            x=single(message.pose.pose.position.x),
            y=single(message.pose.pose.position.y),
            z=single(message.pose.pose.position.z),
        )
