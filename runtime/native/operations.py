"""Operations of the native core's programs, and the types and paths that they are made from."""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Sequence as Items
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor

from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Array, FieldType, Message, Primitive, Sequence
from roverlink.runtime.native.layout import NONE, Code, Flag, Number, Op
from roverlink.runtime.native.payload_layouts import UnsupportedError, message_in

Json = Mapping[str, Any]

PRIMITIVES = ("bool", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")
ROS_TYPE = {
    FieldDescriptor.TYPE_DOUBLE: "float64",
    FieldDescriptor.TYPE_FLOAT: "float32",
    FieldDescriptor.TYPE_INT64: "int64",
    FieldDescriptor.TYPE_UINT64: "uint64",
    FieldDescriptor.TYPE_INT32: "int32",
    FieldDescriptor.TYPE_FIXED64: "uint64",
    FieldDescriptor.TYPE_FIXED32: "uint32",
    FieldDescriptor.TYPE_BOOL: "bool",
    FieldDescriptor.TYPE_UINT32: "uint32",
    FieldDescriptor.TYPE_ENUM: "int32",
    FieldDescriptor.TYPE_SFIXED32: "int32",
    FieldDescriptor.TYPE_SFIXED64: "int64",
    FieldDescriptor.TYPE_SINT32: "int32",
    FieldDescriptor.TYPE_SINT64: "int64",
}
_SOURCES = {"float32": Number.SINGLE, "float64": Number.DOUBLE}

builtin_type = type


def type_code(primitive: Primitive) -> int:
    """Return the number of a primitive in the table."""
    return PRIMITIVES.index({"byte": "uint8", "char": "uint8"}.get(primitive.name, primitive.name))


def op(code: Code, **parts: int) -> Op:
    """Return an operation; it refers to nothing that is not given."""
    return Op(code=code, **{"condition": NONE, "a": NONE, **parts})


def with_body(head: Op, body: Items[Op]) -> list[Op]:
    """Return an operation with the operations that are its body."""
    head.size = len(body)
    return [head, *body]


def list_op(type: FieldType, slot: int) -> Op:
    """Return the operation for a sequence or an array, without its body. Raises `UnsupportedError`."""
    if isinstance(type, Array):
        return op(Code.LIST, slot=slot, b=type.length, number=1, flags=Flag.ARRAY)
    if not isinstance(type, Sequence):
        raise UnsupportedError(f"a list becomes {cdr.type_name(type)}")
    return op(Code.LIST, slot=slot, a=NONE if type.bound is None else type.bound, number=1)


def octets_op(type: FieldType, slot: int) -> Op:
    """Return the operation for a sequence or an array of octets."""
    head = list_op(type, slot)
    head.code = Code.OCTETS
    return head


def time_code(one: Json) -> Code:
    """Return the operation for a well-known type."""
    return {"timestamp": Code.TIME, "duration": Code.DURATION}[one["converter"]]


def element_of(type: FieldType) -> FieldType:
    """Return the type of a list's elements. Raises `UnsupportedError`."""
    if not isinstance(type, (Sequence, Array)):
        raise UnsupportedError(f"a list becomes {cdr.type_name(type)}")
    return type.element


def message_class(type: FieldType) -> type[Message]:
    """Return a type that is a message. Raises `UnsupportedError`."""
    if not isinstance(type, builtin_type):
        raise UnsupportedError(f"a message becomes {cdr.type_name(type)}")
    return type


def primitive_of(type: FieldType) -> Primitive:
    """Return a type that is a primitive. Raises `UnsupportedError`."""
    if not isinstance(type, Primitive):
        raise UnsupportedError(f"a number becomes {cdr.type_name(type)}")
    return type


def source_of(primitive: str) -> Number:
    """Return the kind of number with which an expression on a primitive begins, by the primitive's name."""
    if primitive in _SOURCES:
        return _SOURCES[primitive]
    return Number.SIGNED if primitive.startswith("int") else Number.UNSIGNED


def key_flags(key: FieldDescriptor) -> int:
    """Return how the keys of a map are compared."""
    if key.type == FieldDescriptor.TYPE_STRING:
        return Flag.TEXT_KEY
    return Flag.SIGNED_KEY if ROS_TYPE[key.type].startswith("int") else 0


def field_at(descriptor: Descriptor, path: str) -> FieldDescriptor:
    """Return the field at a dotted path in a message."""
    name, _, rest = path.partition(".")
    proto = descriptor.fields_by_name[name]
    return field_at(message_in(proto), rest) if rest else proto


def joined(path: str, name: str) -> str:
    """Return the path of a field in a message at a path."""
    return f"{path}.{name}" if path else name
