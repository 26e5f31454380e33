"""A google.protobuf.Any that holds one of the messages that the table lists."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from google.protobuf.any_pb2 import Any
from google.protobuf.message import DecodeError

from roverlink.runtime.core.errors import ConversionError

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

P = TypeVar("P", bound="ProtoMessage")


def holds(payload: Any, type: type[ProtoMessage]) -> bool:
    """Whether an Any says that it holds a message of the type."""
    _, slash, name = payload.type_url.rpartition("/")
    return bool(slash) and name == type.DESCRIPTOR.full_name


def unpacked(payload: Any, type: type[P], place: str) -> P:
    """The message that an Any holds, which is of the type.

    Raises `ConversionError`, which starts with ``place``, where its bytes are none.
    """
    try:
        return type.FromString(payload.value)
    except DecodeError as error:
        raise ConversionError(f"its {len(payload.value)} bytes are no {type.DESCRIPTOR.full_name}", place) from error


def packed(message: ProtoMessage) -> Any:
    """An Any that holds a message; the same message gives the same bytes."""
    payload = Any()
    payload.Pack(message, deterministic=True)
    return payload


def check_empty(payload: Any, place: str) -> None:
    """Raise `ConversionError` where an Any holds something: none of what a ROS 2 message has a field for."""
    if payload.type_url or payload.value:
        raise ConversionError(f"it holds {payload.type_url!r}, for which the ROS 2 message has no field", place)


def check_none(which: int, place: str) -> None:
    """Raise `ConversionError` where a number says that something is held: none of what the table lists."""
    if which:
        raise ConversionError(f"{which} stands for none of the messages that it may hold", f"{place}.which")
