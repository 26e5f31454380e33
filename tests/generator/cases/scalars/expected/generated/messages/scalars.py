# Generated from mapping.yaml (Scalars); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Scalars."""

from __future__ import annotations

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
class Scalars(Message):
    """Made from Scalars."""

    __msgtype__: ClassVar[str] = "rover/msg/Scalars"
    __typehash__: ClassVar[str] = (
        "RIHS01_f50a9bab882d74f475deeb920a26194bbbd083d09db340a34762575dd38ec65a"
    )

    a_double: Float64 = 0.0
    a_float: Float32 = 0.0
    an_int32: Int32 = 0
    an_int64: Int64 = 0
    a_uint32: UInt32 = 0
    a_uint64: UInt64 = 0
    a_sint32: Int32 = 0
    a_sint64: Int64 = 0
    a_fixed32: UInt32 = 0
    a_fixed64: UInt64 = 0
    a_sfixed32: Int32 = 0
    a_sfixed64: Int64 = 0
    a_bool: Bool = False
    a_string: str = ""
    some_bytes: bytes = b""
