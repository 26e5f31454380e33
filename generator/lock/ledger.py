"""The content of the ledger."""

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
    """The topic of the row; empty if the payload has no row now."""
    retired: bool
    contested: bool
    """True if the entry is only on one side of a merge conflict, so only one branch has published it."""
    span: Span


@dataclass(frozen=True, slots=True)
class Burned:
    """A number of a message or enum with several meanings in the past, accepted by ``lint --history --accept``."""

    owner: str
    """Full name of the message or enum."""
    number: int
    uses: tuple[tuple[str, str], ...]
    """Type and name of each meaning; the type of an enum value is empty."""
    now: tuple[str, str] | None
    """The meaning when the number was accepted, which it may keep; None if nothing used it then."""


@dataclass(frozen=True, slots=True)
class Ledger:
    """Every published number, in order. A number may have been published for several payloads."""

    entries: tuple[Entry, ...] = ()
    schema: Schema = field(default_factory=lambda: Schema((), {}, {}))
    """The messages and enums of all payloads at the last generate. Files, JSON names and options are unknown."""
    gone_fields: Mapping[str, tuple[ProtoField, ...]] = field(default_factory=dict)
    """Fields that a later generate did not find, by message."""
    gone_values: Mapping[str, tuple[ProtoEnumValue, ...]] = field(default_factory=dict)
    """Values that a later generate did not find, by enum."""
    burned: tuple[Burned, ...] = ()
    """The burned numbers, sorted by owner and number."""

    def fields(self, message: str) -> tuple[ProtoField, ...]:
        """Return every published field of a message; the fields that are gone come last."""
        declared = self.schema.messages.get(message)
        return (*(declared.fields if declared else ()), *self.gone_fields.get(message, ()))

    def values(self, enum: str) -> tuple[ProtoEnumValue, ...]:
        """Return every published value of an enum; the values that are gone come last."""
        declared = self.schema.enums.get(enum)
        return (*(declared.values if declared else ()), *self.gone_values.get(enum, ()))

    def burned_in(self, owner: str) -> dict[int, Burned]:
        """Return the burned numbers of a message or enum."""
        return {burned.number: burned for burned in self.burned if burned.owner == owner}


def checksum(text: str) -> str:
    """Return the checksum in the last line, for the text before it."""
    # 64 bits are plenty against accidents: an editor, a bad merge, a copy that was cut short. Nothing here stops an
    # attacker, who could write the checksum as well.
    return hashlib.sha256(text.encode()).hexdigest()[:16]
