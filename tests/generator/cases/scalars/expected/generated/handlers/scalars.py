# Generated from mapping.yaml (row scalars) and scalars.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row scalars: Scalars and rover/msg/Scalars."""

from __future__ import annotations

from generated.messages import Scalars
from generated.pb2 import scalars_pb2
from roverlink.runtime.core.handler import Handler, Route


class ScalarsHandler(Handler[scalars_pb2.Scalars, Scalars]):
    """Scalars as rover/msg/Scalars.

    Number 1 of the envelope, board_to_ros, topic scalars.
    """

    route = Route(
        number=1,
        name="scalars",
        topic="scalars",
        direction="board_to_ros",
    )
    payload_type = scalars_pb2.Scalars
    message_type = Scalars

    @staticmethod
    def to_ros(payload: scalars_pb2.Scalars) -> Scalars:
        """Convert Scalars to rover/msg/Scalars."""
        return Scalars(
            a_double=payload.a_double,
            a_float=payload.a_float,
            an_int32=payload.an_int32,
            an_int64=payload.an_int64,
            a_uint32=payload.a_uint32,
            a_uint64=payload.a_uint64,
            a_sint32=payload.a_sint32,
            a_sint64=payload.a_sint64,
            a_fixed32=payload.a_fixed32,
            a_fixed64=payload.a_fixed64,
            a_sfixed32=payload.a_sfixed32,
            a_sfixed64=payload.a_sfixed64,
            a_bool=payload.a_bool,
            a_string=payload.a_string,
            some_bytes=payload.some_bytes,
        )

    @staticmethod
    def from_ros(message: Scalars) -> scalars_pb2.Scalars:
        """Convert rover/msg/Scalars to Scalars."""
        return scalars_pb2.Scalars(
            a_double=message.a_double,
            a_float=message.a_float,
            an_int32=message.an_int32,
            an_int64=message.an_int64,
            a_uint32=message.a_uint32,
            a_uint64=message.a_uint64,
            a_sint32=message.a_sint32,
            a_sint64=message.a_sint64,
            a_fixed32=message.a_fixed32,
            a_fixed64=message.a_fixed64,
            a_sfixed32=message.a_sfixed32,
            a_sfixed64=message.a_sfixed64,
            a_bool=message.a_bool,
            a_string=message.a_string,
            some_bytes=message.some_bytes,
        )
