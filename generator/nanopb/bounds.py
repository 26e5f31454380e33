"""nanopb's options in force for each message and field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from roverlink.generator.diagnostics import Span


@dataclass(frozen=True, slots=True)
class FieldBounds:
    """The options that hold for a field, by nanopb's names."""

    max_size: int | None = None
    """Bytes of a `bytes` field; of a string, with the zero byte at its end."""
    max_length: int | None = None
    """Bytes of a string, without that; goes before ``max_size``."""
    max_count: int | None = None
    """Elements of a repeated field."""
    fixed_length: bool = False
    """True for a `bytes` field that always has ``max_size`` bytes."""
    fixed_count: bool = False
    """True for a repeated field that always has ``max_count`` elements."""
    type: str = "FT_DEFAULT"
    """How nanopb stores the field: ``FT_STATIC``, ``FT_POINTER``, ``FT_CALLBACK``..."""
    int_size: int = 0
    """Bits of an integer; 0 for those of its type in the .proto file."""
    type_override: str = ""
    """The scalar's name, or ``message``..., that nanopb takes for its type; empty for the declared one."""
    label_override: str = ""
    """``repeated``, ``required`` or ``optional``, as for the type."""
    ignored: bool = False
    """True for a field that nanopb leaves out, alone or with its oneof."""
    said: Mapping[str, Span] = field(default_factory=dict, hash=False)
    """The place of each option that is set, by its name; as exactly as that is known."""


@dataclass(frozen=True, slots=True)
class MessageBounds:
    """The options that hold for a message."""

    skipped: bool = False
    """True for a message that nanopb leaves out."""
    separate: frozenset[str] = frozenset()
    """Its oneofs of which every member has a place of its own (``no_unions``)."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """The options that hold for all messages and fields of one schema."""

    messages: Mapping[str, MessageBounds] = field(default_factory=dict)
    """By full name."""
    fields: Mapping[tuple[str, str], FieldBounds] = field(default_factory=dict)
    """By the full name of the message and the name of the field."""
    sizes: list[Mapping[str, int]] = field(default_factory=list, repr=False, compare=False)
    """Cache of `message_sizes`: the size of every message that has one, as the only entry."""

    def of_message(self, full_name: str) -> MessageBounds:
        """Return the options of a message."""
        return self.messages.get(full_name, MessageBounds())

    def of_field(self, message: str, name: str) -> FieldBounds:
        """Return the options of a field of a message."""
        return self.fields.get((message, name), FieldBounds())
