"""Declarations as facts about numbers."""

from __future__ import annotations

from collections.abc import Iterator

from generator.declarations import Claim, Enum, Message
from generator.history.model import Fact


def facts_of(type: Message | Enum) -> Iterator[tuple[Fact, int]]:
    """The facts of a type, with their lines."""
    if isinstance(type, Enum):
        yield from (
            (Fact(value.number, value.name, ""), value.line) for value in type.values if value.number is not None
        )
    else:
        for one in type.fields:
            if one.number is not None:
                yield Fact(one.number, one.name, one.type, one.label, one.oneof), one.line
    yield from (_claim(claim) for claim in type.claims)


def _claim(claim: Claim) -> tuple[Fact, int]:
    return Fact(claim.number, claim.name, claim.type, "", claim.oneof, claimed=True), claim.line
