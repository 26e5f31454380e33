# Generated from mapping.yaml (Message); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Message."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.annotated import Annotated
from generated.messages.bool import Bool_
from generated.messages.cdr import Cdr
from generated.messages.class_var import ClassVar_
from generated.messages.item import Item
from generated.messages.motor_pb2 import MotorPb2
from generated.messages.payload import Payload
from generated.messages.u_int8 import UInt8_
from roverlink.runtime.core.messages import Message


@dataclass(slots=True)
class Message_(Message):  # noqa: N801  # the code here needs the name itself
    """Made from Message."""

    __msgtype__: ClassVar[str] = "rover/msg/Message"
    __typehash__: ClassVar[str] = (
        "RIHS01_3f8785614e420f163ae909210ca5e725f8a962d28d7467062d9f3a0c0609ff85"
    )

    item: list[Item] = dataclasses.field(default_factory=list)
    payload: Payload = dataclasses.field(default_factory=Payload)
    cdr: Cdr = dataclasses.field(default_factory=Cdr)
    bool_field: Bool_ = dataclasses.field(default_factory=Bool_)
    u_int8: UInt8_ = dataclasses.field(default_factory=UInt8_)
    class_var: ClassVar_ = dataclasses.field(default_factory=ClassVar_)
    annotated: Annotated = dataclasses.field(default_factory=Annotated)
    motor: MotorPb2 = dataclasses.field(default_factory=MotorPb2)
