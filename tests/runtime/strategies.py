"""Values for the property tests: payloads, ROS 2 messages, and envelopes as bytes."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, TypeVar

from google.protobuf.descriptor import FieldDescriptor
from hypothesis import strategies as st

from generated.registry import REGISTRY
from roverlink.runtime.core.messages import UINT8, Array, FieldType, Message, Primitive, Sequence, Text, fields_of

if TYPE_CHECKING:
    from google.protobuf.descriptor import Descriptor

M = TypeVar("M", bound=Message)

_FLOATS = {"f": st.floats(width=32), "d": st.floats()}
_INTEGERS = {
    FieldDescriptor.CPPTYPE_INT32: st.integers(-(2**31), 2**31 - 1),
    FieldDescriptor.CPPTYPE_INT64: st.integers(-(2**63), 2**63 - 1),
    FieldDescriptor.CPPTYPE_UINT32: st.integers(0, 2**32 - 1),
    FieldDescriptor.CPPTYPE_UINT64: st.integers(0, 2**64 - 1),
}

# --- payloads ---------------------------------------------------------------------------------------------------


def _payloads(descriptor: Descriptor) -> st.SearchStrategy[dict[str, Any]]:
    """Payloads with any values, as mappings; any fields are left out, nested messages among them."""
    return st.fixed_dictionaries({}, optional={field.name: _field_values(field) for field in descriptor.fields})


def _field_values(field: FieldDescriptor) -> st.SearchStrategy[Any]:
    if field.message_type is not None:
        return _payloads(field.message_type)
    if field.enum_type is not None:
        return st.sampled_from([value.number for value in field.enum_type.values])
    if field.cpp_type == FieldDescriptor.CPPTYPE_BOOL:
        return st.booleans()
    if field.cpp_type == FieldDescriptor.CPPTYPE_FLOAT:
        return _FLOATS["f"]
    if field.cpp_type == FieldDescriptor.CPPTYPE_DOUBLE:
        return _FLOATS["d"]
    return _INTEGERS[field.cpp_type]


# --- ROS 2 messages ---------------------------------------------------------------------------------------------


def messages(message_type: type[M]) -> st.SearchStrategy[M]:
    """Messages with any values that their types hold."""
    fields = {field.name: ros_values(field.type) for field in fields_of(message_type)}
    return st.builds(message_type, **fields)


def ros_values(field_type: FieldType, longest: int = 5) -> st.SearchStrategy[Any]:
    """Any value of a ROS type; sequences without a bound have up to ``longest`` elements."""
    if isinstance(field_type, Primitive):
        return _primitives(field_type)
    if isinstance(field_type, Text):
        return _texts(field_type.bound)
    if isinstance(field_type, Sequence):
        return _lists(field_type.element, 0, longest if field_type.bound is None else field_type.bound)
    if isinstance(field_type, Array):
        return _lists(field_type.element, field_type.length, field_type.length)
    return messages(field_type)


def _primitives(primitive: Primitive) -> st.SearchStrategy[Any]:
    if primitive.format == "?":
        return st.booleans()
    if primitive.format in _FLOATS:
        return _FLOATS[primitive.format]
    bits = 8 * primitive.size
    signed = primitive.format.islower()
    return st.integers(-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else st.integers(0, 2**bits - 1)


def _texts(bound: int | None) -> st.SearchStrategy[str]:
    characters = st.characters(exclude_categories=["Cs"], exclude_characters="\0")
    texts = st.text(characters, max_size=8)
    return texts if bound is None else texts.filter(lambda text: len(text.encode()) <= bound)


def _lists(element: FieldType, shortest: int, longest: int) -> st.SearchStrategy[Any]:
    if element == UINT8:
        return st.binary(min_size=shortest, max_size=longest)
    return st.lists(ros_values(element), min_size=shortest, max_size=longest)


# --- envelopes as bytes -----------------------------------------------------------------------------------------

_FREE_NUMBERS = st.integers(1000, 2**21)  # no payload has them, so that any bytes may stand in them
_MOST_TAG_PADDING = 1  # a tag of five bytes is the longest that is read


def varint(value: int, padding: int = 0) -> bytes:
    """A varint, made longer than it has to be by a number of zero groups."""
    groups = []
    while True:
        groups.append(value & 0x7F)
        value >>= 7
        if not value:
            break
    groups += [0] * min(padding, 10 - len(groups))
    return bytes(group | 0x80 for group in groups[:-1]) + bytes(groups[-1:])


def delimited(number: int, content: bytes, padding: int = 0) -> bytes:
    """A length-delimited field."""
    return varint(number << 3 | 2) + varint(len(content), padding) + content


@st.composite
def unknown_fields(draw: st.DrawFn, depth: int = 2) -> bytes:
    """A field that no payload has, of any wire type; groups hold more of them."""
    number, padding = draw(_FREE_NUMBERS), draw(st.integers(0, 9))
    kind = draw(st.sampled_from([0, 1, 2, 3, 5] if depth else [0, 1, 2, 5]))
    tag = varint(number << 3 | kind, draw(st.integers(0, _MOST_TAG_PADDING)))
    if kind == 0:
        return tag + varint(draw(st.integers(0, 2**64 - 1)), padding)
    if kind == 1:
        return tag + struct.pack("<Q", draw(st.integers(0, 2**64 - 1)))
    if kind == 2:
        # The length of a field is at most 31 bits long, in five bytes.
        content = draw(st.one_of(st.binary(max_size=20), st.builds(bytes, st.integers(0, 200))))
        return delimited(number, content, min(padding, 3))
    if kind == 5:
        return tag + struct.pack("<I", draw(st.integers(0, 2**32 - 1)))
    inside = b"".join(draw(st.lists(unknown_fields(depth=depth - 1), max_size=3)))
    return tag + inside + varint(number << 3 | 4)


@st.composite
def payload_fields(draw: st.DrawFn) -> bytes:
    """One payload of the table, as a field of an envelope."""
    handler = draw(st.sampled_from(REGISTRY.handlers))
    payload = handler.payload_type(**draw(_payloads(handler.payload_type.DESCRIPTOR)))
    return delimited(handler.route.number, payload.SerializeToString(), draw(st.integers(0, 3)))


def envelopes() -> st.SearchStrategy[bytes]:
    """Valid envelopes: several payloads and unknown fields in any order, none of them as well."""
    return st.lists(st.one_of(payload_fields(), unknown_fields()), max_size=4).map(b"".join)
