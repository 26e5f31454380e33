"""Conversion of a google.protobuf.Any that holds one of the message types listed in the table.

``place`` is the dotted path of the Any field. Error messages contain it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from google.protobuf.any_pb2 import Any
from google.protobuf.message import DecodeError

from roverlink.numerals import counted
from roverlink.runtime.core.errors import ConversionError

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

P = TypeVar("P", bound="ProtoMessage")


def holds(payload: Any, type: type[ProtoMessage]) -> bool:
    """Return true if the type URL of an Any names the message type ``type``.

    As in protobuf, only the part of the URL after the last slash is compared.
    """
    # any.proto: "The last segment of the URL's path must represent the fully qualified name of the type". The part
    # before it is the place of a type server, and senders choose it freely.
    _, slash, name = payload.type_url.rpartition("/")
    return bool(slash) and name == type.DESCRIPTOR.full_name


def unpacked(payload: Any, type: type[P], place: str) -> P:
    """Parse the message in an Any. Raises `ConversionError` if its bytes are not a message of type ``type``."""
    try:
        return type.FromString(payload.value)
    except DecodeError as error:
        raise ConversionError(
            f"not a valid {type.DESCRIPTOR.full_name}: {counted(len(payload.value), 'byte')}", place
        ) from error


def packed(message: ProtoMessage) -> Any:
    """Pack a message into an Any. Serialization is deterministic: equal messages give equal bytes."""
    payload = Any()
    # Without it, map entries come in random order, and recordings of equal messages would differ.
    payload.Pack(message, deterministic=True)
    return payload


def check_empty(payload: Any, place: str) -> None:
    """Raise `ConversionError` if an Any is not empty.

    Generated code calls this if the Any holds none of the message types that the table lists for the field, so that the
    ROS 2 message has no field for its content.
    """
    if payload.type_url or payload.value:
        raise ConversionError(f"it holds {payload.type_url!r}, for which the ROS 2 message has no field", place)


def check_none(which: int, place: str) -> None:
    """Raise `ConversionError` if ``which`` is not 0, the number for an empty Any.

    In ROS 2, the field ``which`` tells which of the message types that the table lists the Any holds. Generated code
    calls this if ``which`` is not the number of any of these types.
    """
    if which:
        raise ConversionError(f"{which} is not the number of a message that this field may hold", f"{place}.which")
