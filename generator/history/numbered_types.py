"""Messages and enums in one state of a .proto file, by their numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from generator.declarations import Enum, File, Message
from generator.history.usage_model import Fact


@dataclass(frozen=True, slots=True)
class NumberedType:
    """A message or an enum in one state of a file."""

    facts: dict[Fact, int]
    """What it says about its numbers, with the first line that says so."""
    line: int
    broken: bool
    """Whether the file has lines that cannot be read."""
    enum: bool


NumberedTypes = dict[str, NumberedType]
"""The types of one state of a file by their full names."""


def numbered_types(file: File) -> NumberedTypes:
    """Return what a parsed file says about numbers; of a type that it declares twice, both declarations in one."""
    found: NumberedTypes = {}
    types: list[Message | Enum] = [*file.all_messages(), *file.all_enums()]
    for type in sorted(types, key=lambda one: one.line):
        enum = isinstance(type, Enum)
        facts = found.setdefault(type.full_name, NumberedType({}, type.line, file.broken, enum)).facts
        for fact, line in _facts(type):
            facts[fact] = min(facts.get(fact, line), line)
    return found


def _facts(type: Message | Enum) -> Iterator[tuple[Fact, int]]:
    """Yield the facts of a type, with their lines."""
    if isinstance(type, Enum):
        for value in type.values:
            if value.number is not None:
                yield Fact(value.number, value.name, ""), value.line
    else:
        for field in type.fields:
            if field.number is not None:
                yield Fact(field.number, field.name, field.type, field.label, field.oneof), field.line
    for claim in type.claims:
        yield Fact(claim.number, claim.name, claim.type, "", claim.oneof, claimed=True), claim.line
