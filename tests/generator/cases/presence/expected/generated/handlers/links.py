# Generated from mapping.yaml (row links) and fix.proto; do not edit.
# Regenerate with: roverlink generate
"""links (2): Link from rover/msg/Link on links."""

from __future__ import annotations

from generated.conversions import link_level2
from generated.messages import Link
from generated.pb2 import fix_pb2
from runtime.handler import Handler, Route


class LinksHandler(Handler[fix_pb2.Link, Link]):
    """Link from the topic links."""

    route = Route(number=2, name="links", topic="links", direction="ros_to_board")
    payload_type = fix_pb2.Link
    message_type = Link

    @staticmethod
    def to_ros(payload: fix_pb2.Link) -> Link:
        """The message that says what the payload says."""
        return Link(x=payload.x, next=link_level2.to_ros(payload.next))

    @staticmethod
    def from_ros(message: Link) -> fix_pb2.Link:
        """The payload that says what the message says."""
        return fix_pb2.Link(x=message.x, next=link_level2.from_ros(message.next))
