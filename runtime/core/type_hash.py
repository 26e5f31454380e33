"""Type hashes of ROS 2 (REP 2016) of messages and services, from their classes.

A hash is SHA-256 over a JSON text: names and types of the fields in order, and the same of all nested types. The hashes
of the table's messages come from the generator; this module has those of other messages and of services.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field, make_dataclass
from typing import Annotated, Any, ClassVar

from roverlink.runtime.core.messages import (
    UINT8,
    Array,
    Bound,
    Field,
    FieldType,
    Int64,
    Length,
    Message,
    Primitive,
    Sequence,
    Text,
    UInt8,
    cached_by_type,
    fields_of,
    messages_in,
)
from roverlink.runtime.interfaces import Time

# Numbers of type_description_interfaces/msg/FieldType. rosidl takes a `char` of a .msg file for a uint8.
_NUMBERS = {"int8": 2, "uint8": 3, "char": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8}
_NUMBERS |= {"uint64": 9, "float32": 10, "float64": 11, "bool": 15, "byte": 16}
_NESTED, _STRING, _BOUNDED_STRING = 1, 17, 21
_ARRAY, _BOUNDED_SEQUENCE, _SEQUENCE = 48, 96, 144  # what is added to the number of the element's type
_EMPTY = (Field("structure_needs_at_least_one_member", UINT8),)  # rosidl adds it, because C has no empty structs


@dataclass
class _ServiceEventInfo(Message):
    """First part of the event of each service (service_msgs/msg/ServiceEventInfo)."""

    __msgtype__: ClassVar[str] = "service_msgs/msg/ServiceEventInfo"

    event_type: UInt8 = 0
    stamp: Time = field(default_factory=Time)
    client_gid: Annotated[bytes, Length(16)] = bytes(16)
    sequence_number: Int64 = 0


@cached_by_type
def type_hash(message_type: type[Message]) -> str:
    """Return the type hash of a message: ``RIHS01_`` and 64 hexadecimal digits."""
    if message_type.__typehash__:
        return message_type.__typehash__
    inside = sorted(messages_in(message_type), key=lambda one: one.__msgtype__)
    text = json.dumps(
        {
            "type_description": _description(message_type),
            "referenced_type_descriptions": [_description(nested) for nested in inside],
        }
    )
    return f"RIHS01_{hashlib.sha256(text.encode()).hexdigest()}"


@cached_by_type
def service_hash(request: type[Message], response: type[Message]) -> str:
    """Return the type hash of a service, from its request and its response.

    REP 2016 takes a service for a message with three fields. The third one is the event of service introspection.
    """
    name = request.__msgtype__.removesuffix("_Request")

    def made(part: str, fields: dict[str, Any]) -> Any:
        return make_dataclass("Part", fields.items(), bases=(Message,), namespace={"__msgtype__": f"{name}{part}"})

    one = {"request": request, "response": response}
    lists = {key: Annotated[list.__class_getitem__(kind), Bound(1)] for key, kind in one.items()}
    event = made("_Event", {"info": _ServiceEventInfo, **lists})
    return type_hash(made("", {**{f"{key}_message": kind for key, kind in one.items()}, "event_message": event}))


def _description(message_type: type[Message]) -> dict[str, Any]:
    """Return the description of a message without those of nested messages. The order of the keys is prescribed."""
    fields = fields_of(message_type) or _EMPTY
    described = [{"name": one.name, "type": _type(one.type)} for one in fields]
    return {"type_name": message_type.__msgtype__, "fields": described}


def _type(kind: FieldType) -> dict[str, Any]:
    added = capacity = 0
    if isinstance(kind, Array):
        added, capacity, kind = _ARRAY, kind.length, kind.element
    elif isinstance(kind, Sequence):
        added, capacity = (_SEQUENCE, 0) if kind.bound is None else (_BOUNDED_SEQUENCE, kind.bound)
        kind = kind.element
    bound = kind.bound or 0 if isinstance(kind, Text) else 0
    if isinstance(kind, Primitive):
        number = _NUMBERS[kind.name]
    else:
        number = (_BOUNDED_STRING if bound else _STRING) if isinstance(kind, Text) else _NESTED
    return {
        "type_id": number + added,
        "capacity": capacity,
        "string_capacity": bound,
        "nested_type_name": kind.__msgtype__ if isinstance(kind, type) else "",
    }
