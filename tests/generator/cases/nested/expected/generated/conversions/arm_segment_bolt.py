# Generated from mapping.yaml and arm.proto; do not edit.
# Regenerate with: roverlink generate
"""Arm.Segment.Bolt to and from rover/msg/ArmSegmentBolt."""

from __future__ import annotations

from generated.messages import ArmSegmentBolt
from generated.pb2 import arm_pb2


def to_ros(payload: arm_pb2.Arm.Segment.Bolt) -> ArmSegmentBolt:
    """The message that says what the payload says."""
    return ArmSegmentBolt(torque=payload.torque)


def from_ros(message: ArmSegmentBolt) -> arm_pb2.Arm.Segment.Bolt:
    """The payload that says what the message says."""
    return arm_pb2.Arm.Segment.Bolt(torque=message.torque)
