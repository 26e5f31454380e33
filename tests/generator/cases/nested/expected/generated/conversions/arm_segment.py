# Generated from mapping.yaml and arm.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages Arm.Segment and rover/msg/ArmSegment."""

from __future__ import annotations

from generated.conversions import arm_segment_bolt, joint
from generated.messages import ArmSegment
from generated.pb2 import arm_pb2


def to_ros(payload: arm_pb2.Arm.Segment) -> ArmSegment:
    """Convert Arm.Segment to rover/msg/ArmSegment."""
    return ArmSegment(
        bolts=[arm_segment_bolt.to_ros(item) for item in payload.bolts],
        joint=joint.to_ros(payload.joint),
    )


def from_ros(message: ArmSegment) -> arm_pb2.Arm.Segment:
    """Convert rover/msg/ArmSegment to Arm.Segment."""
    return arm_pb2.Arm.Segment(
        bolts=[arm_segment_bolt.from_ros(item) for item in message.bolts],
        joint=joint.from_ros(message.joint),
    )
