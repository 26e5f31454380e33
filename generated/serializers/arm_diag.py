# Generated from mapping.yaml (row arm_diag) and components/arm_board/motor_diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of ArmBoardDiagnostics as comms/msg/ArmBoardDiagnostics.

The registry uses this class; programs import `ArmDiagHandler`
from `generated.handlers.arm_diag`.
"""

from __future__ import annotations

from generated.handlers.arm_diag import ArmDiagHandler
from generated.messages import ArmBoardDiagnostics
from generated.pb2.components.arm_board import motor_diagnostics_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(ArmBoardDiagnostics)


class FastArmDiagHandler(ArmDiagHandler):
    """ArmDiagHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: motor_diagnostics_pb2.ArmBoardDiagnostics) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        gripper_rotation_motor = payload.gripper_rotation_motor
        gripper_pitch_motor = payload.gripper_pitch_motor
        base_motor = payload.base_motor
        top_motor = payload.top_motor
        bottom_motor = payload.bottom_motor
        jaw_motor = payload.jaw_motor
        return _LAYOUT.pack(
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
