"""What a .proto file declares. Lines and columns count from 1, as protoc counts: in bytes, a tab to the next 8th."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

LARGEST_FIELD_NUMBER = 2**29 - 1
"""What ``max`` is in a range of fields, but for `LARGEST_MESSAGE_SET_NUMBER`."""
LARGEST_MESSAGE_SET_NUMBER = 2**31 - 2
"""What ``max`` is in a message with the option ``message_set_wire_format``."""
LARGEST_ENUM_NUMBER = 2**31 - 1


@dataclass(frozen=True, slots=True, order=True)
class Problem:
    """Something that could not be read, and was skipped; or that was read although it is not right."""

    line: int
    column: int
    what: str


@dataclass(frozen=True, slots=True)
class Import:
    """A file that this one needs."""

    path: str
    kind: str
    """``public``, ``weak``, ``option``; or empty."""
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Claim:
    """A field or an enum value that somebody commented out: it is not declared, but its number was, or will be."""

    number: int
    name: str
    type: str
    """As `Field.type`; empty for an enum value."""
    oneof: str
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message, of a oneof in it, or of an ``extend``."""

    number: int | None
    """None where there is none that can be read."""
    name: str
    """For a group, in lower case, as protoc has it."""
    type: str
    """As written; ``map<K, V>`` for a map, ``group`` for a group, empty where it is missing."""
    key_type: str
    """Of a map; empty otherwise."""
    value_type: str
    """Of a map; empty otherwise."""
    label: str
    """``optional``, ``required``, ``repeated``; or empty."""
    oneof: str
    """The oneof it stands in; empty for none."""
    options: Mapping[str, str] = field(hash=False)
    """What stands in its brackets, as written: ``{"(nanopb).max_size": "20", "json_name": '"x"'}``."""
    comment: str
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class EnumValue:
    """A value of an enum."""

    name: str
    number: int | None
    """None where there is none that can be read."""
    options: Mapping[str, str] = field(hash=False)
    comment: str
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Enum:
    """An enum type."""

    name: str
    full_name: str
    values: tuple[EnumValue, ...]
    reserved: tuple[tuple[int, int], ...]
    """Ranges of numbers, both ends included."""
    reserved_names: tuple[str, ...]
    options: Mapping[str, str] = field(hash=False)
    comment: str
    claims: tuple[Claim, ...]
    line: int
    column: int
    end_line: int


@dataclass(frozen=True, slots=True)
class Message:
    """A message type; that of a group, too."""

    name: str
    full_name: str
    fields: tuple[Field, ...]
    """In the order of the file, those of its oneofs among them."""
    oneofs: tuple[str, ...]
    messages: tuple[Message, ...]
    enums: tuple[Enum, ...]
    reserved: tuple[tuple[int, int], ...]
    """Ranges of numbers, both ends included."""
    reserved_names: tuple[str, ...]
    extension_ranges: tuple[tuple[int, int], ...]
    """Ranges of numbers, both ends included."""
    options: Mapping[str, str] = field(hash=False)
    comment: str
    """What stands before it, or else behind its opening brace."""
    claims: tuple[Claim, ...]
    line: int
    column: int
    end_line: int

    def all_messages(self) -> Iterator[Message]:
        """The message and those in it, outer ones first."""
        yield self
        for message in self.messages:
            yield from message.all_messages()


@dataclass(frozen=True, slots=True)
class Extend:
    """Fields that are declared for a message elsewhere."""

    extendee: str
    """The message's name as written."""
    scope: str
    """Full name of the message it stands in, or the package."""
    fields: tuple[Field, ...]
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class File:
    """All that could be read of a .proto file."""

    syntax: str
    """``proto2``, ``proto3``, or an edition, such as ``2023``; empty where the file does not say."""
    package: str
    imports: tuple[Import, ...]
    messages: tuple[Message, ...]
    """Those that stand in no other."""
    enums: tuple[Enum, ...]
    """Those that stand in no message."""
    extends: tuple[Extend, ...]
    """All of them, those inside messages too."""
    problems: tuple[Problem, ...]

    @property
    def broken(self) -> bool:
        """Whether anything was skipped: protoc refuses this file, and what is read of it may be less than was meant."""
        return bool(self.problems)

    @property
    def imported(self) -> tuple[str, ...]:
        """The files that have to be compiled with it; of those that it imports for their options, it has no types."""
        return tuple(one.path for one in self.imports if one.kind != "option")

    def all_messages(self) -> Iterator[Message]:
        """Every message at whatever depth, outer ones first."""
        for message in self.messages:
            yield from message.all_messages()

    def all_enums(self) -> Iterator[Enum]:
        """Every enum at whatever depth, those outside of messages first."""
        yield from self.enums
        for message in self.all_messages():
            yield from message.enums
