"""Well-known types of google.protobuf that are not converted like other messages.

All other types of google.protobuf are converted like a user's messages. So are an Any for which the table lists no
messages, an Empty in a list, map or oneof, and a FieldMask in a list.
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
"""For each proto type: the module in the runtime that converts it, and the ROS message of builtin_interfaces."""

TEXTS = {
    "google.protobuf.Struct": "json_struct",
    "google.protobuf.Value": "json_value",
    "google.protobuf.ListValue": "json_list",
}
"""For each proto type that becomes a JSON text in ROS: the module in the runtime that converts it."""

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
"""Scalar type inside each wrapper message."""

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
"""ROS type of each scalar type of protobuf, except ``bytes``, which becomes ``uint8[]``."""


def time_type(proto: str) -> tuple[str, ir.RosType]:
    """Return the runtime's converting module and the ROS type of a google.protobuf.Timestamp or Duration.

    ``proto`` is the full name. For a Timestamp, the result is ``timestamp`` and ``builtin_interfaces/Time``.
    """
    module, name = TIMES[proto]
    return module, ir.RosType(name, is_message=True, package="builtin_interfaces")
