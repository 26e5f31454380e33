"""Type hashes of the generated messages (see `roverlink.type_descriptions`)."""

from __future__ import annotations

from collections.abc import Mapping

from roverlink.generator import ir
from roverlink.type_descriptions import (
    SEQUENCE,
    FieldType,
    TypeDescription,
    describe,
    nested_type,
    primitive_type,
    type_hash,
)

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
    return type_hash(
        _description(name, messages, package), [_description(nested, messages, package) for nested in inside]
    )


def _description(name: str, messages: _Messages, package: str) -> TypeDescription:
    return describe(name, ((field.name, _type(field.type, package)) for field in messages[name]))


def _type(type: ir.RosType, package: str) -> FieldType:
    added = SEQUENCE if type.is_sequence else 0
    return nested_type(_full_name(type, package), added) if type.is_message else primitive_type(type.name, added)


def _full_name(type: ir.RosType, package: str) -> str:
    return f"{type.package or package}/msg/{type.name}"
