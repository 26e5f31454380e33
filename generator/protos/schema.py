"""The schema: the messages, fields and enums of .proto files as data, with comments and places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from google.protobuf.descriptor_pb2 import EnumValueOptions, FieldOptions, FileDescriptorSet, MessageOptions

from roverlink.generator import ir
from roverlink.generator.diagnostics import Span

Ranges = tuple[tuple[int, int], ...]
"""Ranges of numbers. Both ends belong to a range."""


class Fact(NamedTuple):
    """The meaning that a declaration gives to a field number or enum number: name, type and label, without the place.

    Two declarations with equal facts give the same meaning to the number.
    """

    number: int
    name: str
    type: str
    """The type as a .proto file writes it, like `ProtoField.wire_type`; empty for an enum value."""
    label: str = ""
    oneof: str = ""
    claimed: bool = False
    """True if the declaration is commented out."""
    json_name: str = ""
    """The name that the field has in JSON by its option ``json_name``; empty if that is the usual one for its name."""

    @property
    def text(self) -> str:
        """The declaration as text of a .proto file, such as ``repeated int32 x = 3;`` or ``MODE_IDLE = 2;``."""
        option = f' [json_name = "{self.json_name}"]' if self.json_name else ""
        return f"{' '.join(filter(None, (self.label, self.type, self.name)))} = {self.number}{option};"


def default_json_name(name: str) -> str:
    """Return the name in JSON of a field without the option ``json_name``: ``motorSpeed`` for ``motor_speed``.

    As protoc does it (descriptor.cc, ToJsonName), only the letter after an underscore changes.
    """
    first, *others = name.split("_")
    return first + "".join(part[:1].upper() + part[1:] for part in others)


@dataclass(frozen=True, slots=True, kw_only=True)
class Declared:
    """Base class of the declarations in a .proto file: messages, fields, enums and enum values.

    protoc, the tolerant parser and the ledger create declarations. An attribute that one of them does not know keeps
    its default.
    """

    span: Span
    places: Mapping[str, Span] = field(default_factory=dict, repr=False, hash=False)
    """The place of each part of the declaration, by the name of the part.

    Names are ``name``, ``number``, ``type`` and ``label``, and ``reserved 3 to 5`` for a reserved range.
    """
    comment: str = field(default="", repr=False)
    options: bytes = field(default=b"", repr=False)
    """The options of the declaration as serialized protobuf message, with custom options."""

    def at(self, part: str) -> Span:
        """Return the place of a part of the declaration; if it is unknown, the place of the whole declaration."""
        return self.places.get(part, self.span)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoField(Declared):
    """A field of a message. It may be a member of a oneof."""

    number: int
    name: str
    type: str
    """The name of the scalar type, or ``message``, ``enum`` or ``group``."""
    type_name: str = ""
    """Full name of the message or enum; empty for a scalar."""
    label: str = ""
    """``repeated``, ``required``, or ``optional`` (absent differs from zero); empty for other fields."""
    declared_optional: bool = False
    """True if a proto3 file declares the field ``optional``."""
    oneof: str = ""
    """The oneof that contains the field; empty for none."""
    json_name: str = ""
    """The field's name in JSON; empty if it is unknown, or if the parser found no option ``json_name``."""
    facets: Mapping[str, str] = field(default_factory=dict, hash=False)
    """Other settings of the field that change how it is decoded, by name.

    ``default`` is the declared default, and ``delimited`` means that a message is encoded like a group.
    """

    @property
    def repeated(self) -> bool:
        """True if the field can have any number of values. Maps are included."""
        return self.label == "repeated"

    @property
    def optional(self) -> bool:
        """True if the field distinguishes *absent* from *zero*, except for members of a oneof.

        A message field counts only if it is declared ``optional``.
        """
        holds_message = self.type in ("message", "group")
        return self.declared_optional or (self.label == "optional" and not holds_message and not self.oneof)

    def on_the_wire(self) -> ir.WireField:
        """Return the parts of the declaration that change the encoding, as mapping.lock stores them.

        Message fields and members of a oneof always have presence, so their label is left out.
        """
        # A label says nothing where presence follows from the type, and the two readers would disagree about it.
        plain = self.label == "optional" and (self.type in ("message", "group") or self.oneof)
        label = "" if plain else self.label
        return ir.WireField(self.number, self.name, self.wire_type, label, self.oneof, commented(self))

    @property
    def fact(self) -> Fact:
        """The meaning that the declaration gives to the field's number: the declaration without its place."""
        unusual = self.json_name and self.json_name != default_json_name(self.name)
        json_name = self.json_name if unusual else ""
        return Fact(self.number, self.name, self.wire_type, self.label, self.oneof, json_name=json_name)

    @property
    def wire_type(self) -> str:
        """The field's type as a .proto file writes it: a scalar's name, or the full name of a message or enum."""
        return self.type_name or self.type


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoMessage(Declared):
    """A message type."""

    full_name: str
    file: str = ""
    fields: tuple[ProtoField, ...]
    oneofs: tuple[str, ...] = ()
    """Names of the oneofs that the file declares, in their order. protoc's synthetic oneofs are left out."""
    map_entry: bool = False
    """True for the message that protoc generates for the entries of a map."""
    extension_ranges: Ranges = ()
    reserved: Ranges = ()
    reserved_names: tuple[str, ...] = ()
    facets: Mapping[str, str] = field(default_factory=dict, hash=False)
    """Options of the message that change the encoding, by name: ``message_set_wire_format``."""
    claims: tuple[ProtoField, ...] = ()
    """Commented-out fields, such as ``// float speed = 4;``.

    Their numbers may still be in use on old boards. Only the tolerant parser finds such fields.
    """

    @property
    def name(self) -> str:
        """The name without package and enclosing messages."""
        return self.full_name.rpartition(".")[2]

    @property
    def extendable(self) -> bool:
        """True if other files may add extensions to the message."""
        return bool(self.extension_ranges)

    def on_the_wire(self) -> ir.WireMessage:
        """Return the parts of the declaration that change the encoding, as mapping.lock stores them."""
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
    """A value that an enum declares."""

    name: str
    number: int

    @property
    def fact(self) -> Fact:
        """The meaning that the declaration gives to the value's number: the declaration without its place."""
        return Fact(self.number, self.name, "")

    def on_the_wire(self) -> ir.WireValue:
        """Return the value as the IR stores it: number, name and comment."""
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
    """Commented-out values, such as ``// IDLE = 4;``. Only the tolerant parser finds such values."""

    @property
    def name(self) -> str:
        """The name without package and enclosing messages."""
        return self.full_name.rpartition(".")[2]

    def on_the_wire(self) -> ir.WireEnum:
        """Return the parts of the declaration that change the encoding, as mapping.lock stores them."""
        return ir.WireEnum(
            self.full_name,
            tuple(value.on_the_wire() for value in sorted(self.values, key=lambda value: (value.number, value.name))),
            tuple(sorted(self.reserved)),
            tuple(sorted(self.reserved_names)),
            commented(self),
        )


