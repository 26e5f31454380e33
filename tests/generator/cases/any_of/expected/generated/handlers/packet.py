# Generated from mapping.yaml (row packet) and packet.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row packet: Packet and rover/msg/Packet."""

from __future__ import annotations

from generated.conversions import (
    any_,
    inner,
    packet_content,
    packet_history,
    packet_named,
)
from generated.messages import Packet, PacketNamedEntry
from generated.pb2 import packet_pb2
from roverlink.runtime.convert.maps import mapping
from roverlink.runtime.core.handler import Handler, Route


class PacketHandler(Handler[packet_pb2.Packet, Packet]):
    """Packet as rover/msg/Packet.

    Number 1 of the envelope, board_to_ros, topic packet.
    """

    route = Route(
        number=1,
        name="packet",
        topic="packet",
        direction="board_to_ros",
    )
    payload_type = packet_pb2.Packet
    message_type = Packet

    @staticmethod
    def to_ros(payload: packet_pb2.Packet) -> Packet:
        """Convert Packet to rover/msg/Packet."""
        return Packet(
            has_content=payload.HasField("content"),
            content=packet_content.to_ros(payload.content),
            history=[packet_history.to_ros(item) for item in payload.history],
            named=[
                PacketNamedEntry(key=key, value=packet_named.to_ros(value))
                for key, value in sorted(payload.named.items())
            ],
            raw=any_.to_ros(payload.raw),
            inner=inner.to_ros(payload.inner),
        )

    @staticmethod
    def from_ros(message: Packet) -> packet_pb2.Packet:
        """Convert rover/msg/Packet to Packet."""
        return packet_pb2.Packet(
            content=(
                packet_content.from_ros(message.content)
                if message.has_content
                else None
            ),
            history=[packet_history.from_ros(item) for item in message.history],
            named=mapping(
                (
                    (item.key, packet_named.from_ros(item.value))
                    for item in message.named
                ),
                "named",
            ),
            raw=any_.from_ros(message.raw),
            inner=inner.from_ros(message.inner),
        )
