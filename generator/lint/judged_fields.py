"""Diagnostics about fields whose number got another meaning since an earlier state."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.accepted_past import is_accepted
from roverlink.generator.lint.comparison import FieldPair, SchemaChange, each_once, fields
from roverlink.generator.lint.comparison.judged_changes import judge_pair
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import name_place, type_place
from roverlink.generator.lint.free_numbers import NewNumbers, changed_field


def judged_fields(rule: type[Rule], context: Context, meaning: Meaning) -> Iterator[Diagnostic]:
    """Yield a diagnostic of the rule for each field with the given judgement."""

    def compare(change: SchemaChange) -> Iterator[Diagnostic]:
        numbers = NewNumbers(context, change)
        for pair in fields(change):
            judged = judge_pair(pair)
            if judged.meaning is meaning and not is_accepted(context, pair.owner, pair.old, pair.new):
                place = type_place if pair.old.name == pair.new.name else name_place
                yield changed_field(rule, numbers, pair, f"{_told(pair)}: {judged.reason}", place)

    return each_once(context.changes, compare)


def _told(pair: FieldPair) -> str:
    old, new = (repr(field.name) for field in (pair.old, pair.new))
    if pair.old.name == pair.new.name:
        old, new = f"{old} ({pair.old.wire_type})", f"{new} ({pair.new.wire_type})"
    return f"field number {pair.new.number} was {old} and is now {new}"
