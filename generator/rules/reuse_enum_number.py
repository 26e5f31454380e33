"""A number that an enum had for another value once is used again.

The value was deleted long ago, and with it what reserved its number. The ledger knows every number that was ever
published: a board with the old value may still be out there, and is understood as saying the new one.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; }   // once
    enum Mode { IDLE = 0; }              // later
    enum Mode { IDLE = 0; ARM = 1; }     // now

Good::

    enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; ARM = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import values_by_number
from generator.changes.numbers import next_enum_number
from generator.findings import Finding, Rule
from generator.ledger import Number
from generator.protos import ProtoEnum, ProtoEnumValue
from generator.subject import Subject

RULE = Rule("WIR112", "enum-number-reuse")


def check(subject: Subject) -> Iterator[Finding]:
    """Values whose number the ledger has for another one that is gone, unless it has this one as well."""
    if subject.schema is None:
        return
    for name, owner in subject.ledger.enums.items():
        enum = subject.schema.enums.get(name)
        for number, values in values_by_number(enum).items() if enum else ():
            published = [one for one in owner.numbers if one.fact.number == number]
            known = any(one.fact.name == value.name for one in published for value in values)
            if enum and not known:
                yield from (_finding(subject, enum, values[0], one) for one in published if one.gone)


def _finding(subject: Subject, enum: ProtoEnum, value: ProtoEnumValue, number: Number) -> Finding:
    was, free = number.fact.name, next_enum_number(subject, enum.full_name)
    return RULE.at(
        value.at("number"),
        f"number {value.number} of {enum.full_name} was {was} once, and is given to {value.name}",
        f'write `{value.name} = {free}; reserved {value.number}; reserved "{was}";`: the next free number is {free}',
        [(number.span, "published here")],
        type=enum.full_name,
        number=value.number,
    )
