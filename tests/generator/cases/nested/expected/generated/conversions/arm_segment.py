# Generated from mapping.yaml and arm.proto; do not edit.
# Regenerate with: roverlink generate
"""Arm.Segment to and from rover/msg/ArmSegment."""

from __future__ import annotations

from generated.conversions import arm_segment_bolt, joint
from generated.messages import ArmSegment
from generated.pb2 import arm_pb2


def to_ros(payload: arm_pb2.Arm.Segment) -> ArmSegment:
    """The message that says what the payload says."""
    return ArmSegment(
        bolts=[arm_segment_bolt.to_ros(item) for item in payload.bolts],
        joint=joint.to_ros(payload.joint),
    )


def from_ros(message: ArmSegment) -> arm_pb2.Arm.Segment:
    """The payload that says what the message says."""
    return arm_pb2.Arm.Segment(
        bolts=[arm_segment_bolt.from_ros(item) for item in message.bolts],
        joint=joint.from_ros(message.joint),
    )
