"""What the types of google.protobuf become that mean more than the fields in them.

The others (Any, Empty and FieldMask in a repeated field, and whatever else is there) are messages like a user's own.
"""

from __future__ import annotations

from roverlink.generator import ir

ANY = "google.protobuf.Any"
EMPTY = "google.protobuf.Empty"
FIELD_MASK = "google.protobuf.FieldMask"

TIMES = {
    "google.protobuf.Timestamp": ("timestamp", "Time"),
    "google.protobuf.Duration": ("duration", "Duration"),
}
"""The runtime's module, and the message of builtin_interfaces."""

TEXTS = {
    "google.protobuf.Struct": "json_struct",
    "google.protobuf.Value": "json_value",
    "google.protobuf.ListValue": "json_list",
}
"""The runtime's module."""

WRAPPERS = {
    "google.protobuf.DoubleValue": "double",
    "google.protobuf.FloatValue": "float",
    "google.protobuf.Int64Value": "int64",
    "google.protobuf.UInt64Value": "uint64",
    "google.protobuf.Int32Value": "int32",
    "google.protobuf.UInt32Value": "uint32",
    "google.protobuf.BoolValue": "bool",
    "google.protobuf.StringValue": "string",
    "google.protobuf.BytesValue": "bytes",
}
"""The scalar in each."""

SCALARS = {
    "double": "float64",
    "float": "float32",
    "int32": "int32",
    "sint32": "int32",
    "sfixed32": "int32",
    "int64": "int64",
    "sint64": "int64",
    "sfixed64": "int64",
    "uint32": "uint32",
    "fixed32": "uint32",
    "uint64": "uint64",
    "fixed64": "uint64",
    "bool": "bool",
    "string": "string",
}
"""The ROS type of each scalar but bytes."""


def time_type(proto: str) -> tuple[str, ir.RosType]:
    """The runtime's module and the ROS type of a time."""
    module, name = TIMES[proto]
    return module, ir.RosType(name, is_message=True, package="builtin_interfaces")
