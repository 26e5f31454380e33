# Generated from mapping.yaml (Packet.content); do not edit.
# Regenerate with: roverlink generate
"""Convert between Packet.content and rover/msg/PacketContent."""

from __future__ import annotations

from google.protobuf import any_pb2

from generated.conversions import gps, gps2
from generated.handlers.imu import ImuHandler
from generated.messages import PacketContent
from generated.pb2.other import parts_pb2 as pb2_other_parts_pb2
from generated.pb2.sensors import parts_pb2 as pb2_sensors_parts_pb2
from roverlink.runtime.convert.any_of import (
    check_empty,
    check_none,
    holds,
    packed,
    unpacked,
)


def to_ros(payload: any_pb2.Any) -> PacketContent:
    """Convert the Any to rover/msg/PacketContent."""
    if holds(payload, pb2_sensors_parts_pb2.IMU):
        return PacketContent(
            which=PacketContent.IMU,
            imu=ImuHandler.to_ros(
                unpacked(payload, pb2_sensors_parts_pb2.IMU, "PacketContent.imu")
            ),
        )
    if holds(payload, pb2_sensors_parts_pb2.Gps):
        return PacketContent(
            which=PacketContent.GPS,
            gps=gps.to_ros(
                unpacked(payload, pb2_sensors_parts_pb2.Gps, "PacketContent.gps")
            ),
        )
    if holds(payload, pb2_other_parts_pb2.Gps2):
        return PacketContent(
            which=PacketContent.GPS2,
            gps2=gps2.to_ros(
                unpacked(payload, pb2_other_parts_pb2.Gps2, "PacketContent.gps2")
            ),
        )
    check_empty(payload, "PacketContent")
    return PacketContent()


def from_ros(message: PacketContent) -> any_pb2.Any:
    """Convert rover/msg/PacketContent to the Any."""
    if message.which == PacketContent.IMU:
        return packed(ImuHandler.from_ros(message.imu))
    if message.which == PacketContent.GPS:
        return packed(gps.from_ros(message.gps))
    if message.which == PacketContent.GPS2:
        return packed(gps2.from_ros(message.gps2))
    check_none(message.which, "PacketContent")
    return any_pb2.Any()
