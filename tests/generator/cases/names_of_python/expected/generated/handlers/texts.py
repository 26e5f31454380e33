# Generated from mapping.yaml (row texts) and texts.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row texts: Texts and rover/msg/Texts."""

from __future__ import annotations

from generated.messages import Texts
from generated.pb2 import texts_pb2
from roverlink.runtime.core.handler import Handler, Route


class TextsHandler(Handler[texts_pb2.Texts, Texts]):
    """Texts as rover/msg/Texts.

    Number 1 of the envelope, board_to_ros, topic texts.
    """

    route = Route(
        number=1,
        name="texts",
        topic="texts",
        direction="board_to_ros",
    )
    payload_type = texts_pb2.Texts
    message_type = Texts

    @staticmethod
    def to_ros(payload: texts_pb2.Texts) -> Texts:
        """Convert Texts to rover/msg/Texts."""
        return Texts(
            bytes_field=payload.bytes,
            str_field=payload.str,
            list_field=list(payload.list),
            dataclasses_field=payload.dataclasses,
        )

    @staticmethod
    def from_ros(message: Texts) -> texts_pb2.Texts:
        """Convert rover/msg/Texts to Texts."""
        return texts_pb2.Texts(
            bytes=message.bytes_field,
            str=message.str_field,
            list=message.list_field,
            dataclasses=message.dataclasses_field,
        )
