# Generated from mapping.yaml (row imu) and imu.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row imu: Imu and rover/msg/Imu."""

from __future__ import annotations

from generated.conversions import deep, vector
from generated.messages import Imu
from generated.pb2 import imu_pb2
from roverlink.runtime.core.handler import Handler, Route


class ImuHandler(Handler[imu_pb2.Imu, Imu]):
    """Imu as rover/msg/Imu.

    Number 1 of the envelope, board_to_ros, topic imu.
    """

    route = Route(
        number=1,
        name="imu",
        topic="imu",
        direction="board_to_ros",
    )
    payload_type = imu_pb2.Imu
    message_type = Imu

    @staticmethod
    def to_ros(payload: imu_pb2.Imu) -> Imu:
        """Convert Imu to rover/msg/Imu."""
        return Imu(
            a=vector.to_ros(payload.a),
            deep=deep.to_ros(payload.deep),
        )

    @staticmethod
    def from_ros(message: Imu) -> imu_pb2.Imu:
        """Convert rover/msg/Imu to Imu."""
        return imu_pb2.Imu(
            a=vector.from_ros(message.a),
            deep=deep.from_ros(message.deep),
        )
