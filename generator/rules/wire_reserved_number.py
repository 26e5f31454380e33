"""Numbers that were reserved are not any more.

They were reserved because something had them once. Whoever takes one of them gives it another meaning, and bytes of
boards that still send the old thing are read as the new one.

Bad::

    message Imu { reserved 2; float x = 1; }   // before
    message Imu { float x = 1; float y = 2; }   // after

Good::

    message Imu { reserved 2; float x = 1; float y = 3; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import EnumPair, MessagePair, each_once, earlier, enums, messages
from generator.changes.ranges import Range, covers, missing, spelled
from generator.findings import Finding, Rule
from generator.subject import Change, Subject

RULE = Rule("WIR106", "reserved-number-freed")


def check(subject: Subject) -> Iterator[Finding]:
    """Reserved ranges of messages and enums of which something is not reserved any more."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair in messages(change):
        taken = {field.number: field.name for field in pair.new.fields}
        yield from _freed(pair, taken)
    for of_enum in enums(change):
        yield from _freed(of_enum, {value.number: value.name for value in of_enum.new.values})


def _freed(pair: MessagePair | EnumPair, taken: dict[int, str]) -> Iterator[Finding]:
    for was in dict.fromkeys(pair.old.reserved):
        freed = list(missing(was, pair.new.reserved))
        if freed:
            place = pair.old.at(f"reserved {was[0]} to {was[1]}")
            yield RULE.at(
                pair.new.span,
                f"{pair.new.full_name} does not reserve {spelled(freed)} any more{_use(freed, taken)}",
                f"put back `reserved {spelled(freed)};`",
                earlier(pair.change, place, "reserved here"),
                type=pair.new.full_name,
                number=freed[0][0] if freed[0][0] == freed[-1][1] else None,
            )


def _use(freed: list[Range], taken: dict[int, str]) -> str:
    users = [f"{name} = {number}" for number, name in sorted(taken.items()) if covers(freed, number)]
    return f", and uses it for {', '.join(users)}" if users else ""
