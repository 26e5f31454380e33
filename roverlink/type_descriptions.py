"""Type descriptions and type hashes of ROS 2 (REP 2016), by which nodes compare definitions of messages from Iron on.

The description of a type names its fields and their types in order, without comments, constants and defaults. The hash
is SHA-256 over a JSON text with the descriptions of a type and of all types in it. rosidl computes the hash when it
builds an interface package; a bridge can run without such a build.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from typing import TypedDict

ARRAY, BOUNDED_SEQUENCE, SEQUENCE = 48, 96, 144
"""Amounts that are added to the number of an element's type (type_description_interfaces/msg/FieldType)."""
_PREFIX = "RIHS01_"  # ROS interface hashing standard, version 1
_NESTED, _BOUNDED_STRING = 1, 21
# rosidl takes a `char` of a .msg file for a uint8.
_NUMBERS = {"int8": 2, "uint8": 3, "char": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8}
_NUMBERS |= {"uint64": 9, "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17}


# REP 2016 prescribes the keys of these texts and their order.


class FieldType(TypedDict):
    """Type of a field (type_description_interfaces/msg/FieldType)."""

    type_id: int
    capacity: int
    string_capacity: int
    nested_type_name: str


class DescribedField(TypedDict):
    """Field of a message (type_description_interfaces/msg/Field)."""

    name: str
    type: FieldType


class TypeDescription(TypedDict):
    """Message without those in it (type_description_interfaces/msg/IndividualTypeDescription)."""

    type_name: str
    fields: list[DescribedField]


def primitive_type(name: str, added: int = 0, capacity: int = 0, bound: int = 0) -> FieldType:
    """Describe a primitive type or a string, with at most ``bound`` characters; 0 for any number.

    ``added`` makes an array or a sequence of it, with ``capacity`` elements (0: any number).
    """
    number = _BOUNDED_STRING if bound else _NUMBERS[name]
    return {"type_id": number + added, "capacity": capacity, "string_capacity": bound, "nested_type_name": ""}


def nested_type(name: str, added: int = 0, capacity: int = 0) -> FieldType:
    """Describe a message as the type of a field; ``added`` and ``capacity`` are those of `primitive_type`."""
    return {"type_id": _NESTED + added, "capacity": capacity, "string_capacity": 0, "nested_type_name": name}


def describe(name: str, fields: Iterable[tuple[str, FieldType]]) -> TypeDescription:
    """Describe a message by its full name and its fields."""
    described: list[DescribedField] = [{"name": field, "type": kind} for field, kind in fields]
    # rosidl adds a field to a message without fields, because C has no empty structs.
    empty: DescribedField = {"name": "structure_needs_at_least_one_member", "type": primitive_type("uint8")}
    return {"type_name": name, "fields": described or [empty]}


def type_hash(described: TypeDescription, inside: Iterable[TypeDescription]) -> str:
    """Return the type hash of a message, ``RIHS01_...``; ``inside`` has all messages in it, directly or not."""
    referenced = sorted(inside, key=lambda one: one["type_name"])
    text = json.dumps({"type_description": described, "referenced_type_descriptions": referenced})
    return f"{_PREFIX}{hashlib.sha256(text.encode()).hexdigest()}"
