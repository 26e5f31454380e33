"""Messages of the ROS 2 package rcl_interfaces: the log of a node, its parameters, and the parameter services."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from roverlink.runtime.core.messages import Bool, Bound, Byte, Float64, Int64, Message, UInt8, UInt32, UInt64
from roverlink.runtime.interfaces import builtin_interfaces


@dataclass(slots=True)
class Log(Message):
    """rcl_interfaces/msg/Log: one line of a node's log. Its levels have the numbers of Python's `logging`."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/Log"
    __typehash__: ClassVar[str] = "RIHS01_e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac"

    stamp: builtin_interfaces.Time = dataclasses.field(default_factory=builtin_interfaces.Time)
    level: UInt8 = 0
    name: str = ""
    msg: str = ""
    file: str = ""
    function: str = ""
    line: UInt32 = 0


# --- parameters ---


@dataclass(slots=True)
class ParameterValue(Message):
    """rcl_interfaces/msg/ParameterValue; ``type`` tells which of the other fields has the value."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/ParameterValue"

    # constants of rcl_interfaces/msg/ParameterType
    NOT_SET: ClassVar[int] = 0
    BOOL: ClassVar[int] = 1
    INTEGER: ClassVar[int] = 2
    DOUBLE: ClassVar[int] = 3
    STRING: ClassVar[int] = 4

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
    """rcl_interfaces/msg/Parameter: name and value."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/Parameter"

    name: str = ""
    value: ParameterValue = dataclasses.field(default_factory=ParameterValue)


@dataclass(slots=True)
class FloatingPointRange(Message):
    """rcl_interfaces/msg/FloatingPointRange: the allowed values of a parameter of type double."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/FloatingPointRange"

    from_value: Float64 = 0.0
    to_value: Float64 = 0.0
    step: Float64 = 0.0


@dataclass(slots=True)
class IntegerRange(Message):
    """rcl_interfaces/msg/IntegerRange: the allowed values of a parameter of type integer."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/IntegerRange"

    from_value: Int64 = 0
    to_value: Int64 = 0
    step: UInt64 = 0


@dataclass(slots=True)
class ParameterDescriptor(Message):
    """rcl_interfaces/msg/ParameterDescriptor: the declaration of a parameter."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/ParameterDescriptor"

    name: str = ""
    type: UInt8 = 0
    description: str = ""
    additional_constraints: str = ""
    read_only: Bool = False
    dynamic_typing: Bool = False
    floating_point_range: Annotated[list[FloatingPointRange], Bound(1)] = dataclasses.field(default_factory=list)
    integer_range: Annotated[list[IntegerRange], Bound(1)] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class SetParametersResult(Message):
    """rcl_interfaces/msg/SetParametersResult: success, or the reason why a change was refused."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/SetParametersResult"

    successful: Bool = False
    reason: str = ""


@dataclass(slots=True)
class ListParametersResult(Message):
    """rcl_interfaces/msg/ListParametersResult: the names of parameters, and the prefixes of these names."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/ListParametersResult"

    names: list[str] = dataclasses.field(default_factory=list)
    prefixes: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class ParameterEvent(Message):
    """rcl_interfaces/msg/ParameterEvent: the parameters of a node that were changed."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/msg/ParameterEvent"
    __typehash__: ClassVar[str] = "RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204"

    stamp: builtin_interfaces.Time = dataclasses.field(default_factory=builtin_interfaces.Time)
    node: str = ""
    new_parameters: list[Parameter] = dataclasses.field(default_factory=list)
    changed_parameters: list[Parameter] = dataclasses.field(default_factory=list)
    deleted_parameters: list[Parameter] = dataclasses.field(default_factory=list)


# --- requests and responses of the parameter services ---


@dataclass(slots=True)
class ListParametersRequest(Message):
    """Request of rcl_interfaces/srv/ListParameters."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/ListParameters_Request"

    prefixes: list[str] = dataclasses.field(default_factory=list)
    depth: UInt64 = 0


@dataclass(slots=True)
class ListParametersResponse(Message):
    """Response of rcl_interfaces/srv/ListParameters."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/ListParameters_Response"

    result: ListParametersResult = dataclasses.field(default_factory=ListParametersResult)


@dataclass(slots=True)
class GetParametersRequest(Message):
    """Request of rcl_interfaces/srv/GetParameters."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/GetParameters_Request"

    names: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class GetParametersResponse(Message):
    """Response of rcl_interfaces/srv/GetParameters."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/GetParameters_Response"

    values: list[ParameterValue] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class GetParameterTypesRequest(Message):
    """Request of rcl_interfaces/srv/GetParameterTypes."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/GetParameterTypes_Request"

    names: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class GetParameterTypesResponse(Message):
    """Response of rcl_interfaces/srv/GetParameterTypes."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/GetParameterTypes_Response"

    types: bytes = b""


@dataclass(slots=True)
class DescribeParametersRequest(Message):
    """Request of rcl_interfaces/srv/DescribeParameters."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/DescribeParameters_Request"

    names: list[str] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class DescribeParametersResponse(Message):
    """Response of rcl_interfaces/srv/DescribeParameters."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/DescribeParameters_Response"

    descriptors: list[ParameterDescriptor] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class SetParametersRequest(Message):
    """Request of rcl_interfaces/srv/SetParameters."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/SetParameters_Request"

    parameters: list[Parameter] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class SetParametersResponse(Message):
    """Response of rcl_interfaces/srv/SetParameters."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/SetParameters_Response"

    results: list[SetParametersResult] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class SetParametersAtomicallyRequest(Message):
    """Request of rcl_interfaces/srv/SetParametersAtomically."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/SetParametersAtomically_Request"

    parameters: list[Parameter] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class SetParametersAtomicallyResponse(Message):
    """Response of rcl_interfaces/srv/SetParametersAtomically."""

    __msgtype__: ClassVar[str] = "rcl_interfaces/srv/SetParametersAtomically_Response"

    result: SetParametersResult = dataclasses.field(default_factory=SetParametersResult)
