"""Construction of a payload from assignments such as ``imu.accel_x=1``, as ``roverlink send`` takes them."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import yaml
from google.protobuf.descriptor import FieldDescriptor

from roverlink.bounded_yaml import BoundedBaseLoader
from roverlink.runtime.core.descriptor_check import scalar_name
from roverlink.runtime.core.errors import ConversionError, nearest
from roverlink.runtime.core.protobuf_versions import is_repeated
from roverlink.runtime.text import strict_yaml

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

P = TypeVar("P", bound="ProtoMessage")

_FLOATS = {FieldDescriptor.CPPTYPE_FLOAT: "<f", FieldDescriptor.CPPTYPE_DOUBLE: "<d"}
_INTEGERS = {
    FieldDescriptor.CPPTYPE_INT32: range(-(2**31), 2**31),
    FieldDescriptor.CPPTYPE_INT64: range(-(2**63), 2**63),
    FieldDescriptor.CPPTYPE_UINT32: range(2**32),
    FieldDescriptor.CPPTYPE_UINT64: range(2**64),
    FieldDescriptor.CPPTYPE_ENUM: range(-(2**31), 2**31),
}


def payload_from_assignments(payload_type: type[P], assignments: Mapping[str, Any]) -> P:
    """Build a payload from values; the keys of ``assignments`` are dotted paths of fields, such as ``imu.accel_x``.

    A value that is a string is read by the type of its field: an enum value by name or number, bytes in hexadecimal, a
    string unchanged, and numbers, lists and nested messages as YAML. Raises `ConversionError` for an unknown path or a
    value that does not fit.
    """
    values: dict[str, Any] = {}
    for path, value in assignments.items():
        *holders, name = path.split(".")
        descriptor, target = payload_type.DESCRIPTOR, values
        for holder in holders:
            descriptor = _nested(descriptor, holder, path)
            target = target.setdefault(holder, {})
        field = _field(descriptor, name, path)
        if name in target:
            raise ConversionError(f"{name} is assigned more than once", path)
        target[name] = _field_value(field, value, path)
    return payload_type(**values)


def _field(descriptor: Any, name: object, path: str) -> Any:
    field = descriptor.fields_by_name.get(name)
    if field is None:
        raise ConversionError(
            f"{descriptor.name} has no field {name!r}; {nearest(str(name), descriptor.fields_by_name)}", path
        )
    return field


def _nested(descriptor: Any, name: str, path: str) -> Any:
    field = _field(descriptor, name, path)
    if field.message_type is None:
        raise ConversionError(f"{descriptor.name}.{name} is not a message, so it has no fields", path)
    if is_repeated(field):
        raise ConversionError(f"{descriptor.name}.{name} is a list; write {name}=[{{...}}, ...]", path)
    return field.message_type


def _field_value(field: Any, value: Any, path: str) -> Any:
    """Return a value in the form that the protobuf class of the payload accepts for a field."""
    # A path has no way to write a map's keys.
    if field.message_type is not None and field.message_type.GetOptions().map_entry:
        raise ConversionError("the field is a map, which an assignment cannot set", path)
    if not is_repeated(field):
        return _item_value(field, value, path)
    values = _yaml(value, path) if isinstance(value, str) else value
    if not isinstance(values, list):
        values = [values]
    return [_item_value(field, item, f"{path}[{index}]") for index, item in enumerate(values)]


def _item_value(field: Any, value: Any, path: str) -> Any:
    if field.message_type is not None:
        return _message_value(field.message_type, value, path)
    if field.enum_type is not None:
        return _enum_value(field.enum_type, value, path)
    if field.type == field.TYPE_BYTES:
        return _bytes_value(value, path)
    if field.type == field.TYPE_STRING:
        return str(value)
    return _number_value(field, value, path)


def _message_value(descriptor: Any, value: Any, path: str) -> dict[str, Any]:
    values = _yaml(value, path) if isinstance(value, str) else value
    if not isinstance(values, Mapping):
        raise ConversionError(f"{value!r} is not a mapping of field names to values", path)
    return {
        str(name): _field_value(_field(descriptor, name, path), part, f"{path}.{name}") for name, part in values.items()
    }


def _enum_value(enum: Any, value: Any, path: str) -> int:
    """Return the number of an enum value that is given by name or number."""
    if isinstance(value, str) and value in enum.values_by_name:
        return int(enum.values_by_name[value].number)
    number = _scalar(value) if isinstance(value, str) else value
    if type(number) is int and number in _INTEGERS[FieldDescriptor.CPPTYPE_ENUM]:
        return number
    raise ConversionError(f"{enum.name} has no value {value!r}; {nearest(str(value), enum.values_by_name)}", path)


def _bytes_value(value: Any, path: str) -> bytes:
    try:
        return value if isinstance(value, bytes) else bytes.fromhex(value)
    except (ValueError, TypeError) as error:
        raise ConversionError(f"{value!r} is not a sequence of bytes in hexadecimal", path) from error


def _number_value(field: Any, value: Any, path: str) -> Any:
    """Return a number or a bool for a field; a value that is a text is parsed as YAML."""
    read = _scalar(value) if isinstance(value, str) else value
    if not _fits(field, read):
        raise ConversionError(f"{value!r} is not a valid {scalar_name(field)}", path)
    return read


def _scalar(text: str) -> Any:
    """Parse a YAML scalar; a text that is not valid YAML is returned unchanged.

    Numbers such as 1e-3 are accepted too, although YAML 1.1 requires a decimal point in them.
    """
    try:
        read = strict_yaml.load(text)
        # float() accepts it, so it is a number that YAML 1.1 did not recognize.
        return float(text) if read == text else read
    except ValueError:  # YamlTextError is a ValueError too
        return text


def _fits(field: Any, number: Any) -> bool:
    if field.cpp_type == FieldDescriptor.CPPTYPE_BOOL or isinstance(number, bool):
        return isinstance(number, bool) and field.cpp_type == FieldDescriptor.CPPTYPE_BOOL
    if field.cpp_type not in _FLOATS:
        return isinstance(number, int) and number in _INTEGERS[field.cpp_type]
    if not isinstance(number, (int, float)):
        return False
    try:
        struct.pack(_FLOATS[field.cpp_type], number)
    except OverflowError:
        return False
    return True


def _yaml(text: str, path: str) -> Any:
    """Parse YAML to lists, mappings and texts. Texts are parsed later, by the type of their field."""
    try:
        return yaml.load(text, BoundedBaseLoader)  # noqa: S506  # it makes only lists, mappings and texts
    except yaml.YAMLError as error:
        raise ConversionError(f"{text!r} is not valid YAML", path) from error
