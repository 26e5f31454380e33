"""What .proto files declare once they are compiled: messages, fields and enums, with their comments and places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from google.protobuf.descriptor_pb2 import EnumValueOptions, FieldOptions, FileDescriptorSet, MessageOptions

from roverlink.generator import ir
from roverlink.generator.diagnostics import Span

Ranges = tuple[tuple[int, int], ...]
"""Ranges of numbers, both ends included."""


class Fact(NamedTuple):
    """What a field or an enum value says about its number. Equal facts, wherever they stand, mean the same."""

    number: int
    name: str
    type: str
    """As `ProtoField.wire_type`; empty for an enum value."""
    label: str = ""
    oneof: str = ""
    claimed: bool = False
    """Whether it is commented out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Declared:
    """Something that a .proto file declares. What a reader of the model does not know keeps its default."""

    span: Span
    places: Mapping[str, Span] = field(default_factory=dict, repr=False, hash=False)
    """Where its parts stand: ``name``, ``number``, ``type``, ``label``; a reserved range as ``reserved 3 to 5``."""
    comment: str = field(default="", repr=False)
    options: bytes = field(default=b"", repr=False)
    """Its options, serialized; custom ones among them."""

    def at(self, part: str) -> Span:
        """Where a part stands; the whole declaration's place where that is not known."""
        return self.places.get(part, self.span)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoField(Declared):
    """A field of a message, or of a oneof in it."""

    number: int
    name: str
    type: str
    """The scalar's name; or ``message``, ``enum``, ``group``."""
    type_name: str = ""
    """Full name of the message or enum; empty for a scalar."""
    label: str = ""
    """``repeated``, ``required``; ``optional`` where it tells *absent* from *zero*; else empty."""
    declared_optional: bool = False
    """Whether `optional` was written in a proto3 file."""
    oneof: str = ""
    """The oneof it stands in; empty for none."""
    json_name: str = ""
    """Its name in JSON; empty where that is not known."""
    facets: Mapping[str, str] = field(default_factory=dict, hash=False)
    """What else changes how its bytes are read: ``default``; ``delimited`` if it is framed as a group is."""

    @property
    def repeated(self) -> bool:
        """Whether it holds any number of values; a map does too."""
        return self.label == "repeated"

    @property
    def optional(self) -> bool:
        """Whether it tells *absent* from *zero*; of a message field, only where it was declared ``optional``."""
        holds_message = self.type in ("message", "group")
        return self.declared_optional or (self.label == "optional" and not holds_message and not self.oneof)

    def on_the_wire(self) -> ir.WireField:
        """What of it is visible in bytes; that a message or a oneof's member may be absent goes without saying."""
        plain = self.label == "optional" and (self.type in ("message", "group") or self.oneof)
        label = "" if plain else self.label
        return ir.WireField(self.number, self.name, self.wire_type, label, self.oneof, commented(self))

    @property
    def fact(self) -> Fact:
        """What it says about its number."""
        return Fact(self.number, self.name, self.wire_type, self.label, self.oneof)

    @property
    def wire_type(self) -> str:
        """The type as a .proto file spells it."""
        return self.type_name or self.type


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoMessage(Declared):
    """A message type."""

    full_name: str
    file: str = ""
    fields: tuple[ProtoField, ...]
    oneofs: tuple[str, ...] = ()
    """The declared ones, in their order."""
    map_entry: bool = False
    extension_ranges: Ranges = ()
    reserved: Ranges = ()
    reserved_names: tuple[str, ...] = ()
    facets: Mapping[str, str] = field(default_factory=dict, hash=False)
    """Options that change its bytes: ``message_set_wire_format``."""
    claims: tuple[ProtoField, ...] = ()
    """Fields that somebody commented out: their numbers were in use, or will be. The descriptors have none."""

    @property
    def name(self) -> str:
        """Its name without what it stands in."""
        return self.full_name.rpartition(".")[2]

    @property
    def extendable(self) -> bool:
        """Whether other files may add fields to it."""
        return bool(self.extension_ranges)

    def on_the_wire(self) -> ir.WireMessage:
        """What of it is visible in bytes."""
        fields = sorted(self.fields, key=lambda field: field.number)
        return ir.WireMessage(
            self.full_name,
            tuple(field.on_the_wire() for field in fields),
            tuple(sorted(self.reserved)),
            tuple(sorted(self.reserved_names)),
            self.map_entry,
            commented(self),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoEnumValue(Declared):
    """A declared value of an enum."""

    name: str
    number: int

    @property
    def fact(self) -> Fact:
        """What it says about its number."""
        return Fact(self.number, self.name, "")

    def on_the_wire(self) -> ir.WireValue:
        """What of it is visible in bytes, with its name."""
        return ir.WireValue(self.number, self.name, commented(self))


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoEnum(Declared):
    """An enum type."""

    full_name: str
    file: str = ""
    values: tuple[ProtoEnumValue, ...]
    reserved: Ranges = ()
    reserved_names: tuple[str, ...] = ()
    claims: tuple[ProtoEnumValue, ...] = ()
    """Values that somebody commented out. The descriptors have none."""

    @property
    def name(self) -> str:
        """Its name without what it stands in."""
        return self.full_name.rpartition(".")[2]

    def on_the_wire(self) -> ir.WireEnum:
        """What of it is visible in bytes."""
        return ir.WireEnum(
            self.full_name,
            tuple(v.on_the_wire() for v in sorted(self.values, key=lambda v: (v.number, v.name))),
            tuple(sorted(self.reserved)),
            tuple(sorted(self.reserved_names)),
            commented(self),
        )


@dataclass(frozen=True, slots=True)
class ProtoExtension:
    """A field that a file adds to a message of another."""

    extendee: str
    """Full name of the message."""
    scope: str
    """Full name of the message that it is declared in; empty for none."""
    field: ProtoField
    file: str = ""
    """The file that adds it."""


@dataclass(frozen=True, slots=True)
class Syntax:
    """How a file is written, and what an edition's file says for all of its fields."""

    name: str
    """``proto2``, ``proto3``, or an edition, which is a year; empty where that is not known."""
    presence: str = ""
    """An edition's feature `field_presence`."""
    encoding: str = ""
    """An edition's feature `message_encoding`."""

    @property
    def is_edition(self) -> bool:
        """Whether it has features that can be set."""
        return self.name.isdigit()

    @property
    def statement(self) -> str:
        """The line in which a file says it."""
        return f'edition = "{self.name}";' if self.is_edition else f'syntax = "{self.name}";'


@dataclass(frozen=True, slots=True)
class Schema:
    """What some files declare, and all that they import."""

    files: tuple[str, ...]
    """Each after those that it imports."""
    messages: Mapping[str, ProtoMessage]
    enums: Mapping[str, ProtoEnum]
    extensions: tuple[ProtoExtension, ...] = ()
    file_options: Mapping[str, bytes] = field(default_factory=dict)
    """The serialized options of each file."""
    packages: Mapping[str, str] = field(default_factory=dict)
    """The package of each file; empty for one without."""
    syntaxes: Mapping[str, Syntax] = field(default_factory=dict)
    descriptors: FileDescriptorSet = field(default_factory=FileDescriptorSet, repr=False, compare=False)
    """What the schema was read from, for other programs; empty for a schema of the ledger."""
    uncompiled: tuple[str, ...] = ()
    """The files that should be part of the schema and do not compile."""

    def descriptors_without_comments(self) -> bytes:
        """Return the descriptors, serialized, without the comments and places that protoc keeps in them."""
        bare = FileDescriptorSet()
        for file in self.descriptors.file:
            copy = bare.file.add()
            copy.CopyFrom(file)
            copy.ClearField("source_code_info")
        return bare.SerializeToString(deterministic=True)

    def syntax_of(self, file: str) -> Syntax:
        """How a file is written, as far as that is known."""
        return self.syntaxes.get(file, Syntax(""))

    def reachable(self, *roots: str) -> tuple[set[str], set[str]]:
        """The messages and the enums that can travel inside messages, those themselves included."""
        messages: set[str] = set()
        enums: set[str] = set()
        waiting = [*roots]
        while waiting:
            name = waiting.pop()
            if name in self.enums:
                enums.add(name)
            elif name not in messages and name in self.messages:
                messages.add(name)
                waiting += [field.type_name for field in self.messages[name].fields if field.type_name]
        return messages, enums


_MARK = "Deprecated."


def commented(declared: Declared) -> str:
    """Return the comment of what a .proto file declares, with a mark where it is deprecated."""
    if not declared.options or not _is_deprecated(declared):
        return declared.comment
    return f"{declared.comment}\n\n{_MARK}" if declared.comment else _MARK


def _is_deprecated(declared: Declared) -> bool:
    if isinstance(declared, ProtoField):
        return FieldOptions.FromString(declared.options).deprecated
    if isinstance(declared, ProtoEnumValue):
        return EnumValueOptions.FromString(declared.options).deprecated
    return MessageOptions.FromString(declared.options).deprecated  # of an enum, the same field of EnumOptions
