"""What .proto files declare once they are compiled: messages, fields and enums, with their comments and places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from generator import ir
from generator.diagnostics import Span

Ranges = tuple[tuple[int, int], ...]
"""Ranges of numbers, both ends included."""


@dataclass(frozen=True, slots=True)
class Declared:
    """Something that a .proto file declares."""

    span: Span
    places: Mapping[str, Span] = field(repr=False, hash=False)
    """Where its parts stand: ``name``, ``number``, ``type``, ``label``; a reserved range as ``reserved 3 to 5``."""
    comment: str = field(repr=False)
    options: bytes = field(repr=False)
    """Its options, serialized; custom ones among them."""

    def at(self, part: str) -> Span:
        """Where a part stands; the whole declaration's place where that is not known."""
        return self.places.get(part, self.span)


@dataclass(frozen=True, slots=True)
class ProtoField(Declared):
    """A field of a message, or of a oneof in it."""

    number: int
    name: str
    type: str
    """The scalar's name; or ``message``, ``enum``, ``group``."""
    type_name: str
    """Full name of the message or enum; empty for a scalar."""
    label: str
    """``repeated``, ``required``; ``optional`` where it tells *absent* from *zero*; else empty."""
    declared_optional: bool
    """Whether `optional` was written in a proto3 file."""
    oneof: str
    """The oneof it stands in; empty for none."""
    json_name: str
    """Its name in JSON; empty where that is not known."""
    facets: Mapping[str, str] = field(hash=False)
    """What else changes the code that is generated for it, or its bytes: ``default``, ``packed``, ``jstype``..."""

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
        return ir.WireField(self.number, self.name, self.wire_type, "" if plain else self.label, self.oneof)

    @property
    def wire_type(self) -> str:
        """The type as a .proto file spells it."""
        return self.type_name or self.type


@dataclass(frozen=True, slots=True)
class ProtoMessage(Declared):
    """A message type."""

    full_name: str
    file: str
    fields: tuple[ProtoField, ...]
    oneofs: tuple[str, ...]
    """The declared ones, in their order."""
    map_entry: bool
    extension_ranges: Ranges
    reserved: Ranges
    reserved_names: tuple[str, ...]
    facets: Mapping[str, str] = field(hash=False)
    """Options that change its bytes or its JSON."""

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
        )


@dataclass(frozen=True, slots=True)
class ProtoEnumValue(Declared):
    """A declared value of an enum."""

    name: str
    number: int


@dataclass(frozen=True, slots=True)
class ProtoEnum(Declared):
    """An enum type."""

    full_name: str
    file: str
    values: tuple[ProtoEnumValue, ...]
    reserved: Ranges
    reserved_names: tuple[str, ...]
    facets: Mapping[str, str] = field(hash=False)
    """Whether it is open or closed, and its JSON."""

    def on_the_wire(self) -> ir.WireEnum:
        """What of it is visible in bytes."""
        return ir.WireEnum(
            self.full_name,
            tuple(ir.WireValue(v.number, v.name) for v in sorted(self.values, key=lambda v: (v.number, v.name))),
            tuple(sorted(self.reserved)),
            tuple(sorted(self.reserved_names)),
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
    public_imports: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """What each file hands on to those that import it."""

    def syntax_of(self, file: str) -> Syntax:
        """How a file is written, as far as that is known."""
        return self.syntaxes.get(file, Syntax(""))

    def hands_on(self, file: str, other: str) -> bool:
        """Whether who imports a file has what another one declares as well."""
        waiting, seen = [file], set[str]()
        while waiting:
            one = waiting.pop()
            if one not in seen:
                seen.add(one)
                waiting += self.public_imports.get(one, ())
        return other in seen

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
