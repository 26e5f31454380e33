"""An enum value was deleted, as it should be: its number is reserved, and so is its name, or another value has it now.

Nothing that travels is misread. Code that uses the value does not compile any more.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; }                      // before, while code uses DRIVE
    enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; }   // after

Good::

    enum Mode { IDLE = 0; DRIVE = 1 [deprecated = true]; }   // until nothing uses it
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import EnumPair, each_once, earlier, gone_values
from generator.changes.cures import names_in_use
from generator.changes.ranges import covers
from generator.changes.spelling import value_place
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC113", "enum-value-deleted", __doc__, Severity.HINT)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Values that are gone with their numbers reserved, and whose names are as well, or moved to other numbers."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair, number, names in gone_values(change):
        kept = {*pair.new.reserved_names, *names_in_use(pair.new)}
        if covers(pair.new.reserved, number) and kept.issuperset(names):
            message, help = _told(pair, number, names)
            yield RULE.at(
                pair.new.span,
                message,
                help,
                earlier(change, value_place(pair.old, number), "it was here"),
                type=pair.new.full_name,
                number=number,
            )


def _told(pair: EnumPair, number: int, names: tuple[str, ...]) -> tuple[str, str]:
    """The message and the help."""
    used = names_in_use(pair.new)
    moved = [name for name in names if name in used]
    if not moved:
        return (
            f"`{', '.join(names)} = {number};` is gone from {pair.new.full_name}",
            "change the code that uses it; its number and its name are reserved, as they should be",
        )
    return (
        f"{moved[0]} moved from number {number} to {used[moved[0]]}: JSON takes the one for the other",
        "nothing, if it is the same thing; else call the new one something else, and reserve the name",
    )
