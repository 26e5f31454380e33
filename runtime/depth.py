"""Messages that hold themselves, which in ROS 2 end at some depth."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

from runtime.errors import ConversionError

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


def check_end(payload: ProtoMessage, *paths: str) -> None:
    """Raise `ConversionError` where a payload goes on in fields that no ROS field takes."""
    for path in paths:
        *holders, name = path.split(".")
        holder: ProtoMessage = reduce(getattr, holders, payload)
        if any(field.name == name for field, _ in holder.ListFields()):
            place = f"{payload.DESCRIPTOR.name}.{path}"
            raise ConversionError("the payload is nested more deeply than the ROS 2 message", place)
