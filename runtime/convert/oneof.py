"""Conversion of protobuf oneofs. In ROS 2, an integer field tells which member is set; each member has a constant.

``members`` maps each member's name to its constant in the ROS 2 message; 0 means that no member is set.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from roverlink.runtime.core.errors import ConversionError

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


def number(payload: ProtoMessage, oneof: str, members: Mapping[str, int]) -> int:
    """Return the ROS 2 constant of the oneof's member that is set; 0 if none is set."""
    name = payload.WhichOneof(oneof)
    return 0 if name is None else members.get(name, 0)


def member(number: int, members: Mapping[str, int], field: str) -> str | None:
    """Return the name of the oneof's member for which a ROS 2 constant stands; None for 0.

    Raises `ConversionError` that names ``field`` if the constant is unknown.
    """
    for name, known in members.items():
        if known == number:
            return name
    if number:
        others = "".join(f", {known} ({name})" for name, known in members.items())
        raise ConversionError(f"{number} is not the number of a member (known: 0 (none){others})", field)
    return None
