"""Diagnostics about enum values whose number got another meaning since an earlier state."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.accepted_past import is_accepted
from roverlink.generator.lint.comparison import EnumPair, SchemaChange, each_once
from roverlink.generator.lint.comparison.enum_renames import moved_away, moved_here, renamed_values
from roverlink.generator.lint.comparison.judged_changes import judge_number
from roverlink.generator.lint.comparison.judgement import Judgement, Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import value_place
from roverlink.generator.lint.fixits.put_back_or_reserve import values as declared
from roverlink.generator.lint.free_numbers import new_numbers
from roverlink.generator.protos.schema import ProtoEnumValue


def judged_values(rule: type[Rule], context: Context, meaning: Meaning) -> Iterator[Diagnostic]:
    """Yield a diagnostic of the rule for each value of an enum whose number has the given judgement."""

    def compare(change: SchemaChange) -> Iterator[Diagnostic]:
        for pair, number, gone, values in renamed_values(change):
            judged = judge_number(pair, number, gone, values)
            lost = [value for value in pair.old.values if value.number == number and value.name in gone]
            accepted = all(is_accepted(context, pair.new.full_name, value, *values) for value in lost)
            if judged.meaning is meaning and not accepted:
                help = _help(context, pair, number, gone, values)
                for value in values:
                    yield rule.at(
                        value.at("number"),
                        _message(pair, number, gone, value, judged),
                        help,
                        change.earlier(value_place(pair.old, number), f"it was {_quoted(gone)} here"),
                        type=pair.new.full_name,
                        number=number,
                    )

    return each_once(context.changes, compare)


def _quoted(names: Iterable[str]) -> str:
    return ", ".join(map(repr, names))


def _message(pair: EnumPair, number: int, gone: tuple[str, ...], value: ProtoEnumValue, judged: Judgement) -> str:
    message = f"number {number} of the enum {pair.new.full_name!r} was {_quoted(gone)}"
    moved = moved_here(pair, number)
    if moved is not None:
        return f"{message}; it is now {moved.name!r}, which had the number {moved.number} before"
    message = f"{message}; it is now {value.name!r}"
    away = moved_away(pair, number)
    return f"{message}, and {away.name!r} now has the number {away.number}" if away else f"{message}: {judged.reason}"


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
