"""What nanopb's options come to for each message and field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from generator.diagnostics import Span


@dataclass(frozen=True, slots=True)
class FieldBounds:
    """The options that hold for a field."""

    max_size: int | None = None
    """Bytes of a `bytes` field; of a string, with the zero byte at its end."""
    max_length: int | None = None
    """Bytes of a string, without that; goes before ``max_size``."""
    max_count: int | None = None
    """Elements of a repeated field."""
    fixed_length: bool = False
    """Whether a `bytes` field always has ``max_size`` bytes."""
    fixed_count: bool = False
    """Whether a repeated field always has ``max_count`` elements."""
    type: str = "FT_DEFAULT"
    """How nanopb stores it: ``FT_STATIC``, ``FT_POINTER``, ``FT_CALLBACK``..."""
    fallback_type: str = "FT_CALLBACK"
    """The same for a field of type ``FT_DEFAULT`` without a bound."""
    int_size: int = 0
    """Bits of an integer; 0 for those of its type in the .proto file."""
    type_override: str = ""
    """The scalar's name, or ``message``..., that nanopb takes for its type; empty for the declared one."""
    label_override: str = ""
    """``repeated``, ``required`` or ``optional``, as for the type."""
    ignored: bool = False
    """Whether nanopb leaves it out, alone or with its oneof."""
    said: Mapping[str, Span] = field(default_factory=dict, hash=False)
    """Where an option was given, by its name; as exactly as that is known."""


@dataclass(frozen=True, slots=True)
class MessageBounds:
    """The options that hold for a message."""

    skipped: bool = False
    """Whether nanopb leaves it out."""
    separate: frozenset[str] = frozenset()
    """Its oneofs of which every member has a place of its own (``no_unions``)."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """The options that hold for all messages and fields of one schema."""

    messages: Mapping[str, MessageBounds] = field(default_factory=dict)
    """By full name."""
    fields: Mapping[tuple[str, str], FieldBounds] = field(default_factory=dict)
    """By the full name of the message and the name of the field."""
    worked_out: list[Mapping[str, int]] = field(default_factory=list, repr=False, compare=False)
    """Room for `largest_size` to keep the sizes that it has worked out; one entry or none."""

    def of_message(self, full_name: str) -> MessageBounds:
        """Those of a message."""
        return self.messages.get(full_name, MessageBounds())

    def of_field(self, message: str, name: str) -> FieldBounds:
        """Those of a field of a message."""
        return self.fields.get((message, name), FieldBounds())
