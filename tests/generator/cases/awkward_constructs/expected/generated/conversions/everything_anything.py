# Generated from mapping.yaml (Everything.anything); do not edit.
# Regenerate with: roverlink generate
"""Convert between Everything.anything and rover/msg/EverythingAnything."""

from __future__ import annotations

from google.protobuf import any_pb2

from generated.conversions import holds_, packed_, unpacked_
from generated.messages import EverythingAnything
from generated.pb2 import any_pb2 as pb2_any_pb2
from roverlink.runtime.convert.any_of import (
    check_empty,
    check_none,
    holds,
    packed,
    unpacked,
)


def to_ros(payload: any_pb2.Any) -> EverythingAnything:
    """Convert the Any to rover/msg/EverythingAnything."""
    if holds(payload, pb2_any_pb2.Packed):
        return EverythingAnything(
            which=EverythingAnything.PACKED,
            packed=packed_.to_ros(
                unpacked(payload, pb2_any_pb2.Packed, "EverythingAnything.packed")
            ),
        )
    if holds(payload, pb2_any_pb2.Holds):
        return EverythingAnything(
            which=EverythingAnything.HOLDS,
            holds=holds_.to_ros(
                unpacked(payload, pb2_any_pb2.Holds, "EverythingAnything.holds")
            ),
        )
    if holds(payload, pb2_any_pb2.Unpacked):
        return EverythingAnything(
            which=EverythingAnything.UNPACKED,
            unpacked=unpacked_.to_ros(
                unpacked(payload, pb2_any_pb2.Unpacked, "EverythingAnything.unpacked")
            ),
        )
    check_empty(payload, "EverythingAnything")
    return EverythingAnything()


def from_ros(message: EverythingAnything) -> any_pb2.Any:
    """Convert rover/msg/EverythingAnything to the Any."""
    if message.which == EverythingAnything.PACKED:
        return packed(packed_.from_ros(message.packed))
    if message.which == EverythingAnything.HOLDS:
        return packed(holds_.from_ros(message.holds))
    if message.which == EverythingAnything.UNPACKED:
        return packed(unpacked_.from_ros(message.unpacked))
    check_none(message.which, "EverythingAnything")
    return any_pb2.Any()
