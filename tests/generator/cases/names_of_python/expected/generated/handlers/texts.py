# Generated from mapping.yaml (row texts) and texts.proto; do not edit.
# Regenerate with: roverlink generate
"""texts (1): Texts to rover/msg/Texts on texts."""

from __future__ import annotations

from generated.messages import Texts
from generated.pb2 import texts_pb2
from roverlink.runtime.core.handler import Handler, Route


class TextsHandler(Handler[texts_pb2.Texts, Texts]):
    """Texts to the topic texts."""

    route = Route(number=1, name="texts", topic="texts", direction="board_to_ros")
    payload_type = texts_pb2.Texts
    message_type = Texts

    @staticmethod
    def to_ros(payload: texts_pb2.Texts) -> Texts:
        """The message that says what the payload says."""
        return Texts(
            bytes_field=payload.bytes,
            str_field=payload.str,
            list_field=list(payload.list),
            dataclasses_field=payload.dataclasses,
        )

    @staticmethod
    def from_ros(message: Texts) -> texts_pb2.Texts:
        """The payload that says what the message says."""
        return texts_pb2.Texts(
            bytes=message.bytes_field,
            str=message.str_field,
            list=message.list_field,
            dataclasses=message.dataclasses_field,
        )
