"""The messages and enums in one state of a .proto file, as facts.

A fact is the declaration of a field or an enum value: it gives a meaning to a number.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from roverlink.generator.protos.parser import File, resolve_type
from roverlink.generator.protos.schema import Fact, ProtoEnum, ProtoExtension, ProtoMessage


@dataclass(frozen=True, slots=True)
class NumberedType:
    """A message or an enum in one state of a file."""

    facts: tuple[Fact, ...]
    """The facts of the message or enum, sorted."""
    offsets: tuple[int, ...]
    """For each fact, the number of lines from the line of the type to the first line that declares the fact."""
    line: int
    broken: bool
    """True if the parser could not read some lines of the file."""
    enum: bool


NumberedTypes = dict[str, NumberedType]
"""The messages and enums in one state of a file, by full name."""


class Pool:
    """Equal values, each kept once. Two states of a file have most facts in common, so thousands of states need it."""

    def __init__(self) -> None:
        self._facts: dict[Fact, Fact] = {}
        self._types: dict[NumberedType, NumberedType] = {}
        self._all_facts: dict[tuple[Fact, ...], tuple[Fact, ...]] = {}
        self._offsets: dict[tuple[int, ...], tuple[int, ...]] = {}

    def fact(self, fact: Fact) -> Fact:
        """Return the equal fact that the pool keeps."""
        return self._facts.setdefault(fact, fact)

    def type(self, lines: Iterable[tuple[Fact, int]], line: int, broken: bool, enum: bool) -> NumberedType:
        """Return the message or enum at the line ``line`` of a file, with the given facts and their lines."""
        first: dict[Fact, int] = {}
        for fact, at in lines:
            first[fact] = min(first.get(fact, at), at)
        facts = tuple(self.fact(fact) for fact in sorted(first))
        offsets = tuple(first[fact] - line for fact in facts)
        return self.shared(facts, offsets, line, broken, enum)

    def shared(
        self, facts: tuple[Fact, ...], offsets: tuple[int, ...], line: int, broken: bool, enum: bool
    ) -> NumberedType:
        """Return the type with the given attributes, whose facts must be from this pool."""
        facts, offsets = self._all_facts.setdefault(facts, facts), self._offsets.setdefault(offsets, offsets)
        type = NumberedType(facts, offsets, line, broken, enum)
        return self._types.setdefault(type, type)


def numbered_types(file: File, pool: Pool) -> NumberedTypes:
    """Return the messages and enums of a parsed file. If one is declared twice, its fields or values are combined.

    An extension counts as a field of the message that it extends, which may be declared in another file.
    """
    heads: dict[str, tuple[int, bool]] = {}
    lines: dict[str, list[tuple[Fact, int]]] = {}
    types: list[ProtoMessage | ProtoEnum] = [*file.messages, *file.enums]
    for type in sorted(types, key=lambda declared: declared.span.line):
        heads.setdefault(type.full_name, (type.span.line, isinstance(type, ProtoEnum)))
        lines.setdefault(type.full_name, []).extend(_facts(type))
    for extension in file.extensions:
        owner, line = _extended(extension, file), extension.field.span.line
        heads.setdefault(owner, (line, False))
        lines.setdefault(owner, []).append((extension.field.fact, line))
    return {name: pool.type(lines[name], line, file.broken, enum) for name, (line, enum) in heads.items()}


def _extended(extension: ProtoExtension, file: File) -> str:
    """Return the full name of the message that an extension extends."""
    known = {message.full_name for message in file.messages}
    if found := resolve_type(extension.extendee, extension.scope or file.package, known):
        return found
    # Another file declares the message. A name without a dot can only belong to the same package.
    name = extension.extendee.removeprefix(".")
    return name if "." in extension.extendee or not file.package else f"{file.package}.{name}"


def _facts(type: ProtoMessage | ProtoEnum) -> Iterator[tuple[Fact, int]]:
    """Yield each field of a message, or each value of an enum, as a fact, with its line.

    Fields and values in comments are yielded too. Their facts have the attribute ``claimed``, because they only claim
    that the number was used.
    """
    for part in type.fields if isinstance(type, ProtoMessage) else type.values:
        yield part.fact, part.span.line
    for part in type.claims:
        yield part.fact._replace(claimed=True), part.span.line
