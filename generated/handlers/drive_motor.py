# Generated from mapping.yaml (row drive_motor) and components/driving_board/motor_msg.proto; do not edit.
# Regenerate with: roverlink generate
"""drive_motor (9): DrivingBoardMotorMessage from comms/msg/DrivingBoardMotorMessage on drive_motor."""

from __future__ import annotations

from generated.messages import DrivingBoardMotorMessage
from generated.pb2.components.driving_board import motor_msg_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Deadman, Handler, Route

_CDR = cdr.fixed_layout(DrivingBoardMotorMessage)


class DriveMotorHandler(
    Handler[motor_msg_pb2.DrivingBoardMotorMessage, DrivingBoardMotorMessage],
):
    """DrivingBoardMotorMessage from the topic drive_motor."""

    route = Route(
        number=9,
        name="drive_motor",
        topic="drive_motor",
        direction="ros_to_hardware",
        deadman=Deadman(after_ms=500, repeat_ms=1000, send={"distance_to_go": 0.0}),
        priority=9,
    )
    payload_type = motor_msg_pb2.DrivingBoardMotorMessage
    message_type = DrivingBoardMotorMessage

    @staticmethod
    def to_ros(
        payload: motor_msg_pb2.DrivingBoardMotorMessage,
    ) -> DrivingBoardMotorMessage:
        """The message that says what the payload says."""
        return DrivingBoardMotorMessage(
            distance_to_go=payload.distance_to_go,
            turning_radius=payload.turning_radius,
        )

    @staticmethod
    def from_ros(
        message: DrivingBoardMotorMessage,
    ) -> motor_msg_pb2.DrivingBoardMotorMessage:
        """The payload that says what the message says."""
        return motor_msg_pb2.DrivingBoardMotorMessage(
            distance_to_go=message.distance_to_go,
            turning_radius=message.turning_radius,
        )

    def pack(self, payload: motor_msg_pb2.DrivingBoardMotorMessage) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.distance_to_go,
            payload.turning_radius,
        )
