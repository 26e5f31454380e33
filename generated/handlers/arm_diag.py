# Generated from mapping.yaml (row arm_diag) and components/arm_board/motor_diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm_diag: ArmBoardDiagnostics and comms/msg/ArmBoardDiagnostics."""

from __future__ import annotations

from generated.conversions import motor_information
from generated.messages import ArmBoardDiagnostics
from generated.pb2.components.arm_board import motor_diagnostics_pb2
from roverlink.runtime.core.handler import Handler, Route


class ArmDiagHandler(
    Handler[motor_diagnostics_pb2.ArmBoardDiagnostics, ArmBoardDiagnostics]
):
    """State of the arm board and of each of its motors.

    Number 3 of the envelope, from the peer hardware to the topic arm_diag.
    """

    route = Route(
        number=3,
        name="arm_diag",
        topic="arm_diag",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="ArmBoard",
    )
    payload_type = motor_diagnostics_pb2.ArmBoardDiagnostics
    message_type = ArmBoardDiagnostics

    @staticmethod
    def to_ros(
        payload: motor_diagnostics_pb2.ArmBoardDiagnostics,
    ) -> ArmBoardDiagnostics:
        """Convert ArmBoardDiagnostics to comms/msg/ArmBoardDiagnostics."""
        return ArmBoardDiagnostics(
            gripper_rotation_motor=motor_information.to_ros(
                payload.gripper_rotation_motor
            ),
            gripper_pitch_motor=motor_information.to_ros(payload.gripper_pitch_motor),
            base_motor=motor_information.to_ros(payload.base_motor),
            top_motor=motor_information.to_ros(payload.top_motor),
            bottom_motor=motor_information.to_ros(payload.bottom_motor),
            jaw_motor=motor_information.to_ros(payload.jaw_motor),
            state=payload.state,
        )

    @staticmethod
    def from_ros(
        message: ArmBoardDiagnostics,
    ) -> motor_diagnostics_pb2.ArmBoardDiagnostics:
        """Convert comms/msg/ArmBoardDiagnostics to ArmBoardDiagnostics."""
        return motor_diagnostics_pb2.ArmBoardDiagnostics(
            gripper_rotation_motor=motor_information.from_ros(
                message.gripper_rotation_motor
            ),
            gripper_pitch_motor=motor_information.from_ros(message.gripper_pitch_motor),
            base_motor=motor_information.from_ros(message.base_motor),
            top_motor=motor_information.from_ros(message.top_motor),
            bottom_motor=motor_information.from_ros(message.bottom_motor),
            jaw_motor=motor_information.from_ros(message.jaw_motor),
            state=message.state,
        )