@dataclass(frozen=True, slots=True)
class ProtoExtension:
    """An extension: a field that a file adds to a message."""

    extendee: str
    """Full name of the message to which the extension is added."""
    scope: str
    """Full name of the message inside which the extension is declared; empty if there is none."""
    field: ProtoField
    file: str = ""
    """The file that declares the extension."""


@dataclass(frozen=True, slots=True)
class Syntax:
    """The syntax of a file: proto2, proto3 or an edition. For an edition, it includes features that the file sets."""

    name: str
    """The syntax's name: proto2, proto3, or an edition such as 2023; empty if unknown."""
    presence: str = ""
    """For an edition, the feature `field_presence`; empty otherwise."""
    encoding: str = ""
    """For an edition, the feature `message_encoding`; empty otherwise."""

    @property
    def is_edition(self) -> bool:
        """True for an edition. Only editions have features."""
        return self.name.isdigit()

    @property
    def statement(self) -> str:
        """The statement with which a .proto file declares the syntax: ``syntax = "proto3";``."""
        return f'edition = "{self.name}";' if self.is_edition else f'syntax = "{self.name}";'


@dataclass(frozen=True, slots=True)
class Schema:
    """The messages, enums and extensions of some .proto files, and of all files that these import."""

    files: tuple[str, ...] = ()
    """Paths of the files; each file stands after the files that it imports."""
    messages: Mapping[str, ProtoMessage] = field(default_factory=dict)
    enums: Mapping[str, ProtoEnum] = field(default_factory=dict)
    extensions: tuple[ProtoExtension, ...] = ()
    file_options: Mapping[str, bytes] = field(default_factory=dict)
    """The serialized `FileOptions` of each file, by path."""
    packages: Mapping[str, str] = field(default_factory=dict)
    """The proto package of each file, by path; empty if the file declares none."""
    syntaxes: Mapping[str, Syntax] = field(default_factory=dict)
    descriptors: FileDescriptorSet = field(default_factory=FileDescriptorSet, repr=False, compare=False)
    """protoc's descriptors of the files, for generated code and other programs; empty for the ledger's schema."""
    uncompiled: tuple[str, ...] = ()
    """Paths of the files that should be in the schema, but do not compile."""

    def descriptors_without_comments(self) -> bytes:
        """Return the descriptors as bytes, without comments and places."""
        bare = FileDescriptorSet()
        for file in self.descriptors.file:
            copy = bare.file.add()
            copy.CopyFrom(file)
            # Comments and places change with every edit, and the generated code embeds these descriptors.
            copy.ClearField("source_code_info")
        return bare.SerializeToString(deterministic=True)

    def syntax_of(self, file: str) -> Syntax:
        """Return the syntax that a file declares; an empty `Syntax` if the file is unknown."""
        return self.syntaxes.get(file, Syntax(""))

    def reachable(self, *roots: str) -> tuple[set[str], set[str]]:
        """Return the full names of all messages, and of all enums, in the fields of ``roots`` at any depth.

        ``roots`` are full names of messages and enums. They are included in the result.
        """
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
    """Return the comment of a declaration. If it has the option `deprecated`, ``Deprecated.`` is added."""
    if not declared.options or not _is_deprecated(declared):
        return declared.comment
    return f"{declared.comment}\n\n{_MARK}" if declared.comment else _MARK


def _is_deprecated(declared: Declared) -> bool:
    if isinstance(declared, ProtoField):
        return FieldOptions.FromString(declared.options).deprecated
    if isinstance(declared, ProtoEnumValue):
        return EnumValueOptions.FromString(declared.options).deprecated
    return MessageOptions.FromString(declared.options).deprecated  # EnumOptions has the same field number, 3
