"""The schema: the messages, fields and enums of .proto files, with comments and places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from google.protobuf.descriptor_pb2 import EnumValueOptions, FieldOptions, FileDescriptorSet, MessageOptions

from roverlink.generator import ir
from roverlink.generator.diagnostics import Span

Ranges = tuple[tuple[int, int], ...]
"""Ranges of numbers. Both ends are included."""


class Fact(NamedTuple):
    """The meaning of a number: the declaration of a field or an enum value without its place.

    Equal facts mean the same.
    """

    number: int
    name: str
    type: str
    """The same as `ProtoField.wire_type`; empty for an enum value."""
    label: str = ""
    oneof: str = ""
    claimed: bool = False
    """True if the declaration is commented out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Declared:
    """A declaration in a .proto file. A reader leaves the default for everything that it cannot know."""

    span: Span
    places: Mapping[str, Span] = field(default_factory=dict, repr=False, hash=False)
    """The places of its parts: ``name``, ``number``, ``type``, ``label``; ``reserved 3 to 5`` for a reserved range."""
    comment: str = field(default="", repr=False)
    options: bytes = field(default=b"", repr=False)
    """The serialized options, with custom options."""

    def at(self, part: str) -> Span:
        """Return the place of a part, or of the whole declaration if the part's place is unknown."""
        return self.places.get(part, self.span)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoField(Declared):
    """A field of a message, in a oneof or not."""

    number: int
    name: str
    type: str
    """The scalar's name, or ``message``, ``enum``, ``group``."""
    type_name: str = ""
    """Full name of the message or enum; empty for a scalar."""
    label: str = ""
    """``repeated``, ``required``, or ``optional`` (absent differs from zero). Empty otherwise."""
    declared_optional: bool = False
    """True if a proto3 file declares the field ``optional``."""
    oneof: str = ""
    """The oneof that contains the field; empty for none."""
    json_name: str = ""
    """The name in JSON; empty if it is unknown."""
    facets: Mapping[str, str] = field(default_factory=dict, hash=False)
    """Other settings that change decoding: ``default``; ``delimited`` for the encoding of groups."""

    @property
    def repeated(self) -> bool:
        """True for a field with any number of values, which includes maps."""
        return self.label == "repeated"

    @property
    def optional(self) -> bool:
        """True if absent differs from zero; for a message field, only if it is declared ``optional``."""
        holds_message = self.type in ("message", "group")
        return self.declared_optional or (self.label == "optional" and not holds_message and not self.oneof)

    def on_the_wire(self) -> ir.WireField:
        """Return the part of the declaration that matters on the wire, as it stands in the ledger.

        Message fields and members of a oneof always have presence, so their label is left out.
        """
        # A label says nothing where presence follows from the type, and the two readers would disagree about it.
        plain = self.label == "optional" and (self.type in ("message", "group") or self.oneof)
        label = "" if plain else self.label
        return ir.WireField(self.number, self.name, self.wire_type, label, self.oneof, commented(self))

    @property
    def fact(self) -> Fact:
        """The meaning that the field gives to its number."""
        return Fact(self.number, self.name, self.wire_type, self.label, self.oneof)

    @property
    def wire_type(self) -> str:
        """The type as a .proto file writes it."""
        return self.type_name or self.type


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoMessage(Declared):
    """A message type."""

    full_name: str
    file: str = ""
    fields: tuple[ProtoField, ...]
    oneofs: tuple[str, ...] = ()
    """The declared oneofs, in their order. A synthetic oneof of `optional` is not among them."""
    map_entry: bool = False
    extension_ranges: Ranges = ()
    reserved: Ranges = ()
    reserved_names: tuple[str, ...] = ()
    facets: Mapping[str, str] = field(default_factory=dict, hash=False)
    """Options that change the encoding: ``message_set_wire_format``."""
    claims: tuple[ProtoField, ...] = ()
    """Fields that are commented out: their numbers were in use, or will be. Only the tolerant parser finds them."""

    @property
    def name(self) -> str:
        """The name without package and enclosing messages."""
        return self.full_name.rpartition(".")[2]

    @property
    def extendable(self) -> bool:
        """True if other files may add extensions."""
        return bool(self.extension_ranges)

    def on_the_wire(self) -> ir.WireMessage:
        """Return the part of the declaration that matters on the wire."""
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
        """The meaning that the value gives to its number."""
        return Fact(self.number, self.name, "")

    def on_the_wire(self) -> ir.WireValue:
        """Return number, name and comment."""
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
    """Values that are commented out. Only the tolerant parser finds them."""

    @property
    def name(self) -> str:
        """The name without package and enclosing messages."""
        return self.full_name.rpartition(".")[2]

    def on_the_wire(self) -> ir.WireEnum:
        """Return the part of the declaration that matters on the wire."""
        return ir.WireEnum(
            self.full_name,
            tuple(v.on_the_wire() for v in sorted(self.values, key=lambda v: (v.number, v.name))),
            tuple(sorted(self.reserved)),
            tuple(sorted(self.reserved_names)),
            commented(self),
        )


