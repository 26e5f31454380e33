# Generated from mapping.yaml (Class); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Class."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Int32, Message


@dataclass(slots=True)
class Class(Message):
    """Made from Class."""

    __msgtype__: ClassVar[str] = "rover/msg/Class"
    __typehash__: ClassVar[str] = (
        "RIHS01_3c647e7f73d600b1418d35023ce8b04b6ef1220b5f010c1e17016ff57e03a658"
    )

    l: Int32 = 0  # noqa: E741  # as in the .proto
    self: Int32 = 0
    cls: Int32 = 0
    payload: Int32 = 0
    message: Int32 = 0
    item: Int32 = 0
    cdr: Int32 = 0
    type: Int32 = 0
    id: Int32 = 0
    len: Int32 = 0
    object: Int32 = 0
    field: Int32 = 0
    dataclass: Int32 = 0
    print: Int32 = 0
    match: Int32 = 0
