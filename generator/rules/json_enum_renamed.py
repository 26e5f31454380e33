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

from generator.changes import EnumPair, each_once, earlier
from generator.changes.cures import put_values_back
from generator.changes.spelling import value_place
from generator.changes.values import renamed_values, stands_for_another
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.protos import ProtoEnumValue
from generator.subject import Change, Subject

RULE = Rule("JSN107", "enum-value-renamed", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Values of a number of which a name is gone; each of its names now, as none of them replaces it for sure."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair, number, gone, values in renamed_values(change):
        if not stands_for_another(pair, number):
            for value in values:
                yield RULE.at(
                    value.at("number"),
                    _message(pair, number, gone, values),
                    _help(pair, number, gone, values),
                    earlier(change, value_place(pair.old, number), f"it was {', '.join(gone)} here"),
                    type=pair.new.full_name,
                    number=number,
                )


def _message(pair: EnumPair, number: int, gone: tuple[str, ...], values: list[ProtoEnumValue]) -> str:
    what, names = f"{', '.join(gone)} = {number}", ", ".join(value.name for value in values)
    known = {value.name for value in pair.old.values}
    if all(value.name in known for value in values):
        return f"{what} is gone, which was another name of {names}"
    return f"{what} is called {names} now"


def _help(pair: EnumPair, number: int, gone: tuple[str, ...], values: list[ProtoEnumValue]) -> str:
    names = ", ".join(value.name for value in values)
    return f"{put_values_back(pair, number, gone)} beside {names}"
