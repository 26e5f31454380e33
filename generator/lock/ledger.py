"""The ledger mapping.lock as data: every published number, and the wire schema at the last `roverlink generate`."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field

from roverlink.generator.diagnostics import Span
from roverlink.generator.lock.row_settings import RowSettings
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField, Schema

NAME = "mapping.lock"


@dataclass(frozen=True, slots=True)
class Entry:
    """Envelope field number that `roverlink generate` has published, with the payload that had it."""

    number: int
    name: str
    proto: str
    topic: str
    """The topic of the payload's row; empty if the payload has no row any more."""
    retired: bool
    contested: bool
    """True if only one side of a merge conflict in mapping.lock contains the entry, so only one branch published it."""
    span: Span
    gone: bool = False
    """True if the payload had no row, not even a retired one, when the ledger was written."""


@dataclass(frozen=True, slots=True)
class Burned:
    """Field number or enum number that had several meanings in history, and must never get another one.

    The user accepted its past with `roverlink lint --history --accept`.
    """

    owner: str
    """Full name of the message or enum in which the number was used."""
    number: int
    uses: tuple[tuple[str, str], ...]
    """Type and name of each field or enum value that had the number; the type of an enum value is empty."""
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
    """The numbers that had several meanings and must never get another one, sorted by message or enum, then number."""
    settings: RowSettings = field(default_factory=dict)
    """The settings of each published row. A ledger of an earlier version of roverlink has none."""
    files: tuple[str, ...] = ()
    """Paths of generated files that do not carry the header of generated files, as templates of users may make them."""

    def fields(self, message: str) -> tuple[ProtoField, ...]:
        """Return every field of a message that was ever published; fields that do not exist any more come last."""
        declared = self.schema.messages.get(message)
        return (*(declared.fields if declared else ()), *self.gone_fields.get(message, ()))

    def values(self, enum: str) -> tuple[ProtoEnumValue, ...]:
        """Return every value of an enum that was ever published; values that do not exist any more come last."""
        declared = self.schema.enums.get(enum)
        return (*(declared.values if declared else ()), *self.gone_values.get(enum, ()))

    def burned_in(self, owner: str) -> dict[int, Burned]:
        """Return the burned numbers of a message or enum, by number: they had several meanings in the past."""
        return {burned.number: burned for burned in self.burned if burned.owner == owner}


def checksum(text: str) -> str:
    """Return the checksum for the last line of mapping.lock, given the text before it."""
    # 64 bits are plenty against accidents: an editor, a bad merge, a copy that was cut short. Nothing here stops an
    # attacker, who could write the checksum as well.
    return hashlib.sha256(text.encode()).hexdigest()[:16]
