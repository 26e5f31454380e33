# Generated from mapping.yaml (row drive_motor) and components/driving_board/motor_msg.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row drive_motor: DrivingBoardMotorMessage and comms/msg/DrivingBoardMotorMessage."""

from __future__ import annotations

from generated.messages import DrivingBoardMotorMessage
from generated.pb2.components.driving_board import motor_msg_pb2
from roverlink.runtime.core.handler import Deadman, Handler, Route


class DriveMotorHandler(
    Handler[motor_msg_pb2.DrivingBoardMotorMessage, DrivingBoardMotorMessage]
):
    """DrivingBoardMotorMessage as comms/msg/DrivingBoardMotorMessage.

    A drive command: how far to go, and along which arc. It replaces the one before, also in the middle of its arc.
    With a distance of 0, the radius has no meaning, and the wheels keep their direction.

    Number 9 of the envelope, from the topic drive_motor to the peer hardware.
    """

    route = Route(
        number=9,
        name="drive_motor",
        topic="drive_motor",
        direction="ros_to_hardware",
        deadman=Deadman(
            after_ms=500,
            repeat_ms=1000,
            send={
                "distance_to_go": 0.0,
            },
        ),
        priority=9,
        board="DrivingBoard",
    )
    payload_type = motor_msg_pb2.DrivingBoardMotorMessage
    message_type = DrivingBoardMotorMessage

    @staticmethod
    def to_ros(
        payload: motor_msg_pb2.DrivingBoardMotorMessage,
    ) -> DrivingBoardMotorMessage:
        """Convert DrivingBoardMotorMessage to comms/msg/DrivingBoardMotorMessage."""
        return DrivingBoardMotorMessage(
            distance_to_go=payload.distance_to_go,
            turning_radius=payload.turning_radius,
        )

    @staticmethod
    def from_ros(
        message: DrivingBoardMotorMessage,
    ) -> motor_msg_pb2.DrivingBoardMotorMessage:
        """Convert comms/msg/DrivingBoardMotorMessage to DrivingBoardMotorMessage."""
        return motor_msg_pb2.DrivingBoardMotorMessage(
            distance_to_go=message.distance_to_go,
            turning_radius=message.turning_radius,
        )
