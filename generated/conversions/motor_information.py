# Generated from mapping.yaml and components/common/motor.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages MotorInformation and comms/msg/MotorInformation."""

from __future__ import annotations

from generated.messages import MotorInformation
from generated.pb2.components.common import motor_pb2


def to_ros(payload: motor_pb2.MotorInformation) -> MotorInformation:
    """Convert MotorInformation to comms/msg/MotorInformation."""
    return MotorInformation(
        state=payload.state,
        motor_id=payload.motor_id,
        rpm=payload.rpm,
        voltage=payload.voltage,
        encoder_angle=payload.encoder_angle,
    )


def from_ros(message: MotorInformation) -> motor_pb2.MotorInformation:
    """Convert comms/msg/MotorInformation to MotorInformation."""
    return motor_pb2.MotorInformation(
        state=message.state,
        motor_id=message.motor_id,
        rpm=message.rpm,
        voltage=message.voltage,
        encoder_angle=message.encoder_angle,
    )
