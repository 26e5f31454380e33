# Generated from mapping.yaml (row message) and awkward.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row message: Message and rover/msg/Message."""

from __future__ import annotations

from generated.conversions import (
    annotated,
    bool_,
    cdr_,
    class_var,
    item_,
    motor_pb2_,
    payload_,
    u_int8,
)
from generated.messages import Message_
from generated.pb2 import awkward_pb2
from roverlink.runtime.core.handler import Handler, Route


class MessageHandler(Handler[awkward_pb2.Message, Message_]):
    """Message as rover/msg/Message.

    Number 7 of the envelope, board_to_ros, topic message.
    """

    route = Route(
        number=7,
        name="message",
        topic="message",
        direction="board_to_ros",
    )
    payload_type = awkward_pb2.Message
    message_type = Message_

    @staticmethod
    def to_ros(payload: awkward_pb2.Message) -> Message_:
        """Convert Message to rover/msg/Message."""
        return Message_(
            item=[item_.to_ros(item) for item in payload.item],
            payload=payload_.to_ros(payload.payload),
            cdr=cdr_.to_ros(payload.cdr),
            bool_field=bool_.to_ros(payload.bool),
            u_int8=u_int8.to_ros(payload.u_int8),
            class_var=class_var.to_ros(payload.class_var),
            annotated=annotated.to_ros(payload.annotated),
            motor=motor_pb2_.to_ros(payload.motor),
        )

    @staticmethod
    def from_ros(message: Message_) -> awkward_pb2.Message:
        """Convert rover/msg/Message to Message."""
        return awkward_pb2.Message(
            item=[item_.from_ros(item) for item in message.item],
            payload=payload_.from_ros(message.payload),
            cdr=cdr_.from_ros(message.cdr),
            bool=bool_.from_ros(message.bool_field),
            u_int8=u_int8.from_ros(message.u_int8),
            class_var=class_var.from_ros(message.class_var),
            annotated=annotated.from_ros(message.annotated),
            motor=motor_pb2_.from_ros(message.motor),
        )
