# Generated from mapping.yaml (odd_names); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/OddNames."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.in_side import InSide
from generated.messages.odd_names_try_entry import OddNamesTryEntry
from roverlink.runtime.core.messages import Bool, Float64, Int32, Message, UInt8


@dataclass(slots=True)
class OddNames(Message):
    """Made from odd_names."""

    __msgtype__: ClassVar[str] = "rover/msg/OddNames"
    __typehash__: ClassVar[str] = (
        "RIHS01_84a13c90a3c58a4e1c3b717b93109abde790900f17a10539b059a547d2aa6503"
    )

    WITH_NONE: ClassVar[int] = 0
    WITH_GLOBAL: ClassVar[int] = 16
    WITH_PASS: ClassVar[int] = 17
    K_MODE_OFF: ClassVar[int] = 0
    MODE_ON: ClassVar[int] = 1
    MODE_HIGH: ClassVar[int] = 2

    class_field: Int32 = 0
    from_field: Float64 = 0.0
    camel_case: Int32 = 0
    http_server: Int32 = 0
    two_underscores: Int32 = 0
    trailing: Int32 = 0
    leading: Int32 = 0
    list_field: list[Int32] = dataclasses.field(default_factory=list)
    operator_field: Int32 = 0
    field_1st: Int32 = 0
    capitals: Int32 = 0
    has_is_field: Bool = False
    """Whether is_field is set."""

    is_field: Int32 = 0
    import_field: list[InSide] = dataclasses.field(default_factory=list)
    which_with: UInt8 = 0
    """Which member of with is set."""

    global_field: Int32 = 0
    pass_field: str = ""
    try_field: list[OddNamesTryEntry] = dataclasses.field(default_factory=list)
    mode: UInt8 = 0
