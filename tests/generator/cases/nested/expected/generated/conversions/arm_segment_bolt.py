# Generated from mapping.yaml and arm.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages Arm.Segment.Bolt and rover/msg/ArmSegmentBolt."""

from __future__ import annotations

from generated.messages import ArmSegmentBolt
from generated.pb2 import arm_pb2


def to_ros(payload: arm_pb2.Arm.Segment.Bolt) -> ArmSegmentBolt:
    """Convert Arm.Segment.Bolt to rover/msg/ArmSegmentBolt."""
    return ArmSegmentBolt(
        torque=payload.torque,
    )


def from_ros(message: ArmSegmentBolt) -> arm_pb2.Arm.Segment.Bolt:
    """Convert rover/msg/ArmSegmentBolt to Arm.Segment.Bolt."""
    return arm_pb2.Arm.Segment.Bolt(
        torque=message.torque,
    )
