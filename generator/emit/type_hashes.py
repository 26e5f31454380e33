"""Type hashes of ROS 2 (REP 2016): from Iron on, nodes compare them to know if they have the same message definition.

A hash is SHA-256 over a JSON text that describes the type and all nested types: names and types of the fields in order,
without comments, constants and defaults. rosidl computes the hash when it builds the interface package. roverlink also
computes it, because a bridge can run without such a build.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from roverlink.generator import ir

_PREFIX = "RIHS01_"  # ROS interface hashing standard, version 1
_NESTED = 1
_TYPES = {
    "int8": 2,
    "uint8": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "bool": 15,
    "string": 17,
}
"""Number of each primitive type in type_description_interfaces/msg/FieldType."""
_UNBOUNDED_SEQUENCE = 144
"""Amount that is added to a type's number for an unbounded sequence of this type."""
_EMPTY = ir.RosField("structure_needs_at_least_one_member", ir.RosType("uint8"), "")
"""Field that rosidl adds to a message without fields, because C has no empty structs."""


_SECONDS = (ir.RosField("sec", ir.RosType("int32"), ""), ir.RosField("nanosec", ir.RosType("uint32"), ""))
_MESSAGES_OF_OTHER_PACKAGES = {"builtin_interfaces/msg/Duration": _SECONDS, "builtin_interfaces/msg/Time": _SECONDS}
"""Fields of the messages from other packages that a generated message can contain."""


def type_hashes(bridge: ir.Bridge) -> dict[str, str]:
    """Return the type hash of each message in the generated ROS 2 package, ``RIHS01_...``, by the message's name."""
    own = {f"{bridge.package}/msg/{message.name}": message.fields for message in bridge.messages}
    messages = {**_MESSAGES_OF_OTHER_PACKAGES, **own}
    return {
        message.name: _hash(f"{bridge.package}/msg/{message.name}", messages, bridge.package)
        for message in bridge.messages
    }


_Messages = Mapping[str, tuple[ir.RosField, ...]]


def _hash(name: str, messages: _Messages, package: str) -> str:
    inside: set[str] = set()
    waiting = [name]
    while waiting:
        fields = messages[waiting.pop()]
        found = {_full_name(field.type, package) for field in fields if field.type.is_message} - inside
        inside |= found
        waiting += found
    text = json.dumps(
        {
            "type_description": _description(name, messages, package),
            "referenced_type_descriptions": [_description(nested, messages, package) for nested in sorted(inside)],
        }
    )
    return f"{_PREFIX}{hashlib.sha256(text.encode()).hexdigest()}"


def _description(name: str, messages: _Messages, package: str) -> dict[str, Any]:
    """Return the description of a message, without the descriptions of nested messages.

    REP 2016 prescribes the order of the keys.
    """
    fields = messages[name] or (_EMPTY,)
    return {"type_name": name, "fields": [{"name": field.name, "type": _type(field.type, package)} for field in fields]}


def _type(type: ir.RosType, package: str) -> dict[str, Any]:
    number = _NESTED if type.is_message else _TYPES[type.name]
    return {
        "type_id": number + (_UNBOUNDED_SEQUENCE if type.is_sequence else 0),
        "capacity": 0,
        "string_capacity": 0,
        "nested_type_name": _full_name(type, package) if type.is_message else "",
    }


def _full_name(type: ir.RosType, package: str) -> str:
    return f"{type.package or package}/msg/{type.name}"
