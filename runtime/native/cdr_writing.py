"""Programs that write a serialized ROS 2 message from the frame of a payload."""

from __future__ import annotations

import struct
from collections.abc import Sequence as Items
from dataclasses import dataclass
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor

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
from roverlink.runtime.core.protobuf_versions import is_repeated
from roverlink.runtime.native.layout import NONE, Code, Flag, Op
from roverlink.runtime.native.operations import (
    PRIMITIVES,
    ROS_TYPE,
    Json,
    element_of,
    key_flags,
    list_op,
    message_class,
    octets_op,
    op,
    primitive_of,
    time_code,
    type_code,
    with_body,
)
from roverlink.runtime.native.payload_layouts import Place, UnsupportedError, message_in
from roverlink.runtime.native.table_parts import TableParts


@dataclass(frozen=True)
class CdrWriting:
    """Maker of the programs."""

    parts: TableParts

    # --- messages of the package ---

    def to_cdr(self, message: type[Message], descriptor: Descriptor, base: int = 0) -> list[Op]:
        """Return the operations that write a message of the package from the frame of its payload."""
        fields = fields_of(message)
        if not fields:
            return [self.parts.constant(b"\0", "uint8")]
        conversions = self.parts.conversions(message)
        return [made for one in fields for made in self._write(one, conversions[one.name], message, descriptor, base)]

    def _write(self, ros: Field, one: Json, message: type[Message], descriptor: Descriptor, base: int) -> list[Op]:
        kind, path = one.get("kind", "value"), one["proto"]
        if kind == "which":
            slot = self.parts.payloads.oneof(descriptor, path, base)
            return [self.parts.which(one, ros.type, message, descriptor, slot)]
        place = self.parts.payloads.place(descriptor, path, base)
        if kind in ("presence", "empty"):
            return [op(Code.PRESENCE, slot=place.slot)]
        if "entry" in one:
            return self._write_map(ros.type, one["entry"], place)
        if one.get("repeated"):
            return self._write_list(ros.type, one, place)
        return self._write_value(ros.type, one, place)

    def _write_map(self, type: FieldType, entry: Json, place: Place) -> list[Op]:
        inner, map_entry = message_class(element_of(type)), message_in(place.field)
        body: list[Op] = []
        for ros, name in zip(fields_of(inner), ("key", "value")):
            body += self._write_value(ros.type, entry[name], self.parts.payloads.place(map_entry, name))
        key = self.parts.payloads.place(map_entry, "key")
        flags = key_flags(key.field) | Flag.FRAMES
        bound = type.bound if isinstance(type, Sequence) and type.bound is not None else NONE
        slots = self.parts.payloads.slots(map_entry)
        return with_body(op(Code.MAP, slot=place.slot, a=bound, b=key.slot, flags=flags, number=slots), body)

    def _write_value(self, type: FieldType, one: Json, place: Place) -> list[Op]:
        kind = one.get("kind", "value")
        if "wrapping" in one:
            place = self.parts.payloads.place(message_in(place.field), one["wrapping"], place.slot + 1)
            one = {key: value for key, value in one.items() if key != "wrapping"}
            if is_repeated(place.field):
                return self._write_list(type, one, place)
        if kind == "held":
            (inner_field,) = fields_of(message_class(type))
            return self._write_plain(inner_field.type, place)
        if kind == "message":
            return self.to_cdr(message_class(type), message_in(place.field), place.slot + 1)
        if kind == "well_known":
            seconds = self.parts.payloads.place(message_in(place.field), "seconds", place.slot + 1)
            return [op(time_code(one), slot=seconds.slot)]
        if kind == "json":
            raise UnsupportedError(f"{place.field.full_name} becomes JSON text")
        return self._write_plain(type, place)

    def _write_plain(self, type: FieldType, place: Place) -> list[Op]:
        if isinstance(type, Text):
            return [op(Code.TEXT, slot=place.slot, a=NONE if type.bound is None else type.bound, b=NONE)]
        if isinstance(type, (Sequence, Array)):
            if place.field.type != FieldDescriptor.TYPE_BYTES or type.element != UINT8:
                raise UnsupportedError(f"{place.field.full_name} is a list in a list")
            return [octets_op(type, place.slot)]
        primitive = primitive_of(type)
        if ROS_TYPE.get(place.field.type) == primitive.name:
            return [op(Code.COPY, slot=place.slot, type=type_code(primitive))]
        if place.field.type == FieldDescriptor.TYPE_ENUM:
            return [op(Code.NARROW, slot=place.slot, type=type_code(primitive))]
        raise UnsupportedError(f"{place.field.full_name} becomes {primitive.name}")

    def _write_list(self, type: FieldType, one: Json, place: Place) -> list[Op]:
        """Return the operations that write a repeated field; elements are frames: of one slot, or of a message."""
        head = list_op(type, place.slot)
        if place.field.message_type is not None:
            head.flags |= Flag.FRAMES
            head.number = self.parts.payloads.slots(message_in(place.field))
            return with_body(head, self._write_value(element_of(type), one, Place(place.field, -1)))
        return with_body(head, self._write_value(element_of(type), one, Place(place.field, 0)))

    # --- standard messages ---

    def standard_to_cdr(self, message: type[Message], fields: Items[Json], descriptor: Descriptor) -> list[Op]:
        """Return the operations that write a standard message from the frame of a payload."""
        if not fields_of(message):
            return [self.parts.constant(b"\0", "uint8")]
        filled = {one["ros"]: one for one in fields}
        ops: list[Op] = []
        for ros in fields_of(message):
            one = filled.get(ros.name)
            if one is None:
                ops += self._fixed(ros.type, default_of(ros.type)())
            elif "parts" in one:
                ops += self.standard_to_cdr(message_class(ros.type), one["parts"], descriptor)
            else:
                ops += self._filled(ros.type, one, descriptor)
        return ops

    def _fixed(self, type: FieldType, value: Any) -> list[Op]:
        """Return the operations that write a constant value."""
        if isinstance(type, Primitive):
            return [self.parts.constant(struct.pack(f"<{type.format}", value), PRIMITIVES[type_code(type)])]
        if isinstance(type, Text):
            data = value.encode()
            return [self.parts.constant(struct.pack("<I", len(data) + 1) + data + b"\0", "uint32")]
        if isinstance(type, (Sequence, Array)):
            count = [] if isinstance(type, Array) else [self.parts.constant(struct.pack("<I", len(value)), "uint32")]
            if isinstance(type.element, Primitive):
                packed = struct.pack(f"<{len(value)}{type.element.format}", *value)
                return [*count, self.parts.constant(packed, PRIMITIVES[type_code(type.element)])]
            return [*count, *(made for item in value for made in self._fixed(type.element, item))]
        fields = fields_of(type)
        if not fields:
            return [self.parts.constant(b"\0", "uint8")]
        return [made for one in fields for made in self._fixed(one.type, getattr(value, one.name))]

    def _filled(self, type: FieldType, one: Json, descriptor: Descriptor) -> list[Op]:
        if "constant" in one:
            return self._fixed(type, one["constant"])
        if "rotation" in one:
            numbers = [self.parts.number(part, descriptor) for part in one["rotation"]]
            first = len(self.parts.expressions)
            self.parts.expressions += numbers
            return [op(Code.QUATERNION, a=first)]
        if "moment" in one:
            if not one["moment"] or "counter" in one["moment"]:
                return [op(Code.STAMP)]
            return [op(Code.MOMENT, a=self.parts.expression(self.parts.number(one["moment"], descriptor)))]
        place = self.parts.payloads.place(descriptor, one["from"])
        if is_repeated(place.field):
            inner = primitive_of(element_of(type))
            item = self.parts.number(one, descriptor, Place(place.field, 0))
            return with_body(
                list_op(type, place.slot),
                [op(Code.COMPUTE, type=type_code(inner), a=self.parts.expression(item))],
            )
        if isinstance(type, Primitive) and (one.keys() - {"ros", "from"} or ROS_TYPE[place.field.type] != type.name):
            number = self.parts.expression(self.parts.number(one, descriptor, place))
            return [op(Code.COMPUTE, type=type_code(type), a=number)]
        otherwise = self.parts.words([*self.parts.payloads.text(one["otherwise"])]) if "otherwise" in one else NONE
        if "cases" in one:
            return [op(Code.CHOICE, slot=place.slot, a=self.parts.cases(one["cases"]), b=otherwise)]
        (written,) = self._write_plain(type, place)
        if otherwise != NONE:
            if written.code != Code.TEXT:
                raise UnsupportedError(f"{place.field.full_name} has a default")
            written.b = otherwise
        return [written]
