# Generated from mapping.yaml (row wrappers) and wrappers.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row wrappers: Wrappers and rover/msg/Wrappers."""

from __future__ import annotations

from google.protobuf import wrappers_pb2 as google_wrappers_pb2

from generated.messages import Wrappers
from generated.pb2 import wrappers_pb2
from roverlink.runtime.convert.keywords import keywords
from roverlink.runtime.core.handler import Handler, Route


class WrappersHandler(Handler[wrappers_pb2.Wrappers, Wrappers]):
    """Wrappers as rover/msg/Wrappers.

    Number 2 of the envelope, board_to_ros, topic wrappers.
    """

    route = Route(
        number=2,
        name="wrappers",
        topic="wrappers",
        direction="board_to_ros",
    )
    payload_type = wrappers_pb2.Wrappers
    message_type = Wrappers

    @staticmethod
    def to_ros(payload: wrappers_pb2.Wrappers) -> Wrappers:
        """Convert Wrappers to rover/msg/Wrappers."""
        return Wrappers(
            has_lambda_field=payload.HasField("lambda"),
            lambda_field=getattr(payload, "lambda").value,
            if_not=getattr(getattr(payload, "return"), "if"),
        )

    @staticmethod
    def from_ros(message: Wrappers) -> wrappers_pb2.Wrappers:
        """Convert rover/msg/Wrappers to Wrappers."""
        return wrappers_pb2.Wrappers(
            **keywords(
                {
                    "lambda": (
                        google_wrappers_pb2.FloatValue(value=message.lambda_field)
                        if message.has_lambda_field
                        else None
                    ),
                    "return": {"if": message.if_not},
                }
            )
        )
