"""An enum value has another name.

Bytes carry the number alone. JSON has the name; so do logs, saved parameters and generated code.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; }     // before
    enum Mode { IDLE = 0; DRIVING = 1; }   // after

Good::

    enum Mode { option allow_alias = true; IDLE = 0; DRIVING = 1; DRIVE = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier
from generator.changes.spelling import value_place
from generator.changes.values import moved_here, renamed_values
from generator.findings import Finding, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN107", "enum-value-renamed", Severity.WARNING)


def check(subject: Subject) -> Iterator[Finding]:
    """Values of a number of which a name is gone; each of its names now, as none of them replaces it for sure."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair, number, gone, values in renamed_values(change):
        if moved_here(pair, number) is None:
            names = ", ".join(value.name for value in values)
            for value in values:
                yield RULE.at(
                    value.at("number"),
                    f"{', '.join(gone)} = {number} is called {names} now",
                    f"put back {', '.join(f'`{name} = {number};`' for name in gone)}, as an alias if need be",
                    earlier(change, value_place(pair.old, number), f"it was {', '.join(gone)} here"),
                    type=pair.new.full_name,
                    number=number,
                )
