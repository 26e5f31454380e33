"""A number of an enum has the meaning that another number had before.

The values of the enum were swapped or shifted. Boards with old firmware still send the old numbers. The rover reads
each number as another valid value, so there is no error.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; ARM = 2; }   // before
    enum Mode { IDLE = 0; ARM = 1; DRIVE = 2; }   // after

Good::

    enum Mode { IDLE = 0; DRIVE = 1; ARM = 2; }
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import EnumPair, SchemaChange, each_once
from roverlink.generator.lint.comparison.enum_renames import moved_away, moved_here, renamed_values, stands_for_another
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import value_place
from roverlink.generator.lint.fixits.put_back_or_reserve import values as declared
from roverlink.generator.lint.free_numbers import new_numbers
from roverlink.generator.protos.schema import ProtoEnumValue

RULE = Rule("WIR110", "enum-value-meaning-replaced", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each enum number whose meaning was exchanged.

    This is a number with a value that had another number before, or whose old value has another number now.
    """
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    for pair, number, gone, values in renamed_values(change):
        if stands_for_another(pair, number):
            help = _help(context, pair, number, gone, values)
            for value in values:
                yield RULE.at(
                    value.at("number"),
                    _message(pair, number, gone, value),
                    help,
                    change.earlier(value_place(pair.old, number), f"it was {_quoted(gone)} here"),
                    type=pair.new.full_name,
                    number=number,
                )


def _quoted(names: Iterable[str]) -> str:
    return ", ".join(map(repr, names))


def _message(pair: EnumPair, number: int, gone: tuple[str, ...], value: ProtoEnumValue) -> str:
    moved = moved_here(pair, number)
    if moved is not None:
        now = f"it is now {moved.name!r}, which had the number {moved.number} before"
        return f"number {number} of the enum {pair.new.full_name!r} was {_quoted(gone)}; {now}"
    message = f"number {number} of the enum {pair.new.full_name!r} was {_quoted(gone)}; it is now {value.name!r}"
    away = moved_away(pair, number)
    return f"{message}, and {away.name!r} now has the number {away.number}" if away else message


def _help(context: Context, pair: EnumPair, number: int, gone: tuple[str, ...], values: list[ProtoEnumValue]) -> str:
    before = {value.name: value.number for value in pair.old.values}
    moved = [declared([value.name], before[value.name]) for value in values if before.get(value.name, number) != number]
    back = f"put back `{' '.join([declared(gone, number), *moved])}`"
    new, numbers = [value.name for value in values if value.name not in before], new_numbers(context, pair)
    if not new:
        return back
    if not numbers.keys() >= set(new):
        return f"{back}, and give {_quoted(new)} a number of its own"
    given = " ".join(declared([name], numbers[name]) for name in new)
    return f"{back}, and give {_quoted(new)} a new number: `{given}`"
