"""Random payloads of any message."""

from __future__ import annotations

import struct
from random import Random
from typing import Any

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message

_INTEGERS = {
    FieldDescriptor.CPPTYPE_INT32: (-(2**31), 2**31 - 1),
    FieldDescriptor.CPPTYPE_INT64: (-(2**63), 2**63 - 1),
    FieldDescriptor.CPPTYPE_UINT32: (0, 2**32 - 1),
    FieldDescriptor.CPPTYPE_UINT64: (0, 2**64 - 1),
}


def random_payload(payload_type: type[Message], random: Random) -> Message:
    """A payload with values of the whole range in most of its fields, which has no text, no bytes and no map."""
    payload = payload_type()
    for field in payload.DESCRIPTOR.fields:
        if random.random() < 0.2:
            continue
        values = [_value(field, random) for _ in range(random.randrange(4) if field.is_repeated else 1)]
        if field.is_repeated:
            getattr(payload, field.name).extend(values)
        elif field.message_type:
            getattr(payload, field.name).CopyFrom(values[0])
        else:
            setattr(payload, field.name, values[0])
    return payload


def _value(field: Any, random: Random) -> Any:
    if field.message_type:
        return random_payload(field.message_type._concrete_class, random)
    if field.enum_type:
        return random.choice(field.enum_type.values).number
    if field.cpp_type == FieldDescriptor.CPPTYPE_BOOL:
        return random.random() < 0.5
    if field.cpp_type == FieldDescriptor.CPPTYPE_FLOAT:
        return struct.unpack("<f", struct.pack("<f", random.uniform(-1e6, 1e6)))[0]
    if field.cpp_type == FieldDescriptor.CPPTYPE_DOUBLE:
        return random.uniform(-1e9, 1e9)
    low, high = _INTEGERS[field.cpp_type]
    return random.choice([0, low, high, random.randint(low, high)])
