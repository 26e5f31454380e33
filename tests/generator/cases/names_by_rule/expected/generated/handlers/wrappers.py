# Generated from mapping.yaml (row wrappers) and wrappers.proto; do not edit.
# Regenerate with: roverlink generate
"""wrappers (2): Wrappers to rover/msg/Wrappers on wrappers."""

from __future__ import annotations

from google.protobuf import wrappers_pb2 as google_wrappers_pb2

from generated.messages import Wrappers
from generated.pb2 import wrappers_pb2
from roverlink.runtime.convert.keywords import keywords
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Wrappers)


class WrappersHandler(Handler[wrappers_pb2.Wrappers, Wrappers]):
    """Wrappers to the topic wrappers."""

    route = Route(number=2, name="wrappers", topic="wrappers", direction="board_to_ros")
    payload_type = wrappers_pb2.Wrappers
    message_type = Wrappers

    @staticmethod
    def to_ros(payload: wrappers_pb2.Wrappers) -> Wrappers:
        """The message that says what the payload says."""
        return Wrappers(
            has_lambda_field=payload.HasField("lambda"),
            lambda_field=getattr(payload, "lambda").value,
            if_not=getattr(getattr(payload, "return"), "if"),
        )

    @staticmethod
    def from_ros(message: Wrappers) -> wrappers_pb2.Wrappers:
        """The payload that says what the message says."""
        return wrappers_pb2.Wrappers(
            **keywords(
                {
                    "lambda": (
                        google_wrappers_pb2.FloatValue(value=message.lambda_field)
                        if message.has_lambda_field
                        else None
                    ),
                    "return": {"if": message.if_not},
                },
            ),
        )

    def pack(self, payload: wrappers_pb2.Wrappers) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return_ = getattr(payload, "return")
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.HasField("lambda"),
            getattr(payload, "lambda").value,
            getattr(return_, "if"),
        )
