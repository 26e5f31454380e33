"""Does the generated code of a project do what the table says? A script, run as ``crosscheck.py mapping.yaml``.

It generates, loads the generated code, and checks each handler with random payloads against two others that know
nothing of that code: the IR, walked field by field here, says which value belongs where, and the `rosbags` package, fed
with the generated .msg files, says which bytes those are. It has a process of its own because two projects have each a
package `generated`, and because protobuf registers message types once a process.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import reduce
from pathlib import Path
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.message import Message as Payload
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from generator.ir import Bridge, Conversion, ConversionKind, FieldConversion
from generator.pipeline import compile_table
from generator.write import compare, write
from runtime import ConversionError, cdr, load_registry

_EXAMPLES = settings(max_examples=15, deadline=None, database=None, suppress_health_check=list(HealthCheck))
_PLACEHOLDER = "structure_needs_at_least_one_member"  # what ROS 2 puts into a message without fields
_NUMBERS = {
    FieldDescriptor.CPPTYPE_INT32: st.integers(-(2**31), 2**31 - 1),
    FieldDescriptor.CPPTYPE_INT64: st.integers(-(2**63), 2**63 - 1),
    FieldDescriptor.CPPTYPE_UINT32: st.integers(0, 2**32 - 1),
    FieldDescriptor.CPPTYPE_UINT64: st.integers(0, 2**64 - 1),
    FieldDescriptor.CPPTYPE_FLOAT: st.floats(width=32, allow_nan=False),
    FieldDescriptor.CPPTYPE_DOUBLE: st.floats(allow_nan=False),
    FieldDescriptor.CPPTYPE_BOOL: st.booleans(),
}


# --- random payloads --------------------------------------------------------------------------------------------


def payloads(descriptor: Descriptor) -> st.SearchStrategy[dict[str, Any]]:
    """The fields of any payload; any of them may be absent."""
    fields = [field for field in descriptor.fields if not _is_map(field)]
    required = {field.name: _values(field) for field in fields if field.is_required}
    others = {field.name: _values(field) for field in fields if not field.is_required}
    return st.fixed_dictionaries(required, optional=others)


def _is_map(field: FieldDescriptor) -> bool:
    return field.message_type is not None and bool(field.message_type.GetOptions().map_entry)


def _values(field: FieldDescriptor) -> st.SearchStrategy[Any]:
    return st.lists(_value(field), max_size=4) if field.is_repeated else _value(field)


def _value(field: FieldDescriptor) -> st.SearchStrategy[Any]:
    if field.message_type is not None:
        return payloads(field.message_type)
    if field.enum_type is not None:
        return st.sampled_from([value.number for value in field.enum_type.values])
    if field.type == FieldDescriptor.TYPE_STRING:
        return st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=6)
    return st.binary(max_size=6) if field.type == FieldDescriptor.TYPE_BYTES else _NUMBERS[field.cpp_type]


# --- the IR, walked ---------------------------------------------------------------------------------------------


class Walker:
    """Converts by the IR instead of by generated code."""

    def __init__(self, bridge: Bridge) -> None:
        self._conversions = bridge.conversions()

    def message(self, conversion: Conversion, payload: Payload) -> dict[str, Any]:
        """The ROS message that a payload is, by field."""
        return {field.ros.name: self._taken(field, payload) for field in conversion.fields}

    def _taken(self, field: FieldConversion, payload: Payload) -> Any:
        *holders, name = field.proto_path
        holder = reduce(getattr, holders, payload)
        if field.kind is ConversionKind.PRESENCE:
            return holder.HasField(name)
        value: Any = getattr(holder, name)
        return [self._one(field, item) for item in value] if field.repeated else self._one(field, value)

    def _one(self, field: FieldConversion, value: Any) -> Any:
        if field.kind is ConversionKind.MESSAGE:
            return self.message(self._conversions[field.proto], value)
        if field.kind is ConversionKind.ENUM_MESSAGE:
            return {field.member: value}
        return list(value) if isinstance(value, bytes) else value

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
            if field.kind is not ConversionKind.PRESENCE and (not field.guarded or source.HasField(name)):
                self._settle_field(field, getattr(source, name), target)
        return settled

    def _settle_field(self, field: FieldConversion, value: Any, target: Payload) -> None:
        name = field.proto_path[-1]
        nested = self._conversions[field.proto] if field.proto else None
        if field.repeated:
            getattr(target, name).extend([self.settle(nested, item) if nested else item for item in value])
        elif nested:
            getattr(target, name).CopyFrom(self.settle(nested, value))
            getattr(target, name).SetInParent()
        else:
            setattr(target, name, value)


# --- rosbags ----------------------------------------------------------------------------------------------------


def typestore(project: Path, package: str) -> Typestore:
    """A rosbags store that has read the generated .msg files."""
    store = get_typestore(Stores.EMPTY)
    types: dict[str, Any] = {}
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
    assert len(registry.handlers) == len(compiled.bridge.routes) > 0
    for route in compiled.bridge.routes:
        handler = registry.by_number[route.number]
        _check_handler(handler, route.conversion, walker, store)
        _check_any_number(handler)


def _check_handler(handler: Any, conversion: Conversion, walker: Walker, store: Typestore) -> None:
    type_name = handler.message_type.__msgtype__

    @_EXAMPLES
    @given(payloads(handler.payload_type.DESCRIPTOR))
    def both_ways(fields: Mapping[str, Any]) -> None:
        payload = handler.payload_type(**fields)
        serialized = handler.pack(payload)
        assert handler.to_cdr(payload) == cdr.encode(handler.to_ros(payload)) == serialized
        theirs = store.deserialize_cdr(serialized, type_name)
        assert plain(theirs, store) == walker.message(conversion, payload)
        back = handler.from_cdr(bytes(store.serialize_cdr(theirs, type_name)))
        assert back == walker.settle(conversion, payload)

    both_ways()


def _check_any_number(handler: Any) -> None:
    """A number that its enum does not declare, as a newer board may send it, crosses or is a `ConversionError`."""

    @_EXAMPLES
    @given(st.integers(-(2**31), 2**31 - 1))
    def any_number(number: int) -> None:
        for field in handler.payload_type.DESCRIPTOR.fields:
            if field.enum_type is None or field.enum_type.is_closed:
                continue
            payload = handler.payload_type(**{field.name: [number] if field.is_repeated else number})
            try:
                back = handler.from_cdr(handler.to_cdr(payload))
            except ConversionError:
                continue
            assert getattr(back, field.name) == getattr(payload, field.name)

    any_number()


if __name__ == "__main__":
    check(Path(sys.argv[1]).resolve())
