"""Programs of the native core: each conversion of ``translations.json`` as operations on slots, in both directions."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from collections.abc import Sequence as Items
from dataclasses import dataclass, field
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor

from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import (
    UINT8,
    Array,
    Field,
    FieldType,
    Message,
    Primitive,
    Sequence,
    Text,
    default_of,
    fields_of,
)
from roverlink.runtime.native.layout import NONE, Code, Expression, ExpressionFlag, Flag, Number, Op, Step
from roverlink.runtime.native.payload_layouts import PayloadLayouts, Place, UnsupportedError, message_in

Json = Mapping[str, Any]

_PRIMITIVES = ("bool", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")
_ROS_TYPE = {
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
_STEPS = {"negate": 0, "*": 1, "/": 2, "+": 3, "-": 4, "//": 5}
_OCTETS = (UINT8,)


def _type(primitive: Primitive) -> int:
    return _PRIMITIVES.index({"byte": "uint8", "char": "uint8"}.get(primitive.name, primitive.name))


def _op(code: Code, **parts: int) -> Op:
    return Op(code=code, **{"condition": NONE, "a": NONE, **parts})


def _body(head: Op, body: Items[Op]) -> list[Op]:
    head.size = len(body)
    return [head, *body]


@dataclass
class RosFrame:
    """Slots of a ROS message that is read: by dotted path, and for lists the frame of an element."""

    slots: dict[str, int] = field(default_factory=dict)
    elements: dict[str, RosFrame] = field(default_factory=dict)
    size: int = 0

    def new(self, path: str) -> int:
        """Give a path the next slot, and return it."""
        self.slots[path] = self.size
        self.size += 1
        return self.size - 1


@dataclass
class Programs:
    """Maker of programs. It collects the expressions and the constants that they refer to."""

    messages: Mapping[str, Items[Json]]
    """Conversions of the package's messages, by the local name of the ROS message."""
    payloads: PayloadLayouts
    expressions: list[Expression] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)

    # --- payload to CDR: messages of the package ---

    def to_cdr(self, message: type[Message], descriptor: Descriptor, base: int = 0) -> list[Op]:
        """Return the operations that write a message of the package from the frame of its payload."""
        fields = fields_of(message)
        if not fields:
            return [self._constant(b"\0", "uint8")]
        conversions = self._conversions(message)
        return [op for one in fields for op in self._write(one, conversions[one.name], message, descriptor, base)]

    def _conversions(self, message: type[Message]) -> Mapping[str, Json]:
        name = message.__msgtype__.rpartition("/")[2]
        if name not in self.messages:
            raise UnsupportedError(f"{message.__msgtype__} is for a google.protobuf.Any")
        return {one["ros"]: one for one in self.messages[name]}

    def _write(self, ros: Field, one: Json, message: type[Message], descriptor: Descriptor, base: int) -> list[Op]:
        kind, path = one.get("kind", "value"), one["proto"]
        if kind == "which":
            return [self._which(one, ros.type, message, descriptor, self.payloads.oneof(descriptor, path, base))]
        place = self.payloads.place(descriptor, path, base)
        if kind in ("presence", "empty"):
            return [_op(Code.PRESENCE, slot=place.slot)]
        if "entry" in one:
            return self._write_map(ros.type, one["entry"], place)
        if one.get("repeated"):
            return self._write_list(ros.type, one, place)
        return self._write_value(ros.type, one, place)

    def _write_map(self, type: FieldType, entry: Json, place: Place) -> list[Op]:
        inner, map_entry = _message_class(self._element(type)), message_in(place.field)
        body: list[Op] = []
        for ros, name in zip(fields_of(inner), ("key", "value")):
            body += self._write_value(ros.type, entry[name], self.payloads.place(map_entry, name))
        key = self.payloads.place(map_entry, "key")
        flags = _key_flags(key.field) | Flag.FRAMES
        bound = type.bound if isinstance(type, Sequence) and type.bound is not None else NONE
        return _body(
            _op(Code.MAP, slot=place.slot, a=bound, b=key.slot, flags=flags, number=self.payloads.slots(map_entry)),
            body,
        )

    def _write_value(self, type: FieldType, one: Json, place: Place) -> list[Op]:
        kind = one.get("kind", "value")
        if "wrapping" in one:
            place = self.payloads.place(message_in(place.field), one["wrapping"], place.slot + 1)
            one = {key: value for key, value in one.items() if key != "wrapping"}
            if place.field.is_repeated:
                return self._write_list(type, one, place)
        if kind == "held":
            (inner_field,) = fields_of(_message_class(type))
            return self._write_plain(inner_field.type, place)
        if kind == "message":
            return self.to_cdr(_message_class(type), message_in(place.field), place.slot + 1)
        if kind == "well_known":
            return [
                _op(self._time(one), slot=self.payloads.place(message_in(place.field), "seconds", place.slot + 1).slot)
            ]
        if kind == "json":
            raise UnsupportedError(f"{place.field.full_name} becomes JSON text")
        return self._write_plain(type, place)

    def _write_plain(self, type: FieldType, place: Place) -> list[Op]:
        if isinstance(type, Text):
            return [_op(Code.TEXT, slot=place.slot, a=NONE if type.bound is None else type.bound, b=NONE)]
        if isinstance(type, (Sequence, Array)):
            if place.field.type != FieldDescriptor.TYPE_BYTES or type.element != UINT8:
                raise UnsupportedError(f"{place.field.full_name} is a list in a list")
            return [self._octets(type, place.slot)]
        primitive = _primitive(type)
        if _ROS_TYPE.get(place.field.type) == primitive.name:
            return [_op(Code.COPY, slot=place.slot, type=_type(primitive))]
        if place.field.type == FieldDescriptor.TYPE_ENUM:
            return [_op(Code.NARROW, slot=place.slot, type=_type(primitive))]
        raise UnsupportedError(f"{place.field.full_name} becomes {primitive.name}")

    def _which(self, one: Json, type: FieldType, message: type[Message], descriptor: Descriptor, slot: int) -> Op:
        cases = self._member_cases(one, message, descriptor)
        return _op(Code.WHICH, slot=slot, type=_type(_primitive(type)), a=self._words([len(cases) // 2, *cases]))

    def _member_cases(self, one: Json, message: type[Message], descriptor: Descriptor) -> list[int]:
        *holders, _ = one["proto"].split(".")
        holder = message_in(_field_at(descriptor, ".".join(holders))) if holders else descriptor
        cases: list[int] = []
        for member, constant in one["choices"].items():
            cases += [holder.fields_by_name[member].number, getattr(message, constant)]
        return cases

    @staticmethod
    def _time(one: Json) -> Code:
        return {"timestamp": Code.TIME, "duration": Code.DURATION}[one["converter"]]

    @staticmethod
    def _element(type: FieldType) -> FieldType:
        if not isinstance(type, (Sequence, Array)):
            raise UnsupportedError(f"a list becomes {cdr.type_name(type)}")
        return type.element

    @staticmethod
    def _list(type: FieldType, slot: int) -> Op:
        if isinstance(type, Array):
            return _op(Code.LIST, slot=slot, b=type.length, number=1, flags=Flag.ARRAY)
        if not isinstance(type, Sequence):
            raise UnsupportedError(f"a list becomes {cdr.type_name(type)}")
        return _op(Code.LIST, slot=slot, a=NONE if type.bound is None else type.bound, number=1)

    def _write_list(self, type: FieldType, one: Json, place: Place) -> list[Op]:
        """Return the operations that write a repeated field; elements are frames: of one slot, or of a message."""
        head = self._list(type, place.slot)
        if place.field.message_type is not None:
            head.flags |= Flag.FRAMES
            head.number = self.payloads.slots(message_in(place.field))
            return _body(head, self._write_value(self._element(type), one, Place(place.field, -1)))
        return _body(head, self._write_value(self._element(type), one, Place(place.field, 0)))

    def _words(self, words: list[int]) -> int:
        self.payloads.words += [word % 2**64 for word in words]
        return len(self.payloads.words) - len(words)

    def _constant(self, data: bytes, aligned_to: str) -> Op:
        start, size = self.payloads.text(data)
        return _op(Code.BYTES, a=start, b=size, type=_PRIMITIVES.index(aligned_to))

    # --- payload to CDR: standard messages ---

    def standard_to_cdr(self, message: type[Message], fields: Items[Json], descriptor: Descriptor) -> list[Op]:
        """Return the operations that write a standard message from the frame of a payload."""
        if not fields_of(message):
            return [self._constant(b"\0", "uint8")]
        filled = {one["ros"]: one for one in fields}
        ops: list[Op] = []
        for ros in fields_of(message):
            one = filled.get(ros.name)
            if one is None:
                ops += self._fixed(ros.type, default_of(ros.type)())
            elif "parts" in one:
                ops += self.standard_to_cdr(_message_class(ros.type), one["parts"], descriptor)
            else:
                ops += self._filled(ros.type, one, descriptor)
        return ops

    def _fixed(self, type: FieldType, value: Any) -> list[Op]:
        """Return the operations that write a constant value."""
        if isinstance(type, Primitive):
            return [self._constant(struct.pack(f"<{type.format}", value), _PRIMITIVES[_type(type)])]
        if isinstance(type, Text):
            data = value.encode()
            return [self._constant(struct.pack("<I", len(data) + 1) + data + b"\0", "uint32")]
        if isinstance(type, (Sequence, Array)):
            count = [] if isinstance(type, Array) else [self._constant(struct.pack("<I", len(value)), "uint32")]
            if isinstance(type.element, Primitive):
                packed = struct.pack(f"<{len(value)}{type.element.format}", *value)
                return [*count, self._constant(packed, _PRIMITIVES[_type(type.element)])]
            return [*count, *(op for item in value for op in self._fixed(type.element, item))]
        fields = fields_of(type)
        if not fields:
            return [self._constant(b"\0", "uint8")]
        return [op for one in fields for op in self._fixed(one.type, getattr(value, one.name))]

    def _filled(self, type: FieldType, one: Json, descriptor: Descriptor) -> list[Op]:
        if "constant" in one:
            return self._fixed(type, one["constant"])
        if "rotation" in one:
            numbers = [self._number(part, descriptor) for part in one["rotation"]]
            first = len(self.expressions)
            self.expressions += numbers
            return [_op(Code.QUATERNION, a=first)]
        if "moment" in one:
            if not one["moment"]:
                return [_op(Code.STAMP)]
            return [_op(Code.MOMENT, a=self._expression(self._number(one["moment"], descriptor)))]
        place = self.payloads.place(descriptor, one["from"])
        if place.field.is_repeated:
            inner = _primitive(self._element(type))
            item = self._number(one, descriptor, Place(place.field, 0))
            return _body(
                self._list(type, place.slot),
                [_op(Code.COMPUTE, type=_type(inner), a=self._expression(item))],
            )
        if isinstance(type, Primitive) and (one.keys() - {"ros", "from"} or _ROS_TYPE[place.field.type] != type.name):
            return [_op(Code.COMPUTE, type=_type(type), a=self._expression(self._number(one, descriptor, place)))]
        otherwise = self._words([*self.payloads.text(one["otherwise"])]) if "otherwise" in one else NONE
        if "cases" in one:
            return [_op(Code.CHOICE, slot=place.slot, a=self._cases(one["cases"]), b=otherwise)]
        (op,) = self._write_plain(type, place)
        if otherwise != NONE:
            if op.code != Code.TEXT:
                raise UnsupportedError(f"{place.field.full_name} has a default")
            op.b = otherwise
        return [op]

    def _cases(self, cases: Items[tuple[int, str]]) -> int:
        """Keep cases of numbers and texts, and return their index."""
        return self._words(
            [len(cases), *(word for number, text in cases for word in (number, *self.payloads.text(text)))]
        )

    def _expression(self, expression: Expression) -> int:
        self.expressions.append(expression)
        return len(self.expressions) - 1

    def _number(self, one: Json, descriptor: Descriptor, place: Place | None = None) -> Expression:
        """Return the expression for a number of the payload, or for a constant."""
        if "constant" in one:
            return self._made({"otherwise": one["constant"]}, NONE, Number.DOUBLE)
        place = place or self.payloads.place(descriptor, one["from"])
        ros = _ROS_TYPE.get(place.field.type)
        if ros is None:
            raise UnsupportedError(f"{place.field.full_name} is no number")
        source = _SOURCES.get(ros, Number.UNSIGNED if ros[0] in "ub" else Number.SIGNED)
        return self._made(
            one, place.slot, source, presence=place.slot if "otherwise" in one and "cases" not in one else NONE
        )

    def _made(self, one: Json, slot: int, source: Number, presence: int = NONE) -> Expression:
        first = len(self.steps)
        for operator, value in one.get("steps", ()):
            whole = isinstance(value, int)
            self.steps.append(Step(_STEPS[operator], whole, 0.0 if whole else value, value if whole else 0))
        flags = ExpressionFlag.ROUND * one.get("round", False) | ExpressionFlag.CHECK_SINGLE * one.get("single", False)
        cases = NONE
        if "cases" in one:
            listed = [word for key, value in one["cases"] for word in (key, *_value(value))]
            cases = self._words([len(one["cases"]), *listed])
        otherwise = self._words(list(_value(one["otherwise"]))) if "otherwise" in one else NONE
        return Expression(source, flags, len(self.steps) - first, slot, presence, first, cases, otherwise)

    # --- CDR to a frame ---

    def from_cdr(self, type: FieldType, frame: RosFrame, path: str, descriptor: Descriptor | None = None) -> list[Op]:
        """Return the operations that read a ROS value into a frame, which gets slots for the value's leaves.

        ``descriptor`` is the proto message if the value is a message of the package.
        """
        if isinstance(type, Primitive):
            return [_op(Code.COPY, slot=frame.new(path), type=_type(type))]
        if isinstance(type, Text):
            return [_op(Code.TEXT, slot=frame.new(path), b=NONE)]
        if isinstance(type, (Sequence, Array)):
            if type.element == UINT8:
                return [self._octets(type, frame.new(path))]
            return self._read_list(type, frame, path, descriptor)
        fields = fields_of(type)
        if not fields:
            return [_op(Code.COPY, slot=frame.new(_joined(path, "structure_needs_at_least_one_member")), type=2)]
        if descriptor is None:
            return [op for one in fields for op in self.from_cdr(one.type, frame, _joined(path, one.name))]
        conversions = self._conversions(type)
        return [
            op
            for one in fields
            for op in self._read(one, conversions[one.name], type, descriptor, frame, _joined(path, one.name))
        ]

    def _read(
        self, ros: Field, one: Json, message: type[Message], descriptor: Descriptor, frame: RosFrame, path: str
    ) -> list[Op]:
        """Return the operations that read a field of a message of the package."""
        if one.get("kind") == "which":
            return [self._which(one, ros.type, message, descriptor, frame.new(path))]
        if one.get("kind") in ("presence", "empty"):
            return self.from_cdr(ros.type, frame, path)
        proto = _field_at(descriptor, one["proto"])
        if "wrapping" in one:
            proto = message_in(proto).fields_by_name[one["wrapping"]]
        if "entry" in one:
            return self._read_map(ros.type, one["entry"], message_in(proto), frame, path)
        if isinstance(ros.type, (Sequence, Array)) and proto.type != FieldDescriptor.TYPE_BYTES:
            return self._read_list(ros.type, frame, path, proto.message_type if one.get("kind") == "message" else None)
        return self.from_cdr(ros.type, frame, path, proto.message_type if one.get("kind") == "message" else None)

    def _read_list(self, type: FieldType, frame: RosFrame, path: str, descriptor: Descriptor | None) -> list[Op]:
        head = self._list(type, frame.new(path))
        element = frame.elements[path] = RosFrame()
        body = self.from_cdr(self._element(type), element, "", descriptor)
        head.number = element.size
        return _body(head, body)

    def _read_map(self, type: FieldType, entry: Json, map_entry: Descriptor, frame: RosFrame, path: str) -> list[Op]:
        head, inner = self._list(type, frame.new(path)), _message_class(self._element(type))
        element = frame.elements[path] = RosFrame()
        body: list[Op] = []
        for ros, name in zip(fields_of(inner), ("key", "value")):
            body += self._read(ros, {**entry[name], "proto": name}, inner, map_entry, element, ros.name)
        head.number = element.size
        return _body(head, body)

    def _octets(self, type: FieldType, slot: int) -> Op:
        head = self._list(type, slot)
        head.code = Code.OCTETS
        return head

    # --- frame to payload: messages of the package ---

    def to_proto(self, message: type[Message], descriptor: Descriptor, frame: RosFrame, path: str) -> list[Op]:
        """Return the operations that write the fields of a payload, in the order of falling numbers."""
        conversions = [self._conversions(message)[ros.name] for ros in fields_of(message)]
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
        own = _joined(path, one["ros"])
        condition, expected = NONE, 0
        if "which" in one:
            which = whiches[one["which"]]
            condition, expected = frame.slots[_joined(path, which["ros"])], getattr(
                message, which["choices"][proto.name]
            )
        elif "presence" in one:
            condition, expected = frame.slots[_joined(path, one["presence"])], 1
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
                proto, frame.slots[own], element, self._back(self._element(type), one, proto, element, "")
            )
        else:
            ops = self._back(type, one, proto, frame, own)
        if condition != NONE:
            ops[0].condition, ops[0].expected = condition, expected
        return ops

    @staticmethod
    def _elements(proto: FieldDescriptor, slot: int, element: RosFrame, body: list[Op]) -> list[Op]:
        if not proto.is_packed:
            return _body(_op(Code.REPEAT, slot=slot, b=element.size), body)
        body[0].number = 0
        return _body(_op(Code.PACKED, slot=slot, b=element.size, number=proto.number), body)

    def _map_back(self, type: FieldType, entry: Json, proto: FieldDescriptor, frame: RosFrame, path: str) -> list[Op]:
        inner, element, map_entry = _message_class(self._element(type)), frame.elements[path], message_in(proto)
        body: list[Op] = []
        for ros, name in reversed(list(zip(fields_of(inner), ("key", "value")))):
            part = self._back(ros.type, entry[name], map_entry.fields_by_name[name], element, ros.name)
            part[0].flags &= ~Flag.IMPLICIT  # an entry always contains both
            body += part
        flags = Flag.UNIQUE | _key_flags(map_entry.fields_by_name["key"])
        key = element.slots[fields_of(inner)[0].name]
        head = _op(Code.REPEAT, slot=frame.slots[path], a=key, b=element.size, flags=flags)
        return _body(head, _message(proto, body))

    def _back(self, type: FieldType, one: Json, proto: FieldDescriptor, frame: RosFrame, path: str) -> list[Op]:
        """Return the operations that write one value of a proto field: a whole field, or an element of a list."""
        if "wrapping" in one:
            inner = message_in(proto).fields_by_name[one["wrapping"]]
            rest = {key: value for key, value in one.items() if key != "wrapping"}
            if inner.is_repeated:
                element = frame.elements[path]
                body = self._back(self._element(type), rest, inner, element, "")
                return _message(proto, self._elements(inner, frame.slots[path], element, body))
            return _message(proto, self._back(type, rest, inner, frame, path))
        kind = one.get("kind", "value")
        if kind == "held":
            (inner_field,) = fields_of(_message_class(type))
            return [self._field(inner_field.type, proto, frame.slots[_joined(path, inner_field.name)])]
        if kind == "message":
            body = self.to_proto(_message_class(type), message_in(proto), frame, path)
            return _message(proto, body)
        if kind == "well_known":
            return [_op(self._time(one), slot=frame.slots[_joined(path, "sec")], number=proto.number)]
        if kind == "json":
            raise UnsupportedError(f"{proto.full_name} becomes JSON text")
        return [self._field(type, proto, frame.slots[path])]

    def _field(self, type: FieldType, proto: FieldDescriptor, slot: int) -> Op:
        op = self._plain_field(Code.FIELD, proto, slot)
        if isinstance(type, Primitive) and _ROS_TYPE[proto.type] != type.name:
            op.a = self._expression(self._made({}, slot, _source(type)))
        return op

    def _plain_field(self, code: Code, proto: FieldDescriptor, slot: int, a: int = NONE) -> Op:
        """Return the operation that writes a field; a closed enum has the values that it declares, and no other."""
        flags = 0 if proto.has_presence or proto.is_repeated else Flag.IMPLICIT
        values = NONE
        if proto.enum_type is not None and proto.enum_type.is_closed:
            values = self.payloads.enum(proto.enum_type)
        return _op(code, slot=slot, number=proto.number, type=proto.type, flags=flags, a=a, b=values)

    # --- frame to payload: standard messages ---

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
                reading.append(_op(Code.ANGLES, slot=first, a=frame.slots[_joined(one["ros"], "x")]))
                for axis, part in enumerate(one["rotation"]):
                    if part is not None:
                        add(part, self._computed(part, first + axis, Number.DOUBLE))
            elif "moment" in one:
                slot = frame.slots[_joined(one["ros"], "sec")]
                add(one["moment"], self._computed(one["moment"], slot, Number.NANOSECONDS))
            else:
                add(one, self._taken_back(one, types[one["ros"]], frame))
        if len(oneofs) > 1:
            raise UnsupportedError(f"{', '.join(sorted(oneofs))} are several members of oneofs")
        return reading, self._fields(tree, descriptor)

    def _taken_back(self, one: Json, type: FieldType, frame: RosFrame) -> Callable[[FieldDescriptor], list[Op]]:
        slot, element = frame.slots[one["ros"]], frame.elements.get(one["ros"])
        if element is not None:
            write = self._computed(one, 0, _source(_primitive(self._element(type))))
            return lambda proto: self._elements(proto, slot, element, write(proto))
        if isinstance(type, Primitive):
            return self._computed(one, slot, _source(type))
        if "cases" in one:
            cases = self._cases([(number, text) for text, number in one["cases"]])
            return lambda proto: [self._plain_field(Code.CASE, proto, slot, cases)]
        return lambda proto: [self._field(type, proto, slot)]

    def _computed(self, one: Json, slot: int, source: Number) -> Callable[[FieldDescriptor], list[Op]]:
        def write(proto: FieldDescriptor) -> list[Op]:
            expression = self._expression(self._made(one, slot, source))
            return [self._plain_field(Code.FIELD, proto, slot, expression)]

        return write


builtin_type = type


def _message_class(type: FieldType) -> type[Message]:
    if not isinstance(type, builtin_type):
        raise UnsupportedError(f"a message becomes {cdr.type_name(type)}")
    return type


def _primitive(type: FieldType) -> Primitive:
    if not isinstance(type, Primitive):
        raise UnsupportedError(f"a number becomes {cdr.type_name(type)}")
    return type


def _value(value: Any) -> tuple[int, int]:
    """Return a constant as two words: 1 and an integer, or 0 and the bits of a double."""
    if isinstance(value, (bool, int)):
        return 1, int(value)
    if isinstance(value, float):
        return 0, int(struct.unpack("<Q", struct.pack("<d", value))[0])
    raise UnsupportedError(f"{value!r} is no number")


def _source(primitive: Primitive) -> Number:
    if primitive.name in _SOURCES:
        return _SOURCES[primitive.name]
    return Number.SIGNED if primitive.name.startswith("int") else Number.UNSIGNED


def _key_flags(key: FieldDescriptor) -> int:
    if key.type == FieldDescriptor.TYPE_STRING:
        return Flag.TEXT_KEY
    return Flag.SIGNED_KEY if _ROS_TYPE[key.type].startswith("int") else 0


def _field_at(descriptor: Descriptor, path: str) -> FieldDescriptor:
    """Return the field at a dotted path in a message."""
    name, _, rest = path.partition(".")
    proto = descriptor.fields_by_name[name]
    return _field_at(message_in(proto), rest) if rest else proto


def _message(proto: FieldDescriptor, body: Items[Op]) -> list[Op]:
    """Return the operations that write a message, with those that write its fields."""
    return _body(_op(Code.MESSAGE, number=proto.number, type=proto.type), body)


def _joined(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _leaf_types(message: type[Message], path: str = "") -> list[tuple[str, FieldType]]:
    found: list[tuple[str, FieldType]] = []
    for one in fields_of(message):
        own = _joined(path, one.name)
        found.append((own, one.type))
        if isinstance(one.type, builtin_type):
            found += _leaf_types(one.type, own)
    return found
