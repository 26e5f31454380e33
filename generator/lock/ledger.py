"""The ledger mapping.lock as data: every published number, and the wire schema at the last `roverlink generate`.

A folder of .proto files without a table has no mapping.lock. What the user has accepted there is in the file
accepted-numbers.lock in that folder, a ledger with nothing else: numbers with their past, and diagnostics of rules.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.lock.row_settings import RowSettings
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField, ProtoMessage, Schema


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


class PastUse(NamedTuple):
    """Meaning that a number had in the past."""

    type: str
    """The full name of a message or enum, or the name of a scalar, behind ``repeated`` for a list.

    Empty for an enum value. In a ledger of an earlier version of roverlink, it is the type as the .proto file wrote it.
    """
    name: str
    content: str = ""
    """Digest of the fields that replaced those of the message, if the message kept its name; else empty."""


@dataclass(frozen=True, slots=True)
class Burned:
    """Field number or enum number that had several meanings in history, and must never get another one.

    The user accepted its past with `roverlink lint --history --accept`.
    """

    owner: str
    """Full name of the message or enum in which the number was used."""
    number: int
    uses: tuple[PastUse, ...]
    now: PastUse | None
    """The meaning that the number had when the user accepted it, and may keep; None if nothing used the number then."""
    reason: str = ""
    """Why the user accepted the past; empty if the user gave no reason."""

    @property
    def description(self) -> str:
        """The meanings, and why they were accepted: ``'gps' (Gps) and 'wind' (Wind) (accepted: never built)``."""
        uses = dict.fromkeys(f"{use.name!r} ({use.type})" if use.type else repr(use.name) for use in self.uses)
        return " and ".join(uses) + (f" (accepted: {self.reason})" if self.reason else "")

    def joined(self, known: Burned | None) -> Burned:
        """Return this burned number with the meanings of ``known`` added, an earlier record of the same number."""
        if known is None:
            return self
        uses = tuple(dict.fromkeys((*known.uses, *self.uses)))
        return replace(self, uses=uses, reason=self.reason or known.reason)


@dataclass(frozen=True, slots=True, order=True)
class Settled:
    """Rule whose diagnostics the user has accepted in a folder without a table: they are hints.

    The user accepted it with `roverlink lint --accept`.
    """

    rule: str
    """Id of the rule."""
    subject: str = ""
    """Subject of the accepted diagnostics; empty if all diagnostics of the rule are accepted.

    It is the full name of a message or enum, such a name with a number (``rover.Imu:3``), or the path of a file.
    """
    reason: str = ""

    def covers(self, finding: Diagnostic) -> bool:
        """Return True if the user has accepted a diagnostic."""
        subjects = "", finding.type, f"{finding.type}:{finding.number}", finding.span.file
        return finding.rule.id == self.rule and self.subject in subjects


@dataclass(frozen=True, slots=True)
class Ledger:
    """Content of mapping.lock. A number may have several entries, if it was published for several payloads."""

    entries: tuple[Entry, ...] = ()
    schema: Schema = field(default_factory=Schema)
    """The messages and enums of all payloads at the last generate. Files, JSON names and options are not stored."""
    gone_fields: Mapping[str, tuple[ProtoField, ...]] = field(default_factory=dict)
    """Fields that were published and do not exist any more, by the message's full name."""
    gone_values: Mapping[str, tuple[ProtoEnumValue, ...]] = field(default_factory=dict)
    """Enum values that were published and do not exist any more, by the enum's full name."""
    burned: tuple[Burned, ...] = ()
    """The numbers that had several meanings and must never get another one, sorted by message or enum, then number."""
    settled: tuple[Settled, ...] = ()
    """The rules whose diagnostics the user has accepted in a folder without a table."""
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

    def with_burned(self, added: Iterable[Burned]) -> Ledger:
        """Return the ledger with more burned numbers. A number that was burned before keeps its meanings."""
        burned = {(entry.owner, entry.number): entry for entry in self.burned}
        for number in added:
            burned[number.owner, number.number] = number.joined(burned.get((number.owner, number.number)))
        return replace(self, burned=tuple(entry for _, entry in sorted(burned.items())))

    def with_settled(self, added: Iterable[Settled], reason: str) -> Ledger:
        """Return the ledger with more accepted rules; ``reason`` is stored with them."""
        settled = {(known.rule, known.subject): known for known in self.settled}
        for new in added:
            known = settled.get((new.rule, new.subject), new)
            settled[new.rule, new.subject] = replace(known, reason=reason or known.reason)
        return replace(self, settled=tuple(sorted(settled.values())))

    def must_not_be(self, owner: str, number: int, use: PastUse) -> Burned | None:
        """Return the burned number that forbids ``use``, a meaning that a number has today; None if it is allowed.

        A burned number that was free when its past was accepted is forbidden for every meaning. Else, its earlier
        meanings are forbidden. Meanings that it never had are left to the comparison with earlier states.
        """
        burned = self.burned_in(owner).get(number)
        if burned is None:
            return None
        if burned.now is not None:
            return burned if use != burned.now and use in burned.uses else None
        # Earlier versions of roverlink lost `now` in a proto package. The wire schema still has a number in use.
        declared = self.schema.messages.get(owner) or self.schema.enums.get(owner)
        parts = () if declared is None else declared.fields if isinstance(declared, ProtoMessage) else declared.values
        return None if any(part.number == number for part in parts) else burned

    def settles(self, owner: str, number: int, old: PastUse, new: PastUse) -> bool:
        """Return True if the user has accepted that a number had the meaning ``old`` and has ``new`` now."""
        burned = self.burned_in(owner).get(number)
        return burned is not None and old != new == burned.now and old in burned.uses


def checksum(text: str) -> str:
    """Return the checksum for the last line of mapping.lock, given the text before it."""
    # 64 bits are plenty against accidents: an editor, a bad merge, a copy that was cut short. Nothing here stops an
    # attacker, who could write the checksum as well.
    return hashlib.sha256(text.encode()).hexdigest()[:16]
