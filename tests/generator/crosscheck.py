"""Does the generated code of a project do what the table says? A script, run as ``crosscheck.py mapping.yaml``.

It generates, loads the generated code, and checks each handler with random payloads against two others that know
nothing of that code: the IR, walked field by field here, says which value belongs where, and the `rosbags` package, fed
with the generated .msg files, says which bytes those are. It has a process of its own because two projects have each a
package `generated`, and because protobuf registers message types once a process.
"""

from __future__ import annotations

import json
import sys
from functools import reduce
from pathlib import Path
from typing import Any

import pytest
from google.protobuf.any_pb2 import Any as AnyPayload
from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.descriptor_pool import Default
from google.protobuf.json_format import MessageToDict, ParseDict
from google.protobuf.message import Message as Payload
from google.protobuf.message_factory import GetMessageClass
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from generator.ir import AnyConversion, Bridge, Conversion, ConversionKind, FieldConversion
from generator.pipeline import compile_table
from generator.write import compare, write
from runtime import ConversionError, cdr, load_registry
from runtime.messages import fields_of

_EXAMPLES = settings(max_examples=25, deadline=None, database=None, suppress_health_check=list(HealthCheck))
_PLACEHOLDER = "structure_needs_at_least_one_member"  # what ROS 2 puts into a message without fields
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


class RefusedError(Exception):
    """What the IR says must not be converted."""


# --- random payloads --------------------------------------------------------------------------------------------


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
            return st.one_of(st.just(type()), held.map(_packed), st.builds(type, type_url=_TEXT, value=st.binary()))
        return None

    def _values(self, field: FieldDescriptor, depth: int) -> st.SearchStrategy[Any]:
        if _is_map(field):
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


def _is_map(field: FieldDescriptor) -> bool:
    return field.message_type is not None and bool(field.message_type.GetOptions().map_entry)


def _made(type: type[Payload], values: dict[str, Any]) -> Payload:
    """A payload with the values; of the members of a oneof, the last is set."""
    payload = type()
    for name, value in values.items():
        if isinstance(value, dict):
            _fill(getattr(payload, name), value)
        elif isinstance(value, list):
            getattr(payload, name).extend(value)
        elif isinstance(value, Payload):
            getattr(payload, name).CopyFrom(value)
            getattr(payload, name).SetInParent()
        else:
            setattr(payload, name, value)
    return payload


def _fill(target: Any, values: dict[Any, Any]) -> None:
    for key, value in values.items():
        if isinstance(value, Payload):
            target[key].CopyFrom(value)
        else:
            target[key] = value


def _packed(payload: Payload) -> AnyPayload:
    packed = AnyPayload()
    packed.Pack(payload, deterministic=True)
    return packed


# --- the IR, walked ---------------------------------------------------------------------------------------------


