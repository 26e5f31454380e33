# Generated from mapping.yaml (row imu) and imu.proto; do not edit.
# Regenerate with: roverlink generate
"""imu (1): Imu to rover/msg/Imu on imu."""

from __future__ import annotations

from generated.conversions import deep, vector
from generated.messages import Imu
from generated.pb2 import imu_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Imu)


class ImuHandler(Handler[imu_pb2.Imu, Imu]):
    """Imu to the topic imu."""

    route = Route(number=1, name="imu", topic="imu", direction="board_to_ros")
    payload_type = imu_pb2.Imu
    message_type = Imu

    @staticmethod
    def to_ros(payload: imu_pb2.Imu) -> Imu:
        """The message that says what the payload says."""
        return Imu(a=vector.to_ros(payload.a), deep=deep.to_ros(payload.deep))

    @staticmethod
    def from_ros(message: Imu) -> imu_pb2.Imu:
        """The payload that says what the message says."""
        return imu_pb2.Imu(
            a=vector.from_ros(message.a),
            deep=deep.from_ros(message.deep),
        )

    def pack(self, payload: imu_pb2.Imu) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        a = payload.a
        deep = payload.deep
        return _CDR.pack(cdr.LITTLE_ENDIAN, a.x, deep.x)
