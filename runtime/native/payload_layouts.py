"""Layouts of payloads: the slot of each proto field, made from the protobuf descriptors."""

from __future__ import annotations

import struct
from collections.abc import Sequence as Items
from dataclasses import dataclass, field
from typing import Any

from google.protobuf.descriptor import Descriptor, EnumDescriptor, FieldDescriptor

from roverlink.runtime.core.protobuf_versions import is_closed, is_repeated
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
    constants: bytearray = field(default_factory=bytearray)
    _index: dict[str, int] = field(default_factory=dict)
    _slots: dict[str, dict[str, int]] = field(default_factory=dict)
    _open: dict[str, list[native.Field]] = field(default_factory=dict)
    """Messages whose layouts are being made, each with the fields inside that contain it again."""
    _opaque: set[str] = field(default_factory=set)

    def of(self, descriptor: Descriptor) -> int:
        """Return the index of the layout of a message. Raises `UnsupportedError`."""
        name = descriptor.full_name
        if name in self._index:
            return self._index[name]
        if descriptor.has_options and descriptor.GetOptions().message_set_wire_format:
            raise UnsupportedError(f"{name} has message_set_wire_format")
        before = len(self.fields), len(self.layouts), len(self.words)
        self._open[name] = []
        try:
            return self._make(descriptor)
        except UnsupportedError:  # layouts made meanwhile may contain this one
            del self.fields[before[0] :], self.layouts[before[1] :], self.words[before[2] :]
            self._index = {made: index for made, index in self._index.items() if index < before[1]}
            raise
        finally:
            del self._open[name]

    def _make(self, descriptor: Descriptor) -> int:
        name = descriptor.full_name
        slots: dict[str, int] = {oneof.name: index for index, oneof in enumerate(descriptor.oneofs)}
        defaults = [0, 0] * len(slots)
        made = []
        extensions = descriptor.file.pool.FindAllExtensions(descriptor) if descriptor.is_extendable else []
        for proto in sorted((*descriptor.fields, *extensions), key=lambda one: one.number):
            slot = len(defaults) // 2
            entry = self._field(proto, slot, slots)
            slots[f".{proto.full_name if proto.is_extension else proto.name}"] = slot
            defaults += self._default(proto)
            if entry.extent > 1:
                inner = self.layouts[entry.layout]
                defaults += self.words[inner.defaults : inner.defaults + 2 * inner.slots]
            made.append(entry)
        index = self._index[name] = len(self.layouts)
        self._slots[name] = slots
        is_entry = descriptor.GetOptions().map_entry
        self.layouts.append(native.Layout(len(self.fields), len(made), len(defaults) // 2, len(self.words), is_entry))
        self.fields += made
        self.words += defaults
        for entry in self._open[name]:
            entry.layout = index
        return index

    def _field(self, proto: FieldDescriptor, slot: int, slots: dict[str, int]) -> native.Field:
        flags = native.FieldFlag.REPEATED * is_repeated(proto)
        layout, extent = native.NONE, 1
        opaque = self._open.get(proto.message_type.full_name) if proto.message_type is not None else None
        if opaque is not None:
            flags |= native.FieldFlag.OPAQUE
        elif proto.message_type is not None:
            layout = self.of(proto.message_type)
            extent += 0 if is_repeated(proto) else self.layouts[layout].slots
        elif proto.enum_type is not None and is_closed(proto.enum_type):
            layout = self.enum(proto.enum_type)
        if proto.type == FieldDescriptor.TYPE_STRING:
            flags |= native.FieldFlag.UTF8
        oneof = slots[proto.containing_oneof.name] if proto.containing_oneof is not None else native.NONE
        made = native.Field(proto.number, proto.type, flags, 0, slot, extent, oneof, layout)
        if opaque is not None:
            self._opaque.add(proto.full_name)
            opaque.append(made)
        return made

    def _default(self, proto: FieldDescriptor) -> Items[int]:
        """Return the two words of a field's default."""
        if is_repeated(proto) or proto.message_type is not None:
            return 0, 0
        value: Any = proto.default_value
        if isinstance(value, (str, bytes)):
            return self.text(value)
        return bits_of(proto, value), 0

    def enum(self, descriptor: EnumDescriptor) -> int:
        """Keep the values of a closed enum, and return their index."""
        numbers = [value.number for value in descriptor.values]
        self.words += [len(numbers), *(number % 2**64 for number in numbers)]
        return len(self.words) - len(numbers) - 1

    def text(self, value: str | bytes) -> tuple[int, int]:
        """Keep a text, and return its two words."""
        data = value.encode() if isinstance(value, str) else value
        start = len(self.constants) if data else 0
        self.constants += data
        return start, len(data)

    def slots(self, descriptor: Descriptor) -> int:
        """Return the number of slots of a message."""
        return int(self.layouts[self.of(descriptor)].slots)

    def place(self, descriptor: Descriptor, path: str, base: int = 0) -> Place:
        """Return the field at a dotted path in a message whose first slot is ``base``."""
        self.of(descriptor)
        name, _, rest = path.partition(".")
        proto = descriptor.fields_by_name[name]
        if proto.full_name in self._opaque:
            raise UnsupportedError(f"{descriptor.full_name} contains itself in its field {name}")
        slot = base + self._slots[descriptor.full_name][f".{name}"]
        return self.place(message_in(proto), rest, slot + 1) if rest else Place(proto, slot)

    def oneof(self, descriptor: Descriptor, path: str, base: int = 0) -> int:
        """Return the slot of the oneof at a dotted path."""
        *holders, name = path.split(".")
        if holders:
            holder = self.place(descriptor, ".".join(holders), base)
            descriptor, base = message_in(holder.field), holder.slot + 1
        self.of(descriptor)
        return base + self._slots[descriptor.full_name][name]


def message_in(proto: FieldDescriptor) -> Descriptor:
    """Return the message of a field that holds one. Raises `UnsupportedError`."""
    if proto.message_type is None:
        raise UnsupportedError(f"{proto.full_name} is no message")
    return proto.message_type


def bits_of(proto: FieldDescriptor, value: Any) -> int:
    """Return the bits of a number in a slot."""
    if proto.type == FieldDescriptor.TYPE_DOUBLE:
        return int(struct.unpack("<Q", struct.pack("<d", value))[0])
    if proto.type == FieldDescriptor.TYPE_FLOAT:
        return int(struct.unpack("<I", struct.pack("<f", value))[0])
    return int(value) % 2**64
