"""The ledger as data: every published number, and the wire schema at the last generate."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field

from roverlink.generator.diagnostics import Span
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField, Schema

NAME = "mapping.lock"


@dataclass(frozen=True, slots=True)
class Entry:
    """A published number, and the payload that had it."""

    number: int
    name: str
    proto: str
    topic: str
    """The topic of the payload's row; empty if the payload has no row any more."""
    retired: bool
    contested: bool
    """True if only one side of a merge conflict in mapping.lock contains the entry, so only one branch published it."""
    span: Span


@dataclass(frozen=True, slots=True)
class Burned:
    """A number that had several meanings in history and must never be used again.

    The user accepted this with ``--accept``.
    """

    owner: str
    """Full name of the message or enum."""
    number: int
    uses: tuple[tuple[str, str], ...]
    """Type and name of each meaning; the type of an enum value is empty."""
    now: tuple[str, str] | None
    """The meaning that the number had when the user accepted it, and may keep; None if nothing used the number then."""


@dataclass(frozen=True, slots=True)
class Ledger:
    """Content of mapping.lock. A number may have several entries, if it was published for several payloads."""

    entries: tuple[Entry, ...] = ()
    schema: Schema = field(default_factory=lambda: Schema((), {}, {}))
    """The messages and enums of all payloads at the last generate. Files, JSON names and options are not stored."""
    gone_fields: Mapping[str, tuple[ProtoField, ...]] = field(default_factory=dict)
    """Fields that were published and do not exist any more, by the message's full name."""
    gone_values: Mapping[str, tuple[ProtoEnumValue, ...]] = field(default_factory=dict)
    """Enum values that were published and do not exist any more, by the enum's full name."""
    burned: tuple[Burned, ...] = ()
    """The numbers that had several meanings and must never be used again, sorted by message or enum, then number."""

    def fields(self, message: str) -> tuple[ProtoField, ...]:
        """Return every field of a message that was ever published; fields that do not exist any more come last."""
        declared = self.schema.messages.get(message)
        return (*(declared.fields if declared else ()), *self.gone_fields.get(message, ()))

    def values(self, enum: str) -> tuple[ProtoEnumValue, ...]:
        """Return every value of an enum that was ever published; values that do not exist any more come last."""
        declared = self.schema.enums.get(enum)
        return (*(declared.values if declared else ()), *self.gone_values.get(enum, ()))

    def burned_in(self, owner: str) -> dict[int, Burned]:
        """Return the numbers of a message or enum that had several meanings and must never be used again."""
        return {burned.number: burned for burned in self.burned if burned.owner == owner}


def checksum(text: str) -> str:
    """Return the checksum for the last line of mapping.lock, given the text before it."""
    # 64 bits are plenty against accidents: an editor, a bad merge, a copy that was cut short. Nothing here stops an
    # attacker, who could write the checksum as well.
    return hashlib.sha256(text.encode()).hexdigest()[:16]