class Walker:
    """Converts by the IR instead of by generated code."""

    def __init__(self, bridge: Bridge) -> None:
        self._conversions = bridge.conversions()
        self._anys = {conversion.ros: conversion for conversion in bridge.anys}
        self._messages = {message.name: message for message in bridge.messages}

    def message(self, conversion: Conversion, payload: Payload) -> dict[str, Any]:
        """The ROS message that a payload is, by field. Raises `RefusedError` where the payload is nested too deeply."""
        for path in conversion.cut:
            *holders, name = path.split(".")
            if any(field.name == name for field, _ in reduce(getattr, holders, payload).ListFields()):
                raise RefusedError
        return {field.ros.name: self._taken(field, payload, conversion.ros) for field in conversion.fields}

    def _taken(self, field: FieldConversion, payload: Payload, ros: str) -> Any:
        *holders, name = field.proto_path
        holder = reduce(getattr, holders, payload)
        if field.kind in (ConversionKind.PRESENCE, ConversionKind.EMPTY):
            return holder.HasField(name)
        if field.kind is ConversionKind.WHICH:
            named = {choice.proto: choice.constant for choice in field.choices}
            constant = named.get(holder.WhichOneof(name) or "")
            numbers = {constant.name: constant.value for constant in self._messages[ros].constants}
            return numbers[constant] if constant else 0
        value: Any = getattr(holder, name)
        if field.entry is not None:
            key, of_key = field.entry.value, field.entry.key
            return [{"key": self._one(of_key, one), "value": self._one(key, value[one])} for one in sorted(value)]
        if field.kind is ConversionKind.JSON and not field.repeated and not holder.HasField(name):
            return ""
        return [self._one(field, item) for item in value] if field.repeated else self._one(field, value)

    def _one(self, field: FieldConversion, value: Any) -> Any:
        if field.wrapping is not None:
            value = getattr(value, field.wrapping.field)
        if field.kind is ConversionKind.MESSAGE:
            if field.converter in self._anys:
                return self._any(self._anys[field.converter], value)
            return self.message(self._conversions[field.converter], value)
        if field.kind is ConversionKind.HELD:
            return {field.member: list(value) if isinstance(value, bytes) else value}
        if field.kind is ConversionKind.WELL_KNOWN:
            nanoseconds = value.seconds * 1_000_000_000 + value.nanos
            sec, nanosec = divmod(nanoseconds, 1_000_000_000)
            if not -(2**31) <= sec < 2**31:
                raise RefusedError
            return {"sec": sec, "nanosec": nanosec}
        if field.kind is ConversionKind.JSON:
            return json.dumps(_with_doubles(MessageToDict(value)), sort_keys=True, ensure_ascii=False)
        return value if isinstance(value, (str, int, float)) else list(value)

    def _any(self, conversion: AnyConversion, value: Any) -> dict[str, Any]:
        """The ROS message of an Any: of the members only the one that it holds says something."""
        made: dict[str, Any] = {"which": 0}
        constants = {constant.name: constant.value for constant in self._messages[conversion.ros].constants}
        for member in conversion.members:
            inner, held = (
                self._conversions[member.ros],
                GetMessageClass(Default().FindMessageTypeByName(member.proto))(),
            )
            if value.type_url.rpartition("/")[2] == member.proto and "/" in value.type_url:
                held.ParseFromString(value.value)
                made["which"] = constants[member.constant]
            made[member.field] = self.message(inner, held) if made["which"] == constants[member.constant] else None
        if not made["which"] and (value.type_url or value.value):
            raise RefusedError
        return made

    def settle(self, conversion: Conversion, payload: Payload) -> Payload:
        """What is left of a payload after it has been a ROS message.

        Fields that no ROS field takes are gone, and messages that cannot be absent in ROS are present.
        """
        settled = type(payload)()
        for field in conversion.fields:
            *holders, name = field.proto_path
            source, target = payload, settled
            for holder in holders:
                source, target = getattr(source, holder), getattr(target, holder)
                target.SetInParent()
            if field.kind not in (ConversionKind.PRESENCE, ConversionKind.WHICH) and _is_there(field, source):
                self._settle_field(field, getattr(source, name), target)
        return settled

    def _settle_field(self, field: FieldConversion, value: Any, target: Payload) -> None:
        name = field.proto_path[-1]
        if field.entry is not None:
            _fill(getattr(target, name), {key: self._settled(field.entry.value, one) for key, one in value.items()})
        elif field.repeated:
            getattr(target, name).extend([self._settled(field, item) for item in value])
        elif isinstance(value, Payload):
            getattr(target, name).CopyFrom(self._settled(field, value))
            getattr(target, name).SetInParent()
        else:
            setattr(target, name, value)

    def _settled(self, field: FieldConversion, value: Any) -> Any:
        if field.converter in self._conversions:
            return self.settle(self._conversions[field.converter], value)
        for member in self._anys[field.converter].members if field.converter in self._anys else ():
            if value.type_url.rpartition("/")[2] == member.proto:
                held = GetMessageClass(Default().FindMessageTypeByName(member.proto)).FromString(value.value)
                return _packed(self.settle(self._conversions[member.ros], held))
        return value


def _is_there(field: FieldConversion, holder: Payload) -> bool:
    """Whether a field is set in the payload that comes back."""
    name = field.proto_path[-1]
    if field.repeated:
        return True
    says = field.presence or field.which or field.kind in (ConversionKind.EMPTY, ConversionKind.JSON)
    return not says or holder.HasField(name)


def _with_doubles(said: Any) -> Any:
    """What protobuf's own JSON says, with the numbers that it shortens."""
    if isinstance(said, dict):
        return {key: _with_doubles(value) for key, value in said.items()}
    if isinstance(said, list):
        return [_with_doubles(value) for value in said]
    return float(said) if isinstance(said, int) and not isinstance(said, bool) else said


# --- rosbags ----------------------------------------------------------------------------------------------------


def typestore(project: Path, package: str) -> Typestore:
    """A rosbags store that has read the generated .msg files."""
    store = get_typestore(Stores.EMPTY)
    types: dict[str, Any] = {}
    for name in ("Time", "Duration"):
        types.update(get_types_from_msg("int32 sec\nuint32 nanosec\n", f"builtin_interfaces/msg/{name}"))
    for path in sorted((project / "generated" / "ros" / package / "msg").glob("*.msg")):
        types.update(get_types_from_msg(path.read_text(encoding="utf-8"), f"{package}/msg/{path.stem}"))
    store.register(types)
    return store


def plain(value: Any, store: Typestore) -> Any:
    """A value of rosbags as plain Python, a message as a mapping of its fields."""
    if hasattr(value, "__msgtype__"):
        _, fields = store.fielddefs[value.__msgtype__]
        return {name: plain(getattr(value, name), store) for name, _ in fields if name != _PLACEHOLDER}
    if hasattr(value, "tolist"):
        return value.tolist()
    return [plain(item, store) for item in value] if isinstance(value, list) else value


# --- the check --------------------------------------------------------------------------------------------------


