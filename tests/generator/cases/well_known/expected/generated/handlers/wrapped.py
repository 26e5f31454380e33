# Generated from mapping.yaml (row wrapped) and moment.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row wrapped: Wrapped and rover/msg/Wrapped."""

from __future__ import annotations

from google.protobuf import wrappers_pb2

from generated.messages import Wrapped
from generated.pb2 import moment_pb2
from roverlink.runtime.core.handler import Handler, Route


class WrappedHandler(Handler[moment_pb2.Wrapped, Wrapped]):
    """Wrapped as rover/msg/Wrapped.

    Number 4 of the envelope, board_to_ros, topic wrapped.
    """

    route = Route(
        number=4,
        name="wrapped",
        topic="wrapped",
        direction="board_to_ros",
    )
    payload_type = moment_pb2.Wrapped
    message_type = Wrapped

    @staticmethod
    def to_ros(payload: moment_pb2.Wrapped) -> Wrapped:
        """Convert Wrapped to rover/msg/Wrapped."""
        return Wrapped(
            has_d=payload.HasField("d"),
            d=payload.d.value,
            f=payload.f.value,
            has_i64=payload.HasField("i64"),
            i64=payload.i64.value,
            has_u64=payload.HasField("u64"),
            u64=payload.u64.value,
            has_i32=payload.HasField("i32"),
            i32=payload.i32.value,
            has_u32=payload.HasField("u32"),
            u32=payload.u32.value,
            has_b=payload.HasField("b"),
            b=payload.b.value,
            has_s=payload.HasField("s"),
            s=payload.s.value,
            y=payload.y.value,
        )

    @staticmethod
    def from_ros(message: Wrapped) -> moment_pb2.Wrapped:
        """Convert rover/msg/Wrapped to Wrapped."""
        return moment_pb2.Wrapped(
            d=wrappers_pb2.DoubleValue(value=message.d) if message.has_d else None,
            f=wrappers_pb2.FloatValue(value=message.f),
            i64=wrappers_pb2.Int64Value(value=message.i64) if message.has_i64 else None,
            u64=(
                wrappers_pb2.UInt64Value(value=message.u64) if message.has_u64 else None
            ),
            i32=wrappers_pb2.Int32Value(value=message.i32) if message.has_i32 else None,
            u32=(
                wrappers_pb2.UInt32Value(value=message.u32) if message.has_u32 else None
            ),
            b=wrappers_pb2.BoolValue(value=message.b) if message.has_b else None,
            s=wrappers_pb2.StringValue(value=message.s) if message.has_s else None,
            y=wrappers_pb2.BytesValue(value=message.y),
        )
