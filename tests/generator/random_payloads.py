"""Random payloads of any type, for hypothesis; those of google.protobuf are ones that mean something."""

from __future__ import annotations

from typing import Any

from google.protobuf.any_pb2 import Any as AnyPayload
from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.descriptor_pool import Default
from google.protobuf.json_format import ParseDict
from google.protobuf.message import Message as Payload
from google.protobuf.message_factory import GetMessageClass
from hypothesis import strategies as st

_DEEPEST = 4  # messages in one another, in random payloads
_NUMBERS = {
    FieldDescriptor.CPPTYPE_INT32: st.integers(-(2**31), 2**31 - 1),
    FieldDescriptor.CPPTYPE_INT64: st.integers(-(2**63), 2**63 - 1),
    FieldDescriptor.CPPTYPE_UINT32: st.integers(0, 2**32 - 1),
    FieldDescriptor.CPPTYPE_UINT64: st.integers(0, 2**64 - 1),
    FieldDescriptor.CPPTYPE_FLOAT: st.floats(width=32, allow_nan=False),
    FieldDescriptor.CPPTYPE_DOUBLE: st.floats(allow_nan=False),
    FieldDescriptor.CPPTYPE_BOOL: st.booleans(),
}
_TEXT = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=6)
_NANOSECONDS = st.one_of(st.sampled_from([0, 1, 500_000_000, 999_999_999]), st.integers(0, 999_999_999))
_JSON = st.recursive(
    st.one_of(st.none(), st.booleans(), st.floats(allow_nan=False, allow_infinity=False), _TEXT),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(_TEXT, inner, max_size=3)),
    max_leaves=6,
)


class Payloads:
    """Random payloads; an Any holds one of some messages, or something else."""

    def __init__(self, in_any: list[str]) -> None:
        self._in_any = in_any

    def of(self, descriptor: Descriptor, depth: int = 0) -> st.SearchStrategy[Payload]:
        """Any payload of a type; any field that is not required may be absent."""
        special = self._special(descriptor, depth) if descriptor.full_name.startswith("google.protobuf.") else None
        if special is not None:
            return special
        fields = [field for field in descriptor.fields if depth < _DEEPEST or field.message_type is None]
        required = {field.name: self._values(field, depth) for field in fields if field.is_required}
        others = {field.name: self._values(field, depth) for field in fields if not field.is_required}
        type = GetMessageClass(descriptor)
        return st.fixed_dictionaries(required, optional=others).map(lambda values: _made(type, values))

    def _special(self, descriptor: Descriptor, depth: int) -> st.SearchStrategy[Payload] | None:
        """Payloads of types of which not every combination of fields is one."""
        type: Any = GetMessageClass(descriptor)
        if descriptor.name == "Timestamp":
            return st.builds(type, seconds=st.integers(-(2**31), 2**31 - 1), nanos=_NANOSECONDS)
        if descriptor.name == "Duration":
            length = st.builds(type, seconds=st.integers(0, 2**31 - 1), nanos=_NANOSECONDS)
            return st.one_of(length, length.map(lambda one: type(seconds=-one.seconds, nanos=-one.nanos)))
        if descriptor.name in ("Struct", "Value", "ListValue"):
            wanted: Any = {"Struct": dict, "ListValue": list}.get(descriptor.name, object)
            return _JSON.filter(lambda said: isinstance(said, wanted)).map(lambda said: ParseDict(said, type()))
        if descriptor.name == "Any" and self._in_any:
            known = [Default().FindMessageTypeByName(name) for name in self._in_any]
            held = st.one_of([self.of(one, depth + 1) for one in known if depth < _DEEPEST] or [st.just(type())])
            return st.one_of(st.just(type()), held.map(packed), st.builds(type, type_url=_TEXT, value=st.binary()))
        return None

    def _values(self, field: FieldDescriptor, depth: int) -> st.SearchStrategy[Any]:
        if field.message_type is not None and field.message_type.GetOptions().map_entry:
            key, value = (field.message_type.fields_by_name[name] for name in ("key", "value"))
            return st.dictionaries(self._value(key, depth), self._value(value, depth), max_size=3)
        return st.lists(self._value(field, depth), max_size=4) if field.is_repeated else self._value(field, depth)

    def _value(self, field: FieldDescriptor, depth: int) -> st.SearchStrategy[Any]:
        if field.message_type is not None:
            return self.of(field.message_type, depth + 1)
        if field.enum_type is not None:
            return st.sampled_from([value.number for value in field.enum_type.values])
        if field.type == FieldDescriptor.TYPE_STRING:
            return _TEXT
        return st.binary(max_size=6) if field.type == FieldDescriptor.TYPE_BYTES else _NUMBERS[field.cpp_type]


def _made(type: type[Payload], values: dict[str, Any]) -> Payload:
    """A payload with the values; of the members of a oneof, the last is set."""
    payload = type()
    for name, value in values.items():
        if isinstance(value, dict):
            fill(getattr(payload, name), value)
        elif isinstance(value, list):
            getattr(payload, name).extend(value)
        elif isinstance(value, Payload):
            getattr(payload, name).CopyFrom(value)
            getattr(payload, name).SetInParent()
        else:
            setattr(payload, name, value)
    return payload


def fill(target: Any, values: dict[Any, Any]) -> None:
    """Put values into a map."""
    for key, value in values.items():
        if isinstance(value, Payload):
            target[key].CopyFrom(value)
        else:
            target[key] = value


def packed(payload: Payload) -> AnyPayload:
    """An Any that holds a payload."""
    packed = AnyPayload()
    packed.Pack(payload, deterministic=True)
    return packed
