"""Programs that read a serialized ROS 2 message into a frame."""

from __future__ import annotations

from dataclasses import dataclass, field

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
    fields_of,
)
from roverlink.runtime.native.layout import NONE, Code, Op
from roverlink.runtime.native.operations import (
    Json,
    element_of,
    field_at,
    joined,
    list_op,
    message_class,
    octets_op,
    op,
    type_code,
    with_body,
)
from roverlink.runtime.native.payload_layouts import message_in
from roverlink.runtime.native.table_parts import TableParts


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


@dataclass(frozen=True)
class CdrReading:
    """Maker of the programs."""

    parts: TableParts

    def from_cdr(self, type: FieldType, frame: RosFrame, path: str, descriptor: Descriptor | None = None) -> list[Op]:
        """Return the operations that read a ROS value into a frame, which gets slots for the value's leaves.

        ``descriptor`` is the proto message if the value is a message of the package.
        """
        if isinstance(type, Primitive):
            return [op(Code.COPY, slot=frame.new(path), type=type_code(type))]
        if isinstance(type, Text):
            return [op(Code.TEXT, slot=frame.new(path), b=NONE)]
        if isinstance(type, (Sequence, Array)):
            if type.element == UINT8:
                return [octets_op(type, frame.new(path))]
            return self._read_list(type, frame, path, descriptor)
        fields = fields_of(type)
        if not fields:
            return [op(Code.COPY, slot=frame.new(joined(path, "structure_needs_at_least_one_member")), type=2)]
        if descriptor is None:
            return [made for one in fields for made in self.from_cdr(one.type, frame, joined(path, one.name))]
        conversions = self.parts.conversions(type)
        return [
            made
            for one in fields
            for made in self._read(one, conversions[one.name], type, descriptor, frame, joined(path, one.name))
        ]

    def _read(
        self, ros: Field, one: Json, message: type[Message], descriptor: Descriptor, frame: RosFrame, path: str
    ) -> list[Op]:
        """Return the operations that read a field of a message of the package."""
        if one.get("kind") == "which":
            return [self.parts.which(one, ros.type, message, descriptor, frame.new(path))]
        if one.get("kind") in ("presence", "empty"):
            return self.from_cdr(ros.type, frame, path)
        proto = field_at(descriptor, one["proto"])
        if "wrapping" in one:
            proto = message_in(proto).fields_by_name[one["wrapping"]]
        if "entry" in one:
            return self._read_map(ros.type, one["entry"], message_in(proto), frame, path)
        if isinstance(ros.type, (Sequence, Array)) and proto.type != FieldDescriptor.TYPE_BYTES:
            return self._read_list(ros.type, frame, path, proto.message_type if one.get("kind") == "message" else None)
        return self.from_cdr(ros.type, frame, path, proto.message_type if one.get("kind") == "message" else None)

    def _read_list(self, type: FieldType, frame: RosFrame, path: str, descriptor: Descriptor | None) -> list[Op]:
        head = list_op(type, frame.new(path))
        element = frame.elements[path] = RosFrame()
        body = self.from_cdr(element_of(type), element, "", descriptor)
        head.number = element.size
        return with_body(head, body)

    def _read_map(self, type: FieldType, entry: Json, map_entry: Descriptor, frame: RosFrame, path: str) -> list[Op]:
        head, inner = list_op(type, frame.new(path)), message_class(element_of(type))
        element = frame.elements[path] = RosFrame()
        body: list[Op] = []
        for ros, name in zip(fields_of(inner), ("key", "value")):
            body += self._read(ros, {**entry[name], "proto": name}, inner, map_entry, element, ros.name)
        head.number = element.size
        return with_body(head, body)
