"""A number of an enum stands for what another number stood for.

Values were swapped or shifted. Boards that were not flashed go on sending the old numbers, and each is understood as
another value that exists, so that nothing looks wrong.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; ARM = 2; }   // before
    enum Mode { IDLE = 0; ARM = 1; DRIVE = 2; }   // after

Good::

    enum Mode { IDLE = 0; DRIVE = 1; ARM = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier
from generator.changes.cures import new_enum_number
from generator.changes.spelling import value_place
from generator.changes.values import moved_here, renamed_values
from generator.findings import Finding, Rule
from generator.subject import Change, Subject

RULE = Rule("WIR110", "enum-value-meaning-replaced")


def check(subject: Subject) -> Iterator[Finding]:
    """Values whose name belonged to another number."""
    return each_once(subject, lambda change: _findings(subject, change))


def _findings(subject: Subject, change: Change) -> Iterator[Finding]:
    for pair, number, gone, values in renamed_values(change):
        moved = moved_here(pair, number)
        if moved is not None:
            help = f"put back `{gone[0]} = {number};`, and give what is new {new_enum_number(subject, pair)}"
            for value in values:
                yield RULE.at(
                    value.at("number"),
                    f"{number} was {', '.join(gone)} and is {moved.name} now, which was {moved.number}",
                    help,
                    earlier(change, value_place(pair.old, number), f"it was {', '.join(gone)} here"),
                    type=pair.new.full_name,
                    number=number,
                )
