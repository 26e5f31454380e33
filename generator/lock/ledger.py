"""What the ledger holds."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field

from roverlink.generator.diagnostics import Span
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField, Schema

NAME = "mapping.lock"


@dataclass(frozen=True, slots=True)
class Entry:
    """A number that was published, and what for."""

    number: int
    name: str
    proto: str
    topic: str
    """The topic of its row; empty where it has none any more."""
    retired: bool
    contested: bool
    """Whether it stands on one side of a merge conflict: published by one branch, not by both."""
    span: Span


@dataclass(frozen=True, slots=True)
class Burned:
    """A number of a message or an enum that had several meanings in the past, which was accepted."""

    owner: str
    """Full name of the message or enum."""
    number: int
    uses: tuple[tuple[str, str], ...]
    """Type and name of everything that it stood for; the type of an enum value is empty."""
    now: tuple[str, str] | None
    """What it stood for when that was accepted, and may go on standing for; None where nothing had it any more."""


@dataclass(frozen=True, slots=True)
class Ledger:
    """Every number that was ever published, in order; a number may have been published for several payloads."""

    entries: tuple[Entry, ...] = ()
    schema: Schema = field(default_factory=lambda: Schema((), {}, {}))
    """What could travel as of the last generate. What the ledger does not hold is empty: files, JSON names, options."""
    gone_fields: Mapping[str, tuple[ProtoField, ...]] = field(default_factory=dict)
    """By message: the fields that a later generate did not find any more."""
    gone_values: Mapping[str, tuple[ProtoEnumValue, ...]] = field(default_factory=dict)
    """By enum: the values that a later generate did not find any more."""
    burned: tuple[Burned, ...] = ()
    """By owner and number."""

    def fields(self, message: str) -> tuple[ProtoField, ...]:
        """Return every field of a message that was ever published; those that are gone come last."""
        declared = self.schema.messages.get(message)
        return (*(declared.fields if declared else ()), *self.gone_fields.get(message, ()))

    def values(self, enum: str) -> tuple[ProtoEnumValue, ...]:
        """Return every value of an enum that was ever published; those that are gone come last."""
        declared = self.schema.enums.get(enum)
        return (*(declared.values if declared else ()), *self.gone_values.get(enum, ()))

    def burned_in(self, owner: str) -> dict[int, Burned]:
        """The burned numbers of a message or enum."""
        return {burned.number: burned for burned in self.burned if burned.owner == owner}


def checksum(text: str) -> str:
    """What the last line says of all before it."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]
