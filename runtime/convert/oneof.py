"""Oneofs: which member is set, as a number of the ROS 2 message and as a name of the payload.

``members`` maps the name of each member that the ROS message has to its number there; 0 stands for none of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from roverlink.runtime.core.errors import ConversionError

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


def number(payload: ProtoMessage, oneof: str, members: Mapping[str, int]) -> int:
    """The number of the member that is set."""
    name = payload.WhichOneof(oneof)
    return 0 if name is None else members.get(name, 0)


def member(number: int, members: Mapping[str, int], field: str) -> str | None:
    """The name of the member that a number says is set.

    Raises `ConversionError`, with the field that holds the number, where it stands for none.
    """
    for name, known in members.items():
        if known == number:
            return name
    if number:
        others = "".join(f", {known} ({name})" for name, known in members.items())
        raise ConversionError(f"{number} stands for no member; there are 0 (none){others}", field)
    return None
