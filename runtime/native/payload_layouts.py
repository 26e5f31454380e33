"""Layouts of payloads: the slot of each proto field, made from the protobuf descriptors."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor

from roverlink.runtime.native import layout as native


class UnsupportedError(Exception):
    """Reason why Python converts a message, and not the native core."""


@dataclass(slots=True)
class Place:
    """Proto field with its slot in a frame."""

    field: FieldDescriptor
    slot: int


@dataclass
class PayloadLayouts:
    """Layouts of all messages that occur in payloads, and the arrays that they refer to."""

    fields: list[native.Field] = field(default_factory=list)
    layouts: list[native.Layout] = field(default_factory=list)
    words: list[int] = field(default_factory=list)
    _index: dict[str, int] = field(default_factory=dict)
    _slots: dict[str, dict[str, int]] = field(default_factory=dict)
    _open: list[str] = field(default_factory=list)

    def of(self, descriptor: Descriptor) -> int:
        """Return the index of the layout of a message. Raises `UnsupportedError`."""
        name = descriptor.full_name
        if name in self._index:
            return self._index[name]
        if name in self._open:
            raise UnsupportedError(f"{name} contains itself")
        if descriptor.is_extendable:
            raise UnsupportedError(f"{name} can be extended")
        self._open.append(name)
        try:
            return self._make(descriptor)
        finally:
            self._open.pop()

    def _make(self, descriptor: Descriptor) -> int:
        name = descriptor.full_name
        slots: dict[str, int] = {oneof.name: index for index, oneof in enumerate(descriptor.oneofs)}
        defaults = [0, 0] * len(slots)
        made = []
        for proto in sorted(descriptor.fields, key=lambda one: one.number):
            slot = len(defaults) // 2
            entry = self._field(proto, slot, slots)
            slots[f".{proto.name}"] = slot
            defaults += [_default(proto), 0]
            if entry.extent > 1:
                inner = self.layouts[entry.layout]
                defaults += self.words[inner.defaults : inner.defaults + 2 * inner.slots]
            made.append(entry)
        index = self._index[name] = len(self.layouts)
        self._slots[name] = slots
        self.layouts.append(native.Layout(len(self.fields), len(made), len(defaults) // 2, len(self.words)))
        self.fields += made
        self.words += defaults
        return index

    def _field(self, proto: FieldDescriptor, slot: int, slots: dict[str, int]) -> native.Field:
        if proto.type == FieldDescriptor.TYPE_GROUP:
            raise UnsupportedError(f"{proto.full_name} is a group")
        flags = native.FieldFlag.REPEATED * proto.is_repeated | native.FieldFlag.REQUIRED * proto.is_required
        layout, extent = native.NONE, 1
        if proto.message_type is not None:
            layout = self.of(proto.message_type)
            extent += 0 if proto.is_repeated else self.layouts[layout].slots
        elif proto.enum_type is not None and proto.enum_type.is_closed:
            layout = len(self.words)
            numbers = [value.number for value in proto.enum_type.values]
            self.words += [len(numbers), *(number % 2**64 for number in numbers)]
        if proto.type == FieldDescriptor.TYPE_STRING:
            flags |= native.FieldFlag.UTF8
        oneof = slots[proto.containing_oneof.name] if proto.containing_oneof is not None else native.NONE
        return native.Field(proto.number, proto.type, flags, 0, slot, extent, oneof, layout)

    def slots(self, descriptor: Descriptor) -> int:
        """Return the number of slots of a message."""
        return int(self.layouts[self.of(descriptor)].slots)

    def place(self, descriptor: Descriptor, path: str, base: int = 0) -> Place:
        """Return the field at a dotted path in a message whose first slot is ``base``."""
        self.of(descriptor)
        name, _, rest = path.partition(".")
        proto = descriptor.fields_by_name[name]
        slot = base + self._slots[descriptor.full_name][f".{name}"]
        return self.place(proto.message_type, rest, slot + 1) if rest else Place(proto, slot)

    def oneof(self, descriptor: Descriptor, path: str, base: int = 0) -> int:
        """Return the slot of the oneof at a dotted path."""
        *holders, name = path.split(".")
        if holders:
            holder = self.place(descriptor, ".".join(holders), base)
            descriptor, base = holder.field.message_type, holder.slot + 1
        self.of(descriptor)
        return base + self._slots[descriptor.full_name][name]


def _default(proto: FieldDescriptor) -> int:
    """Return the bits of a field's default. Raises `UnsupportedError` for a text that is not empty."""
    if proto.is_repeated or proto.message_type is not None:
        return 0
    value: Any = proto.default_value
    if isinstance(value, (str, bytes)):
        if value:
            raise UnsupportedError(f"{proto.full_name} has a text as default")
        return 0
    return bits_of(proto, value)


def bits_of(proto: FieldDescriptor, value: Any) -> int:
    """Return the bits of a number in a slot."""
    if proto.type == FieldDescriptor.TYPE_DOUBLE:
        return int(struct.unpack("<Q", struct.pack("<d", value))[0])
    if proto.type == FieldDescriptor.TYPE_FLOAT:
        return int(struct.unpack("<I", struct.pack("<f", value))[0])
    return int(value) % 2**64
