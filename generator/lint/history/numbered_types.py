"""The messages and enums of one state of a .proto file, by number."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roverlink.generator.protos.parser import File
from roverlink.generator.protos.schema import Fact, ProtoEnum, ProtoMessage


@dataclass(frozen=True, slots=True)
class NumberedType:
    """A message or an enum in one state of a file."""

    facts: dict[Fact, int]
    """The facts of the type, each with its first line."""
    line: int
    broken: bool
    """True if the file has lines that cannot be read."""
    enum: bool


NumberedTypes = dict[str, NumberedType]
"""The messages and enums in one state of a file, by full name."""


def numbered_types(file: File) -> NumberedTypes:
    """Return the facts of a parsed file. Two declarations of one type are combined."""
    found: NumberedTypes = {}
    types: list[ProtoMessage | ProtoEnum] = [*file.messages, *file.enums]
    for type in sorted(types, key=lambda one: one.span.line):
        enum = isinstance(type, ProtoEnum)
        facts = found.setdefault(type.full_name, NumberedType({}, type.span.line, file.broken, enum)).facts
        for fact, line in _facts(type):
            facts[fact] = min(facts.get(fact, line), line)
    return found


def _facts(type: ProtoMessage | ProtoEnum) -> Iterator[tuple[Fact, int]]:
    """Yield the facts of a type, with their lines."""
    for part in type.fields if isinstance(type, ProtoMessage) else type.values:
        yield part.fact, part.span.line
    for part in type.claims:
        yield part.fact._replace(claimed=True), part.span.line
