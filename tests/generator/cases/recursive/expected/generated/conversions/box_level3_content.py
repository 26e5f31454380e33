# Generated from mapping.yaml (Box.content); do not edit.
# Regenerate with: roverlink generate
"""Box.content to and from rover/msg/BoxLevel3Content."""

from __future__ import annotations

from google.protobuf import any_pb2

from generated.conversions import leaf
from generated.messages import BoxLevel3Content
from generated.pb2 import box_pb2
from runtime.any_of import check_empty, check_none, holds, packed, unpacked


def to_ros(payload: any_pb2.Any) -> BoxLevel3Content:
    """The message that says what the payload says."""
    if holds(payload, box_pb2.Leaf):
        return BoxLevel3Content(
            which=BoxLevel3Content.LEAF,
            leaf=leaf.to_ros(unpacked(payload, box_pb2.Leaf, "BoxLevel3Content.leaf")),
        )
    check_empty(payload, "BoxLevel3Content")
    return BoxLevel3Content()


def from_ros(message: BoxLevel3Content) -> any_pb2.Any:
    """The payload that says what the message says."""
    if message.which == BoxLevel3Content.LEAF:
        return packed(leaf.from_ros(message.leaf))
    check_none(message.which, "BoxLevel3Content")
    return any_pb2.Any()
