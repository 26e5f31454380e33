# Generated from mapping.yaml (Everything); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Everything."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.depth import Depth
from generated.messages.duration import Duration_
from generated.messages.everything_anything import EverythingAnything
from generated.messages.everything_key_entry import EverythingKeyEntry
from generated.messages.everything_mapping_entry import EverythingMappingEntry
from generated.messages.everything_value_entry import EverythingValueEntry
from generated.messages.json_struct import JsonStruct
from generated.messages.keywords import Keywords
from generated.messages.oneof import Oneof
from generated.messages.time import Time_
from roverlink.runtime.core.messages import Int32, Message, UInt8
from roverlink.runtime.interfaces import Duration, Time


@dataclass(slots=True)
class Everything(Message):
    """Made from Everything."""

    __msgtype__: ClassVar[str] = "rover/msg/Everything"
    __typehash__: ClassVar[str] = (
        "RIHS01_8f2e1112bf3f4c7e1fda1da754b14669bcfa962e6cc51fe918c1e0afe7ca46f7"
    )

    KIND_NONE: ClassVar[int] = 0
    KIND_DEPTH: ClassVar[int] = 9
    KIND_JSON_STRUCT: ClassVar[int] = 10
    KIND_STRUCT: ClassVar[int] = 11

    key: list[EverythingKeyEntry] = dataclasses.field(default_factory=list)
    value: list[EverythingValueEntry] = dataclasses.field(default_factory=list)
    mapping: list[EverythingMappingEntry] = dataclasses.field(default_factory=list)
    when: Int32 = 0
    time: Time_ = dataclasses.field(default_factory=Time_)
    stamp: Time = dataclasses.field(default_factory=Time)
    duration: Duration = dataclasses.field(default_factory=Duration)
    oneof: Oneof = dataclasses.field(default_factory=Oneof)
    which_kind: UInt8 = 0
    """Which member of kind is set."""

    depth: Depth = dataclasses.field(default_factory=Depth)
    json_struct: JsonStruct = dataclasses.field(default_factory=JsonStruct)
    struct_field: str = ""
    anything: EverythingAnything = dataclasses.field(default_factory=EverythingAnything)
    keywords: Keywords = dataclasses.field(default_factory=Keywords)
    other: Duration_ = dataclasses.field(default_factory=Duration_)
    class_field: Int32 = 0