def check(table: Path) -> None:
    """Raise `AssertionError` where a handler does something else than the IR and rosbags."""
    compiled = compile_table(table)
    write(table.parent, compare(table.parent, compiled.files, compiled.folders))
    registry = load_registry(table.parent)
    store, walker = typestore(table.parent, registry.package), Walker(compiled.bridge)
    in_any = sorted({member.proto for conversion in compiled.bridge.anys for member in conversion.members})
    assert len(registry.handlers) == len(compiled.bridge.routes) > 0
    for route in compiled.bridge.routes:
        handler = registry.by_number[route.number]
        _check_handler(handler, route.conversion, walker, store, Payloads(in_any))
        _check_any_number(handler)
        _check_refusals(handler, route.conversion)


def _check_handler(handler: Any, conversion: Conversion, walker: Walker, store: Typestore, random: Payloads) -> None:
    type_name = handler.message_type.__msgtype__

    @_EXAMPLES
    @given(random.of(handler.payload_type.DESCRIPTOR))
    def both_ways(payload: Any) -> None:
        try:
            expected = walker.message(conversion, payload)
        except RefusedError:
            _must_refuse(handler, payload)
            return
        serialized = handler.pack(payload)
        assert handler.to_cdr(payload) == cdr.encode(handler.to_ros(payload)) == serialized
        theirs = store.deserialize_cdr(serialized, type_name)
        _must_be(plain(theirs, store), expected)
        back = handler.from_cdr(bytes(store.serialize_cdr(theirs, type_name)))
        assert back == walker.settle(conversion, payload)
        assert handler.to_cdr(back) == serialized

    both_ways()


def _must_refuse(handler: Any, payload: Payload) -> None:
    with pytest.raises(ConversionError, match=rf"^{handler.route.name}\."):
        handler.to_cdr(payload)


def _must_be(found: Any, expected: Any) -> None:
    """Compare what was read with what is expected; None stands for whatever a field holds that says nothing."""
    if isinstance(expected, dict):
        assert list(found) == list(expected)
        for name, value in expected.items():
            _must_be(found[name], value)
    elif isinstance(expected, list):
        assert len(found) == len(expected)
        for one, other in zip(found, expected):
            _must_be(one, other)
    else:
        assert expected is None or found == expected, (found, expected)


def _check_any_number(handler: Any) -> None:
    """A number that its enum does not declare, as a newer board may send it, crosses or is a `ConversionError`.

    Of a closed enum, protobuf sets it aside; the field is absent then, and no other number takes its place.
    """

    @_EXAMPLES
    @given(st.integers(-(2**31), 2**31 - 1))
    def any_number(number: int) -> None:
        fields = handler.payload_type.DESCRIPTOR.fields
        for field in fields:
            if field.enum_type is None or number in field.enum_type.values_by_number:
                continue
            if field.enum_type.is_closed:
                if not any(other.is_required for other in fields):
                    _must_not_be_taken(handler, field.name, number)
                    sent = _varint(field.number << 3) + _varint(number % 2**64)
                    _must_be_absent(handler, handler.payload_type.FromString(sent))
                continue
            payload = handler.payload_type(**{field.name: [number] if field.is_repeated else number})
            try:
                back = handler.from_cdr(handler.to_cdr(payload))
            except ConversionError:
                continue
            assert getattr(back, field.name) == getattr(payload, field.name)

    any_number()


def _varint(number: int) -> bytes:
    groups = [number >> shift & 0x7F for shift in range(0, max(1, number.bit_length()), 7)]
    return bytes([*(group | 0x80 for group in groups[:-1]), groups[-1]])


def _must_not_be_taken(handler: Any, name: str, number: int) -> None:
    """A ROS message with the number, where its field can hold that, is no payload."""
    message = handler.message_type(**{f"has_{name}": True}) if hasattr(handler.message_type, f"has_{name}") else None
    if message is not None and 0 <= number < 2**8:
        setattr(message, name, number)
        with pytest.raises(ConversionError):
            handler.from_cdr(cdr.encode(message))


def _must_be_absent(handler: Any, payload: Payload) -> None:
    assert handler.to_cdr(payload) == handler.to_cdr(handler.payload_type())


def _check_refusals(handler: Any, conversion: Conversion) -> None:
    """What no payload says is a `ConversionError` that names route and field."""
    types = {field.name: field.type for field in fields_of(handler.message_type)}
    for field in conversion.fields:
        wrong: Any
        message, name = handler.message_type(), field.ros.name
        if field.kind is ConversionKind.WHICH:
            wrong = 13
        elif field.entry is not None:
            element: Any = types[name]
            wrong = [element.element(), element.element()]
        elif field.kind is ConversionKind.JSON and not (field.repeated or field.which):
            wrong = "{"
        elif field.kind is ConversionKind.WELL_KNOWN and not (field.repeated or field.which or field.presence):
            wrong = types[name](0, 1_000_000_000)
        else:
            continue
        setattr(message, name, wrong)
        with pytest.raises(ConversionError, match=rf"^{handler.route.name}\.{name}: "):
            handler.from_cdr(cdr.encode(message))


if __name__ == "__main__":
    check(Path(sys.argv[1]).resolve())
