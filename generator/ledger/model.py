"""What the ledger holds."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

from generator import ir
from generator.diagnostics import Span

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
class Number:
    """A number of a message or an enum that was published, and what for."""

    fact: ir.WireField | ir.WireValue
    gone: bool
    """Whether a later generate did not find it any more."""
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


@dataclass(slots=True)
class Owner:
    """A message or an enum of the ledger."""

    of_message: bool
    span: Span
    numbers: list[Number] = field(default_factory=list)
    reserved: list[tuple[int, int]] = field(default_factory=list)
    reserved_names: list[str] = field(default_factory=list)
    places: dict[str, Span] = field(default_factory=dict)
    """Where each reserved range and name stands, as in `generator.protos.Declared`."""


@dataclass(frozen=True, slots=True)
class Ledger:
    """Every number that was ever published, in order; a number may have been published for several payloads."""

    entries: tuple[Entry, ...] = ()
    messages: dict[str, Owner] = field(default_factory=dict)
    enums: dict[str, Owner] = field(default_factory=dict)
    burned: tuple[Burned, ...] = ()
    """By owner and number."""

    def burned_in(self, owner: str) -> dict[int, Burned]:
        """The burned numbers of a message or enum."""
        return {burned.number: burned for burned in self.burned if burned.owner == owner}


def checksum(text: str) -> str:
    """What the last line says of all before it."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]
