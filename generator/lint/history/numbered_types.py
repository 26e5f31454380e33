"""Messages and enums in one state of a .proto file, by their numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roverlink.generator.protos.parser import File
from roverlink.generator.protos.schema import Fact, ProtoEnum, ProtoMessage


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
