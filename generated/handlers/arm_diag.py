# Generated from mapping.yaml (row arm_diag) and components/arm_board/motor_diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""arm_diag (3): ArmBoardDiagnostics to comms/msg/ArmBoardDiagnostics on arm_diag."""

from __future__ import annotations

from generated.conversions import motor_information
from generated.messages import ArmBoardDiagnostics
from generated.pb2.components.arm_board import motor_diagnostics_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(ArmBoardDiagnostics)


class ArmDiagHandler(
    Handler[motor_diagnostics_pb2.ArmBoardDiagnostics, ArmBoardDiagnostics],
):
    """ArmBoardDiagnostics to the topic arm_diag."""

    route = Route(
        number=3,
        name="arm_diag",
        topic="arm_diag",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = motor_diagnostics_pb2.ArmBoardDiagnostics
    message_type = ArmBoardDiagnostics

    @staticmethod
    def to_ros(
        payload: motor_diagnostics_pb2.ArmBoardDiagnostics,
    ) -> ArmBoardDiagnostics:
        """The message that says what the payload says."""
        return ArmBoardDiagnostics(
            gripper_rotation_motor=motor_information.to_ros(
                payload.gripper_rotation_motor,
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
        """The payload that says what the message says."""
        return motor_diagnostics_pb2.ArmBoardDiagnostics(
            gripper_rotation_motor=motor_information.from_ros(
                message.gripper_rotation_motor,
            ),
            gripper_pitch_motor=motor_information.from_ros(message.gripper_pitch_motor),
            base_motor=motor_information.from_ros(message.base_motor),
            top_motor=motor_information.from_ros(message.top_motor),
            bottom_motor=motor_information.from_ros(message.bottom_motor),
            jaw_motor=motor_information.from_ros(message.jaw_motor),
            state=message.state,
        )

    def pack(self, payload: motor_diagnostics_pb2.ArmBoardDiagnostics) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        gripper_rotation_motor = payload.gripper_rotation_motor
        gripper_pitch_motor = payload.gripper_pitch_motor
        base_motor = payload.base_motor
        top_motor = payload.top_motor
        bottom_motor = payload.bottom_motor
        jaw_motor = payload.jaw_motor
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            gripper_rotation_motor.state,
            gripper_rotation_motor.motor_id,
            gripper_rotation_motor.rpm,
            gripper_rotation_motor.voltage,
            gripper_rotation_motor.encoder_angle,
            gripper_pitch_motor.state,
            gripper_pitch_motor.motor_id,
            gripper_pitch_motor.rpm,
            gripper_pitch_motor.voltage,
            gripper_pitch_motor.encoder_angle,
            base_motor.state,
            base_motor.motor_id,
            base_motor.rpm,
            base_motor.voltage,
            base_motor.encoder_angle,
            top_motor.state,
            top_motor.motor_id,
            top_motor.rpm,
            top_motor.voltage,
            top_motor.encoder_angle,
            bottom_motor.state,
            bottom_motor.motor_id,
            bottom_motor.rpm,
            bottom_motor.voltage,
            bottom_motor.encoder_angle,
            jaw_motor.state,
            jaw_motor.motor_id,
            jaw_motor.rpm,
            jaw_motor.voltage,
            jaw_motor.encoder_angle,
            payload.state,
        )
