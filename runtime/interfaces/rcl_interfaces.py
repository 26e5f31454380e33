# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package rcl_interfaces."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from roverlink.runtime.core.messages import (
    Bool,
    Bound,
    Byte,
    Float64,
    Int64,
    Message,
    UInt8,
    UInt32,
    UInt64,
)
from roverlink.runtime.interfaces import Time


@dataclass(slots=True)
class FloatingPointRange(Message):
    """rcl_interfaces/msg/FloatingPointRange."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/FloatingPointRange"
    __typehash__: ClassVar[str] = "RIHS01_e6af23a23c177fee5f3075c8b1e435162a9b63c863d78c06017460b49684262d"

    from_value: Float64 = 0.0
    to_value: Float64 = 0.0
    step: Float64 = 0.0


@dataclass(slots=True)
class IntegerRange(Message):
    """rcl_interfaces/msg/IntegerRange."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/IntegerRange"
    __typehash__: ClassVar[str] = "RIHS01_f7b7fdc0f65f07702e099218e13288c3963bcb9345bde78b560e6cd19800fc5a"

    from_value: Int64 = 0
    to_value: Int64 = 0
    step: UInt64 = 0


@dataclass(slots=True)
class ListParametersResult(Message):
    """rcl_interfaces/msg/ListParametersResult."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/ListParametersResult"
    __typehash__: ClassVar[str] = "RIHS01_237ae3428413dcbcfb452b510c42355f3a2b021dc091afa3e18526d57022f1cd"

    names: list[str] = dataclasses.field(default_factory=list)
    prefixes: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class Log(Message):
    """rcl_interfaces/msg/Log."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/Log"
    __typehash__: ClassVar[str] = "RIHS01_e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac"

    DEBUG: ClassVar[int] = 10
    INFO: ClassVar[int] = 20
    WARN: ClassVar[int] = 30
    ERROR: ClassVar[int] = 40
    FATAL: ClassVar[int] = 50

    stamp: Time = dataclasses.field(default_factory=Time)
    level: UInt8 = 0
    name: str = ""
    msg: str = ""
    file: str = ""
    function: str = ""
    line: UInt32 = 0


@dataclass(slots=True)
class ParameterValue(Message):
    """rcl_interfaces/msg/ParameterValue."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/ParameterValue"
    __typehash__: ClassVar[str] = "RIHS01_115fc089a387e23c7ecd3525c9189c379109119d6ab82e8dfbde0fdf6a7f9b68"

    NOT_SET: ClassVar[int] = 0
    BOOL: ClassVar[int] = 1
    INTEGER: ClassVar[int] = 2
    DOUBLE: ClassVar[int] = 3
    STRING: ClassVar[int] = 4
    BYTE_ARRAY: ClassVar[int] = 5
    BOOL_ARRAY: ClassVar[int] = 6
    INTEGER_ARRAY: ClassVar[int] = 7
    DOUBLE_ARRAY: ClassVar[int] = 8
    STRING_ARRAY: ClassVar[int] = 9

    type: UInt8 = 0
    bool_value: Bool = False
    integer_value: Int64 = 0
    double_value: Float64 = 0.0
    string_value: str = ""
    byte_array_value: list[Byte] = dataclasses.field(default_factory=list)
    bool_array_value: list[Bool] = dataclasses.field(default_factory=list)
    integer_array_value: list[Int64] = dataclasses.field(default_factory=list)
    double_array_value: list[Float64] = dataclasses.field(default_factory=list)
    string_array_value: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class Parameter(Message):
    """rcl_interfaces/msg/Parameter."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/Parameter"
    __typehash__: ClassVar[str] = "RIHS01_ddfe6442cffc462317adb5c92536a7b6dd55858c5c3e1e328165a6b73c2831af"

    name: str = ""
    value: ParameterValue = dataclasses.field(default_factory=ParameterValue)


@dataclass(slots=True)
class ParameterDescriptor(Message):
    """rcl_interfaces/msg/ParameterDescriptor."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/ParameterDescriptor"
    __typehash__: ClassVar[str] = "RIHS01_52175dbfda6c51153101d33d2a9da05743f66f02d5ab2ca9ec4709b46b73d704"

    name: str = ""
    type: UInt8 = 0
    description: str = ""
    additional_constraints: str = ""
    read_only: Bool = False
    dynamic_typing: Bool = False
    floating_point_range: Annotated[list[FloatingPointRange], Bound(1)] = dataclasses.field(default_factory=list)
    integer_range: Annotated[list[IntegerRange], Bound(1)] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class ParameterEvent(Message):
    """rcl_interfaces/msg/ParameterEvent."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/ParameterEvent"
    __typehash__: ClassVar[str] = "RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204"

    stamp: Time = dataclasses.field(default_factory=Time)
    node: str = ""
    new_parameters: list[Parameter] = dataclasses.field(default_factory=list)
    changed_parameters: list[Parameter] = dataclasses.field(default_factory=list)
    deleted_parameters: list[Parameter] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class SetParametersResult(Message):
    """rcl_interfaces/msg/SetParametersResult."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/SetParametersResult"
    __typehash__: ClassVar[str] = "RIHS01_cfcc0fb0371ee5159b403960ef4300f8f9d2f1fd6117c8666b7f9654d528a9b1"

    successful: Bool = False
    reason: str = ""


@dataclass(slots=True)
class DescribeParametersRequest(Message):
    """rcl_interfaces/srv/DescribeParameters_Request."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/DescribeParameters_Request"

    names: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class DescribeParametersResponse(Message):
    """rcl_interfaces/srv/DescribeParameters_Response."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/DescribeParameters_Response"

    descriptors: list[ParameterDescriptor] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class GetParameterTypesRequest(Message):
    """rcl_interfaces/srv/GetParameterTypes_Request."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/GetParameterTypes_Request"

    names: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class GetParameterTypesResponse(Message):
    """rcl_interfaces/srv/GetParameterTypes_Response."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/GetParameterTypes_Response"

    types: bytes = b""


@dataclass(slots=True)
class GetParametersRequest(Message):
    """rcl_interfaces/srv/GetParameters_Request."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/GetParameters_Request"

    names: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class GetParametersResponse(Message):
    """rcl_interfaces/srv/GetParameters_Response."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/GetParameters_Response"

    values: list[ParameterValue] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class ListParametersRequest(Message):
    """rcl_interfaces/srv/ListParameters_Request."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/ListParameters_Request"

    prefixes: list[str] = dataclasses.field(default_factory=list)
    depth: UInt64 = 0


@dataclass(slots=True)
class ListParametersResponse(Message):
    """rcl_interfaces/srv/ListParameters_Response."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/ListParameters_Response"

    result: ListParametersResult = dataclasses.field(default_factory=ListParametersResult)


@dataclass(slots=True)
class SetParametersAtomicallyRequest(Message):
    """rcl_interfaces/srv/SetParametersAtomically_Request."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/SetParametersAtomically_Request"

    parameters: list[Parameter] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class SetParametersAtomicallyResponse(Message):
    """rcl_interfaces/srv/SetParametersAtomically_Response."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/SetParametersAtomically_Response"

    result: SetParametersResult = dataclasses.field(default_factory=SetParametersResult)


@dataclass(slots=True)
class SetParametersRequest(Message):
    """rcl_interfaces/srv/SetParameters_Request."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/SetParameters_Request"

    parameters: list[Parameter] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class SetParametersResponse(Message):
    """rcl_interfaces/srv/SetParameters_Response."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/SetParameters_Response"

    results: list[SetParametersResult] = dataclasses.field(default_factory=list)
