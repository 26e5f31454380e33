"""Programs that write a payload from the frame of a ROS 2 message, which `cdr_reading` has filled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from collections.abc import Sequence as Items
from dataclasses import dataclass
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor

from roverlink.runtime.core.messages import FieldType, Message, Primitive, fields_of
from roverlink.runtime.core.protobuf_versions import is_closed, is_packed, is_repeated
from roverlink.runtime.native.cdr_reading import RosFrame
from roverlink.runtime.native.layout import NONE, Code, Flag, Number, Op
from roverlink.runtime.native.operations import (
    ROS_TYPE,
    Json,
    element_of,
    joined,
    key_flags,
    message_class,
    op,
    primitive_of,
    source_of,
    time_code,
    with_body,
)
from roverlink.runtime.native.payload_layouts import UnsupportedError, message_in
from roverlink.runtime.native.table_parts import TableParts


@dataclass(frozen=True)
class PayloadWriting:
    """Maker of the programs."""

    parts: TableParts

    # --- messages of the package ---

    def to_proto(self, message: type[Message], descriptor: Descriptor, frame: RosFrame, path: str) -> list[Op]:
        """Return the operations that write the fields of a payload, in the order of falling numbers."""
        conversions = [self.parts.conversions(message)[ros.name] for ros in fields_of(message)]
        whiches = {one["ros"]: one for one in conversions if one.get("kind") == "which"}
        tree: dict[str, Any] = {}
        for one in conversions:
            if one.get("kind") not in ("presence", "which"):
                *holders, name = one["proto"].split(".")
                node = tree
                for holder in holders:
                    node = node.setdefault(holder, {})
                node[name] = lambda proto, one=one: self._read_back(one, proto, message, frame, path, whiches)
        return self._fields(tree, descriptor)

    def _fields(self, tree: Mapping[str, Any], descriptor: Descriptor) -> list[Op]:
        ops: list[Op] = []
        for proto in sorted(descriptor.fields, key=lambda one: -one.number):
            node = tree.get(proto.name)
            if isinstance(node, dict):
                ops += _message(proto, self._fields(node, message_in(proto)))
            elif node is not None:
                ops += node(proto)
        return ops

    def _read_back(
        self,
        one: Json,
        proto: FieldDescriptor,
        message: type[Message],
        frame: RosFrame,
        path: str,
        whiches: Mapping[str, Json],
    ) -> list[Op]:
        own = joined(path, one["ros"])
        condition, expected = NONE, 0
        if "which" in one:
            which = whiches[one["which"]]
            condition, expected = (
                frame.slots[joined(path, which["ros"])],
                getattr(message, which["choices"][proto.name]),
            )
        elif "presence" in one:
            condition, expected = frame.slots[joined(path, one["presence"])], 1
        type = next(ros.type for ros in fields_of(message) if ros.name == one["ros"])
        if one.get("kind") == "empty":
            ops = _message(proto, [])
            if condition == NONE:
                condition, expected = frame.slots[own], 1
        elif "entry" in one:
            ops = self._map_back(type, one["entry"], proto, frame, own)
        elif one.get("repeated"):
            element = frame.elements[own]
            ops = self._elements(
                proto, frame.slots[own], element, self._back(element_of(type), one, proto, element, "")
            )
        else:
            ops = self._back(type, one, proto, frame, own)
        if condition != NONE:
            ops[0].condition, ops[0].expected = condition, expected
        return ops

    @staticmethod
    def _elements(proto: FieldDescriptor, slot: int, element: RosFrame, body: list[Op]) -> list[Op]:
        if not is_packed(proto):
            return with_body(op(Code.REPEAT, slot=slot, b=element.size), body)
        body[0].number = 0
        return with_body(op(Code.PACKED, slot=slot, b=element.size, number=proto.number), body)

    def _map_back(self, type: FieldType, entry: Json, proto: FieldDescriptor, frame: RosFrame, path: str) -> list[Op]:
        inner, element, map_entry = message_class(element_of(type)), frame.elements[path], message_in(proto)
        body: list[Op] = []
        for ros, name in reversed(list(zip(fields_of(inner), ("key", "value")))):
            part = self._back(ros.type, entry[name], map_entry.fields_by_name[name], element, ros.name)
            part[0].flags &= ~Flag.IMPLICIT  # an entry always contains both
            body += part
        flags = Flag.UNIQUE | key_flags(map_entry.fields_by_name["key"])
        key = element.slots[fields_of(inner)[0].name]
        head = op(Code.REPEAT, slot=frame.slots[path], a=key, b=element.size, flags=flags)
        return with_body(head, _message(proto, body))

    def _back(self, type: FieldType, one: Json, proto: FieldDescriptor, frame: RosFrame, path: str) -> list[Op]:
        """Return the operations that write one value of a proto field: a whole field, or an element of a list."""
        if "wrapping" in one:
            inner = message_in(proto).fields_by_name[one["wrapping"]]
            rest = {key: value for key, value in one.items() if key != "wrapping"}
            if is_repeated(inner):
                element = frame.elements[path]
                body = self._back(element_of(type), rest, inner, element, "")
                return _message(proto, self._elements(inner, frame.slots[path], element, body))
            return _message(proto, self._back(type, rest, inner, frame, path))
        kind = one.get("kind", "value")
        if kind == "held":
            (inner_field,) = fields_of(message_class(type))
            return [self._field(inner_field.type, proto, frame.slots[joined(path, inner_field.name)])]
        if kind == "message":
            body = self.to_proto(message_class(type), message_in(proto), frame, path)
            return _message(proto, body)
        if kind == "well_known":
            return [op(time_code(one), slot=frame.slots[joined(path, "sec")], number=proto.number)]
        if kind == "json":
            raise UnsupportedError(f"{proto.full_name} becomes JSON text")
        return [self._field(type, proto, frame.slots[path])]

    def _field(self, type: FieldType, proto: FieldDescriptor, slot: int) -> Op:
        written = self._plain_field(Code.FIELD, proto, slot)
        if isinstance(type, Primitive) and ROS_TYPE[proto.type] != type.name:
            written.a = self.parts.expression(self.parts.made({}, slot, source_of(type.name)))
        return written

    def _plain_field(self, code: Code, proto: FieldDescriptor, slot: int, a: int = NONE) -> Op:
        """Return the operation that writes a field; a closed enum has the values that it declares, and no other."""
        flags = 0 if proto.has_presence or is_repeated(proto) else Flag.IMPLICIT
        values = NONE
        if proto.enum_type is not None and is_closed(proto.enum_type):
            values = self.parts.payloads.enum(proto.enum_type)
        return op(code, slot=slot, number=proto.number, type=proto.type, flags=flags, a=a, b=values)

    # --- standard messages ---

    def standard_to_proto(
        self, message: type[Message], back: Items[Json], descriptor: Descriptor, frame: RosFrame
    ) -> tuple[list[Op], list[Op]]:
        """Return the operations that compute angles in a frame, and those that write the payload from the frame."""
        reading: list[Op] = []
        tree: dict[str, Any] = {}
        oneofs: set[str] = set()

        def add(one: Json, write: Callable[[FieldDescriptor], list[Op]]) -> None:
            *holders, name = one["to"].split(".")
            node, inside = tree, descriptor
            for part in (*holders, name):
                proto = inside.fields_by_name[part]
                if proto.containing_oneof is not None and len(proto.containing_oneof.fields) > 1:
                    oneofs.add(proto.full_name)
                inside = proto.message_type or inside
            for holder in holders:
                node = node.setdefault(holder, {})
            node.setdefault(name, write)

        types = dict(_leaf_types(message))
        for one in back:
            if "rotation" in one:
                first = frame.size
                frame.size += 3
                reading.append(op(Code.ANGLES, slot=first, a=frame.slots[joined(one["ros"], "x")]))
                for axis, part in enumerate(one["rotation"]):
                    if part is not None:
                        add(part, self._computed(part, first + axis, Number.DOUBLE))
            elif "moment" in one:
                slot = frame.slots[joined(one["ros"], "sec")]
                add(one["moment"], self._computed(one["moment"], slot, Number.NANOSECONDS))
            else:
                add(one, self._taken_back(one, types[one["ros"]], frame))
        if len(oneofs) > 1:
            raise UnsupportedError(f"{', '.join(sorted(oneofs))} are several members of oneofs")
        return reading, self._fields(tree, descriptor)

    def _taken_back(self, one: Json, type: FieldType, frame: RosFrame) -> Callable[[FieldDescriptor], list[Op]]:
        slot, element = frame.slots[one["ros"]], frame.elements.get(one["ros"])
        if element is not None:
            write = self._computed(one, 0, source_of(primitive_of(element_of(type)).name))
            return lambda proto: self._elements(proto, slot, element, write(proto))
        if isinstance(type, Primitive):
            return self._computed(one, slot, source_of(type.name))
        if "cases" in one:
            cases = self.parts.cases([(number, text) for text, number in one["cases"]])
            return lambda proto: [self._plain_field(Code.CASE, proto, slot, cases)]
        return lambda proto: [self._field(type, proto, slot)]

    def _computed(self, one: Json, slot: int, source: Number) -> Callable[[FieldDescriptor], list[Op]]:
        def write(proto: FieldDescriptor) -> list[Op]:
            expression = self.parts.expression(self.parts.made(one, slot, source))
            return [self._plain_field(Code.FIELD, proto, slot, expression)]

        return write


def _message(proto: FieldDescriptor, body: Items[Op]) -> list[Op]:
    """Return the operations that write a message, with those that write its fields."""
    return with_body(op(Code.MESSAGE, number=proto.number, type=proto.type), body)


def _leaf_types(message: type[Message], path: str = "") -> list[tuple[str, FieldType]]:
    found: list[tuple[str, FieldType]] = []
    for one in fields_of(message):
        own = joined(path, one.name)
        found.append((own, one.type))
        if isinstance(one.type, type):
            found += _leaf_types(one.type, own)
    return found
