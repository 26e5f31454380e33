# Generated from mapping.yaml (row imu) and imu.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row imu: Imu and rover/msg/ImuSample."""

from __future__ import annotations

from generated.conversions import point, vector
from generated.messages import ImuSample, Kind
from generated.pb2 import imu_pb2
from roverlink.runtime.core.handler import Handler, Route


class ImuHandler(Handler[imu_pb2.Imu, ImuSample]):
    """Imu as rover/msg/ImuSample.

    Number 1 of the envelope, board_to_ros, topic imu/sample.
    """

    route = Route(
        number=1,
        name="imu",
        topic="imu/sample",
        direction="board_to_ros",
    )
    payload_type = imu_pb2.Imu
    message_type = ImuSample

    @staticmethod
    def to_ros(payload: imu_pb2.Imu) -> ImuSample:
        """Convert Imu to rover/msg/ImuSample."""
        return ImuSample(
            sensor=payload.sensor_1,
            accel_x=payload.acceleration.x,
            accel_y=payload.acceleration.y,
            pose_mode=payload.pose.mode,
            has_latitude=payload.pose.place.HasField("latitude"),
            latitude=payload.pose.place.latitude,
            marks=list(payload.pose.place.marks),
            points=[point.to_ros(item) for item in payload.pose.place.points],
            kind=Kind(value=payload.pose.kind),
            seconds=payload.stamp.seconds,
            turn=vector.to_ros(payload.turn),
        )

    @staticmethod
    def from_ros(message: ImuSample) -> imu_pb2.Imu:
        """Convert rover/msg/ImuSample to Imu."""
        return imu_pb2.Imu(
            sensor_1=message.sensor,
            acceleration={"x": message.accel_x, "y": message.accel_y},
            pose={
                "mode": message.pose_mode,
                "place": {
                    "latitude": message.latitude if message.has_latitude else None,
                    "marks": message.marks,
                    "points": [point.from_ros(item) for item in message.points],
                },
                "kind": message.kind.value,
            },
            stamp={"seconds": message.seconds},
            turn=vector.from_ros(message.turn),
        )
