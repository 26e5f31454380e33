"""nanopb's options that apply to each message and field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from roverlink.generator.diagnostics import Span


@dataclass(frozen=True, slots=True)
class FieldBounds:
    """The options that apply to a field, by nanopb's names."""

    max_size: int | None = None
    """Bytes of a `bytes` field, or of a string with its zero byte."""
    max_length: int | None = None
    """Bytes of a string without its zero byte; overrides ``max_size``."""
    max_count: int | None = None
    """Elements of a repeated field."""
    fixed_length: bool = False
    """True for a `bytes` field that always has ``max_size`` bytes."""
    fixed_count: bool = False
    """True for a repeated field that always has ``max_count`` elements."""
    type: str = "FT_DEFAULT"
    """The storage of the field: ``FT_STATIC``, ``FT_POINTER``, ``FT_CALLBACK``..."""
    int_size: int = 0
    """Bits of an integer; 0 for the size of its declared type."""
    type_override: str = ""
    """A scalar's name, ``message`` or ``enum``, which replaces the declared type; empty for the declared type."""
    label_override: str = ""
    """``repeated``, ``required`` or ``optional``, which replaces the declared label; empty for the declared label."""
    ignored: bool = False
    """True if nanopb leaves the field out, alone or with its oneof."""
    places: Mapping[str, Span] = field(default_factory=dict, hash=False)
    """The place of each option, by its name, as exactly as it is known."""


@dataclass(frozen=True, slots=True)
class MessageBounds:
    """The options that apply to a message."""

    skipped: bool = False
    """True if nanopb leaves the message out."""
    separate: frozenset[str] = frozenset()
    """The oneofs whose members are stored separately, not in a union (``no_unions``)."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """The options that apply to all messages and fields of a schema."""

    messages: Mapping[str, MessageBounds] = field(default_factory=dict)
    """Options by the full name of the message."""
    fields: Mapping[tuple[str, str], FieldBounds] = field(default_factory=dict)
    """Options by the full name of the message and the name of the field."""
    sizes: list[Mapping[str, int]] = field(default_factory=list, repr=False, compare=False)
    """A cache of `message_sizes`; its only entry has the size of every message with a bound."""

    def of_message(self, full_name: str) -> MessageBounds:
        """Return the options of a message."""
        return self.messages.get(full_name, MessageBounds())

    def of_field(self, message: str, name: str) -> FieldBounds:
        """Return the options of a field of a message."""
        return self.fields.get((message, name), FieldBounds())
