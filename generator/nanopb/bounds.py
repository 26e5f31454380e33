"""The options of nanopb that finally apply to each message and field, after all rules of precedence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from roverlink.generator.diagnostics import Span


@dataclass(frozen=True, slots=True)
class FieldBounds:
    """The options of nanopb that apply to a field. Most attributes have the names of nanopb's options."""

    max_size: int | None = None
    """Size of the C array in bytes for a string, with its zero byte, or for `bytes`; None without a bound."""
    max_length: int | None = None
    """Largest number of bytes in a string, without its zero byte; overrides ``max_size``. None without a bound."""
    max_count: int | None = None
    """Largest number of elements in a repeated field; None without a bound."""
    fixed_length: bool = False
    """True for a `bytes` field that always has ``max_size`` bytes."""
    fixed_count: bool = False
    """True for a repeated field that always has ``max_count`` elements."""
    type: str = "FT_DEFAULT"
    """The way in which nanopb stores the field: ``FT_STATIC``, ``FT_POINTER``, ``FT_CALLBACK``..."""
    int_size: int = 0
    """Number of bits of an integer; 0 for the size of its declared type."""
    type_override: str = ""
    """A scalar's name, ``message`` or ``enum``, which replaces the declared type; empty for the declared type."""
    label_override: str = ""
    """``repeated``, ``required`` or ``optional``, which replaces the declared label; empty for the declared label."""
    ignored: bool = False
    """True if nanopb leaves the field out, alone or together with its oneof."""
    places: Mapping[str, Span] = field(default_factory=dict, hash=False)
    """The place in a file that sets each option, by the option's name."""


@dataclass(frozen=True, slots=True)
class MessageBounds:
    """The options of nanopb that apply to a message."""

    skipped: bool = False
    """True if nanopb generates nothing for the message."""
    separate: frozenset[str] = frozenset()
    """The oneofs whose members are stored separately, not in a union (``no_unions``)."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """The options of nanopb that apply to all messages and fields of a schema."""

    messages: Mapping[str, MessageBounds] = field(default_factory=dict)
    """Options by the full name of the message."""
    fields: Mapping[tuple[str, str], FieldBounds] = field(default_factory=dict)
    """Options by the full name of the message and the name of the field."""
    unused: tuple[tuple[str, str, Span], ...] = ()
    """The lines of .options files that match no declaration: the .proto file, the pattern, and the line's place."""
    sizes: list[Mapping[str, int]] = field(default_factory=list, repr=False, compare=False)
    """A cache for the module `message_sizes`: an empty list, or a list with one mapping.

    The mapping has the largest encoded size in bytes of every message whose size has a limit, by full name.
    """

    def of_message(self, full_name: str) -> MessageBounds:
        """Return the options of a message, by its full name."""
        return self.messages.get(full_name, MessageBounds())

    def of_field(self, message: str, name: str) -> FieldBounds:
        """Return the options of a field, by the full name of its message and the field's name."""
        return self.fields.get((message, name), FieldBounds())
