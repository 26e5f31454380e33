# Generated from mapping.yaml (row drive_diag) and components/driving_board/motor_diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row drive_diag: DrivingBoardDiagnostics and comms/msg/DrivingBoardDiagnostics."""

from __future__ import annotations

from generated.conversions import motor_information
from generated.messages import DrivingBoardDiagnostics
from generated.pb2.components.driving_board import motor_diagnostics_pb2
from roverlink.runtime.core.handler import Handler, Route


class DriveDiagHandler(
    Handler[motor_diagnostics_pb2.DrivingBoardDiagnostics, DrivingBoardDiagnostics]
):
    """State of the driving board and of each wheel and steering motor.

    Number 8 of the envelope, from the peer hardware to the topic drive_diag.
    """

    route = Route(
        number=8,
        name="drive_diag",
        topic="drive_diag",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="DrivingBoard",
    )
    payload_type = motor_diagnostics_pb2.DrivingBoardDiagnostics
    message_type = DrivingBoardDiagnostics

    @staticmethod
    def to_ros(
        payload: motor_diagnostics_pb2.DrivingBoardDiagnostics,
    ) -> DrivingBoardDiagnostics:
        """Convert DrivingBoardDiagnostics to comms/msg/DrivingBoardDiagnostics."""
        return DrivingBoardDiagnostics(
            state=payload.state,
            front_left_motor=motor_information.to_ros(payload.front_left_motor),
            middle_left_motor=motor_information.to_ros(payload.middle_left_motor),
            back_left_motor=motor_information.to_ros(payload.back_left_motor),
            front_right_motor=motor_information.to_ros(payload.front_right_motor),
            middle_right_motor=motor_information.to_ros(payload.middle_right_motor),
            back_right_motor=motor_information.to_ros(payload.back_right_motor),
            steering_front_left_motor=motor_information.to_ros(
                payload.steering_front_left_motor
            ),
            steering_back_left_motor=motor_information.to_ros(
                payload.steering_back_left_motor
            ),
            steering_front_right_motor=motor_information.to_ros(
                payload.steering_front_right_motor
            ),
            steering_back_right_motor=motor_information.to_ros(
                payload.steering_back_right_motor
            ),
        )

    @staticmethod
    def from_ros(
        message: DrivingBoardDiagnostics,
    ) -> motor_diagnostics_pb2.DrivingBoardDiagnostics:
        """Convert comms/msg/DrivingBoardDiagnostics to DrivingBoardDiagnostics."""
        return motor_diagnostics_pb2.DrivingBoardDiagnostics(
            state=message.state,
            front_left_motor=motor_information.from_ros(message.front_left_motor),
            middle_left_motor=motor_information.from_ros(message.middle_left_motor),
            back_left_motor=motor_information.from_ros(message.back_left_motor),
            front_right_motor=motor_information.from_ros(message.front_right_motor),
            middle_right_motor=motor_information.from_ros(message.middle_right_motor),
            back_right_motor=motor_information.from_ros(message.back_right_motor),
            steering_front_left_motor=motor_information.from_ros(
                message.steering_front_left_motor
            ),
            steering_back_left_motor=motor_information.from_ros(
                message.steering_back_left_motor
            ),
            steering_front_right_motor=motor_information.from_ros(
                message.steering_front_right_motor
            ),
            steering_back_right_motor=motor_information.from_ros(
                message.steering_back_right_motor
            ),
        )
