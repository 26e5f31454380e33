"""Conversion of messages to plain Python values and back, for the command line.

The keys are the ROS field names for ROS 2 messages, and the proto field names for payloads.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

from google.protobuf.json_format import MessageToDict, SerializeToJsonError
from google.protobuf.message import DecodeError

from roverlink.runtime.core.errors import ConversionError, nearest
from roverlink.runtime.core.messages import (
    UINT8,
    Array,
    FieldType,
    Message,
    Primitive,
    Sequence,
    Text,
    default_of,
    fields_of,
)
from roverlink.runtime.core.protobuf_versions import ZEROS_TOO, is_repeated

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

M = TypeVar("M", bound=Message)

_KINDS = {"?": bool, "f": (int, float), "d": (int, float)}


# --- ROS 2 messages ---------------------------------------------------------------------------------------------


def message_to_values(message: Message) -> dict[str, Any]:
    """Convert a ROS 2 message to mappings, lists and scalars; ``uint8[]`` becomes a list of numbers."""
    return {field.name: _to_value(getattr(message, field.name)) for field in fields_of(type(message))}


def _to_value(value: Any) -> Any:
    if isinstance(value, Message):
        return message_to_values(value)
    if isinstance(value, (list, bytes)):
        return [_to_value(element) for element in value]
    return value


def message_from_values(message_type: type[M], values: object, path: str = "") -> M:
    """Build a ROS 2 message from a mapping of field names to plain values; missing fields are zero or empty.

    ``path`` is the dotted path of the message inside another message, for errors. Raises `ConversionError` for an
    unknown field or a value of the wrong type.
    """
    if not isinstance(values, Mapping):
        raise ConversionError(f"{values!r} is not a mapping of field names to values", path)
    fields = {field.name: field for field in fields_of(message_type)}
    for name in values:
        if name not in fields:
            known = nearest(str(name), fields) if fields else "it has no fields"
            raise ConversionError(f"{message_type.__msgtype__} has no field {name!r}; {known}", path)
    prefix = f"{path}." if path else ""
    made = {
        name: _from_value(field.type, values[name], prefix + name) if name in values else default_of(field.type)()
        for name, field in fields.items()
    }
    return message_type(**made)


def _from_value(field_type: FieldType, value: Any, path: str) -> Any:
    if isinstance(field_type, Primitive):
        kind: Any = _KINDS.get(field_type.format, int)
        if isinstance(value, str) and field_type.format in "fd":
            value = _float(value)
        if not isinstance(value, kind) or (kind is not bool and isinstance(value, bool)):
            raise ConversionError(f"{value!r} is not a valid {field_type.name}", path)
        # YAML reads 1 as an int; `struct` would accept it, but equal messages should have equal values.
        return float(value) if field_type.format in "fd" else value
    if isinstance(field_type, Text):
        if not isinstance(value, str):
            raise ConversionError(f"{value!r} is not a string", path)
        return value
    if isinstance(field_type, (Sequence, Array)):
        return _from_list(field_type.element, value, path)
    return message_from_values(field_type, value, path)


def _float(text: str) -> float | str:
    """Parse a number such as 1e-3, which YAML 1.1 reads as a string because it has no decimal point."""
    try:
        return float(text)
    except ValueError:
        return text


def _from_list(element: FieldType, value: Any, path: str) -> Any:
    if not isinstance(value, list):
        raise ConversionError(f"{value!r} is not a list", path)
    values = [_from_value(element, item, f"{path}[{index}]") for index, item in enumerate(value)]
    if element != UINT8:
        return values
    try:
        return bytes(values)
    except ValueError as error:
        raise ConversionError(f"a value of {values} does not fit uint8", path) from error


# --- payloads ---------------------------------------------------------------------------------------------------


def payload_to_values(payload: ProtoMessage) -> dict[str, Any]:
    """Convert a payload to mappings, lists and scalars. Fields that are zero are included.

    Enum values become names, bytes become base64. Protobuf's JSON has no form for some values, such as an Any of
    unknown type or a time out of range. A message that contains such a value is converted field by field.
    """
    try:
        # Zeros included: a reader of an example has to see every field, and cannot see the fields that are left out.
        values = MessageToDict(payload, preserving_proto_field_name=True, **ZEROS_TOO)
    except (TypeError, ValueError, DecodeError, SerializeToJsonError):
        return {field.name: _field_to_value(field, value) for field, value in payload.ListFields()}
    return _as_declared(payload.DESCRIPTOR, values) if _is_declared(payload.DESCRIPTOR) else values


def _field_to_value(field: Any, value: Any) -> Any:
    if field.message_type is not None and field.message_type.GetOptions().map_entry:
        inner = field.message_type.fields_by_name["value"]
        return {str(key): _element_to_value(inner, element) for key, element in value.items()}
    return (
        [_element_to_value(field, element) for element in value]
        if is_repeated(field)
        else _element_to_value(field, value)
    )


def _element_to_value(field: Any, value: Any) -> Any:
    if field.message_type is not None:
        return payload_to_values(value)
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    if field.enum_type is not None:
        known = field.enum_type.values_by_number.get(value)
        return known.name if known else value
    return value


def _as_declared(descriptor: Any, values: dict[str, Any]) -> dict[str, Any]:
    """Return values in the order in which the message declares their fields.

    Protobuf's own order has the fields with the value zero at the end.
    """
    return {
        field.name: _parts_as_declared(field, values[field.name]) for field in descriptor.fields if field.name in values
    }


def _parts_as_declared(field: Any, value: Any) -> Any:
    if not _has_declared_parts(field):
        return value
    if isinstance(value, list):
        return [_as_declared(field.message_type, item) for item in value]
    return _as_declared(field.message_type, value)


def _has_declared_parts(field: Any) -> bool:
    """Return true if a field is a message whose JSON form is a mapping with its fields as keys."""
    message = field.message_type
    return message is not None and not message.GetOptions().map_entry and _is_declared(message)


def _is_declared(message: Any) -> bool:
    return not message.full_name.startswith("google.protobuf.")
