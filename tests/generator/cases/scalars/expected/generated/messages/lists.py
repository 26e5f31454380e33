# Generated from mapping.yaml (Lists); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Lists."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import (
    Bool,
    Float32,
    Float64,
    Int32,
    Int64,
    Message,
    UInt32,
    UInt64,
)


@dataclass(slots=True)
class Lists(Message):
    """Made from Lists."""

    __msgtype__: ClassVar[str] = "rover/msg/Lists"
    __typehash__: ClassVar[str] = (
        "RIHS01_0988ffcd65003d6f7fdec28fa5ef2ce494565c1ce726a8ffd56311bb77c86d95"
    )

    doubles: list[Float64] = dataclasses.field(default_factory=list)
    floats: list[Float32] = dataclasses.field(default_factory=list)
    int32s: list[Int32] = dataclasses.field(default_factory=list)
    int64s: list[Int64] = dataclasses.field(default_factory=list)
    uint32s: list[UInt32] = dataclasses.field(default_factory=list)
    uint64s: list[UInt64] = dataclasses.field(default_factory=list)
    sint32s: list[Int32] = dataclasses.field(default_factory=list)
    sint64s: list[Int64] = dataclasses.field(default_factory=list)
    fixed32s: list[UInt32] = dataclasses.field(default_factory=list)
    fixed64s: list[UInt64] = dataclasses.field(default_factory=list)
    sfixed32s: list[Int32] = dataclasses.field(default_factory=list)
    sfixed64s: list[Int64] = dataclasses.field(default_factory=list)
    bools: list[Bool] = dataclasses.field(default_factory=list)
    strings: list[str] = dataclasses.field(default_factory=list)
    unpacked: list[Float32] = dataclasses.field(default_factory=list)
