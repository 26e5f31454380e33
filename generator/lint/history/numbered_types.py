"""The messages and enums in one state of a .proto file, as facts.

A fact is the declaration of a field or an enum value: it gives a meaning to a number.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roverlink.generator.protos.parser import File, resolve_type
from roverlink.generator.protos.schema import Fact, ProtoEnum, ProtoExtension, ProtoMessage


@dataclass(frozen=True, slots=True)
class NumberedType:
    """A message or an enum in one state of a file."""

    facts: dict[Fact, int]
    """The facts of the message or enum, each with the first line of the file that declares the fact."""
    line: int
    broken: bool
    """True if the parser could not read some lines of the file."""
    enum: bool


NumberedTypes = dict[str, NumberedType]
"""The messages and enums in one state of a file, by full name."""


def numbered_types(file: File) -> NumberedTypes:
    """Return the messages and enums of a parsed file. If one is declared twice, its fields or values are combined.

    An extension counts as a field of the message that it extends, which may be declared in another file.
    """
    found: NumberedTypes = {}
    types: list[ProtoMessage | ProtoEnum] = [*file.messages, *file.enums]
    for type in sorted(types, key=lambda one: one.span.line):
        enum = isinstance(type, ProtoEnum)
        facts = found.setdefault(type.full_name, NumberedType({}, type.span.line, file.broken, enum)).facts
        for fact, line in _facts(type):
            facts[fact] = min(facts.get(fact, line), line)
    for extension in file.extensions:
        owner, line = _extended(extension, file), extension.field.span.line
        facts = found.setdefault(owner, NumberedType({}, line, file.broken, enum=False)).facts
        facts.setdefault(extension.field.fact, line)
    return found


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
