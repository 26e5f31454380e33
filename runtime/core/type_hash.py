"""Type hashes of messages and services from their classes (see `roverlink.type_descriptions`).

The hashes of the table's messages come from the generator; this module has those of other messages and of services.
"""

from __future__ import annotations

from dataclasses import dataclass, field, make_dataclass
from typing import Annotated, Any, ClassVar

from roverlink import type_descriptions
from roverlink.runtime.core.messages import (
    Array,
    Bound,
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
from roverlink.type_descriptions import ARRAY, BOUNDED_SEQUENCE, SEQUENCE, TypeDescription, nested_type, primitive_type


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
    return type_descriptions.type_hash(_description(message_type), map(_description, messages_in(message_type)))


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


def _description(message_type: type[Message]) -> TypeDescription:
    fields = ((one.name, _type(one.type)) for one in fields_of(message_type))
    return type_descriptions.describe(message_type.__msgtype__, fields)


def _type(kind: FieldType) -> type_descriptions.FieldType:
    added = capacity = 0
    if isinstance(kind, Array):
        added, capacity, kind = ARRAY, kind.length, kind.element
    elif isinstance(kind, Sequence):
        added, capacity = (SEQUENCE, 0) if kind.bound is None else (BOUNDED_SEQUENCE, kind.bound)
        kind = kind.element
    if isinstance(kind, Primitive):
        return primitive_type(kind.name, added, capacity)
    if isinstance(kind, Text):
        return primitive_type("string", added, capacity, kind.bound or 0)
    return nested_type(kind.__msgtype__ if isinstance(kind, type) else "", added, capacity)