@dataclass(frozen=True, slots=True)
class ProtoExtension:
    """An extension: a field that a file adds to a message."""

    extendee: str
    """Full name of the extended message."""
    scope: str
    """Full name of the message that contains the declaration; empty for none."""
    field: ProtoField
    file: str = ""
    """The file that declares the extension."""


@dataclass(frozen=True, slots=True)
class Syntax:
    """The syntax of a file; an edition includes the file's features."""

    name: str
    """The syntax's name: proto2, proto3, or an edition such as 2023; empty if unknown."""
    presence: str = ""
    """The feature `field_presence` of an edition."""
    encoding: str = ""
    """The feature `message_encoding` of an edition."""

    @property
    def is_edition(self) -> bool:
        """True for an edition, which has features."""
        return self.name.isdigit()

    @property
    def statement(self) -> str:
        """The statement that declares the syntax in a file."""
        return f'edition = "{self.name}";' if self.is_edition else f'syntax = "{self.name}";'


@dataclass(frozen=True, slots=True)
class Schema:
    """The declarations of some files and of all their imports."""

    files: tuple[str, ...]
    """The files, each one after its imports."""
    messages: Mapping[str, ProtoMessage]
    enums: Mapping[str, ProtoEnum]
    extensions: tuple[ProtoExtension, ...] = ()
    file_options: Mapping[str, bytes] = field(default_factory=dict)
    """The serialized options of each file."""
    packages: Mapping[str, str] = field(default_factory=dict)
    """The package of each file; empty for one without."""
    syntaxes: Mapping[str, Syntax] = field(default_factory=dict)
    descriptors: FileDescriptorSet = field(default_factory=FileDescriptorSet, repr=False, compare=False)
    """The descriptors behind the schema, for other programs; empty for the ledger's schema."""
    uncompiled: tuple[str, ...] = ()
    """The files that belong to the schema, but do not compile."""

    def descriptors_without_comments(self) -> bytes:
        """Return the serialized descriptors, without comments and places."""
        bare = FileDescriptorSet()
        for file in self.descriptors.file:
            copy = bare.file.add()
            copy.CopyFrom(file)
            # Comments and places change with every edit, and the generated code embeds these descriptors.
            copy.ClearField("source_code_info")
        return bare.SerializeToString(deterministic=True)

    def syntax_of(self, file: str) -> Syntax:
        """Return the syntax of a file; an empty one if it is unknown."""
        return self.syntaxes.get(file, Syntax(""))

    def reachable(self, *roots: str) -> tuple[set[str], set[str]]:
        """Return the names of messages and enums that ``roots`` contain at any depth, with the roots themselves."""
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
    """Return the comment of a declaration, with the mark ``Deprecated.`` if it is deprecated."""
    if not declared.options or not _is_deprecated(declared):
        return declared.comment
    return f"{declared.comment}\n\n{_MARK}" if declared.comment else _MARK


def _is_deprecated(declared: Declared) -> bool:
    if isinstance(declared, ProtoField):
        return FieldOptions.FromString(declared.options).deprecated
    if isinstance(declared, ProtoEnumValue):
        return EnumValueOptions.FromString(declared.options).deprecated
    return MessageOptions.FromString(declared.options).deprecated  # EnumOptions has the same field number, 3
