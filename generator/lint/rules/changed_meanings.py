"""Rules about numbers of fields and enum values that have another meaning than in an earlier state."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.accepted_past import is_accepted
from roverlink.generator.lint.comparison import EnumPair, FieldPair, SchemaChange, each_once, messages
from roverlink.generator.lint.comparison.enum_renames import moved_away, moved_here, renamed_values
from roverlink.generator.lint.comparison.judged_changes import judge_number, judged_fields, type_state
from roverlink.generator.lint.comparison.judgement import Judgement, Meaning, compare_parts
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import name_place, type_place, value_place
from roverlink.generator.lint.fixits.put_back_or_reserve import values as declared
from roverlink.generator.lint.free_numbers import NewNumbers, changed_field, new_numbers
from roverlink.generator.lint.judged_ledger import burned_fields, burned_values, reused_fields, reused_values
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.protos.schema import ProtoEnumValue
from roverlink.numerals import counted


class EnumValueMeaningReplaced(LintRule, id="WIR110"):
    """A number of an enum is given to a value with another meaning.

    The values of the enum were swapped or shifted, or a number has a new name that means something else. Boards with
    old firmware still send the old numbers. The rover reads each number as another valid value, so there is no error.
    Names are judged without the words that the enum and most of its values have, in the same way as the names of fields
    (`roverlink explain WIR114`).

    Bad::

        enum Mode { IDLE = 0; DRIVE = 1; ARM = 2; }   // before
        enum Mode { IDLE = 0; ARM = 1; DRIVE = 2; }   // after

    Good::

        enum Mode { IDLE = 0; DRIVE = 1; ARM = 2; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each enum number whose value has another meaning."""
        return _judged_values(cls, context, Meaning.OTHER)


class FieldNumberReuseInMessage(LintRule, id="WIR111"):
    """A number of a deleted field is used again.

    The field was deleted long ago, and its number is no longer reserved. The ledger (mapping.lock) has every number
    that was ever published. A board with old firmware may still send the old field, and the rover reads its bytes as
    the new field. A field with a similar name counts as the old one (`roverlink explain WIR114`).

    The same holds for a burned number: one whose past was accepted with `roverlink lint --history --accept`. If it was
    free then, no field may use it again. If a field had it, no earlier field may come back.

    Bad::

        message Imu { float x = 1; float y = 2; }      // once
        message Imu { float x = 1; }                   // later
        message Imu { float x = 1; int32 state = 2; }  // now

    Good::

        message Imu { float x = 1; reserved 2; reserved "y"; int32 state = 3; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field whose number belonged to a field with another meaning in the ledger."""
        reused = list(reused_fields(cls, context, {Meaning.OTHER, Meaning.WIRE}))
        yield from reused
        reported = {finding.span for finding in reused}
        yield from (finding for finding in burned_fields(cls, context) if finding.span not in reported)


class EnumNumberReuse(LintRule, id="WIR112"):
    """A number of a deleted enum value is used again.

    The value was deleted long ago, and its number is no longer reserved. The ledger (mapping.lock) has every number
    that was ever published. A board with old firmware may still send the old value, and the rover reads it as the new
    one. A value with a similar name counts as the old one (`roverlink explain WIR114`). The same holds for a burned
    number, whose past was accepted with `roverlink lint --history --accept` (`roverlink explain WIR111`).

    Bad::

        enum Mode { IDLE = 0; DRIVE = 1; }   // once
        enum Mode { IDLE = 0; }              // later
        enum Mode { IDLE = 0; ARM = 1; }     // now

    Good::

        enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; ARM = 2; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each enum value whose number belonged to another value in the ledger."""
        reused = list(reused_values(cls, context, {Meaning.OTHER, Meaning.WIRE}))
        yield from reused
        reported = {finding.span for finding in reused}
        yield from (finding for finding in burned_values(cls, context) if finding.span not in reported)


class MessageContentReplaced(LintRule, id="WIR113"):
    """A message has other content than the message that had its name before.

    Most field numbers of the message belong to fields with other names and other types. The name of the message stayed
    the same, so boards and rows of the table mistake one message for the other.

    Bad::

        message Status { float voltage = 1; float current = 2; int32 load = 3; }   // before
        message Status { string text = 1; bool busy = 2; Mode mode = 3; }          // after

    Good::

        message PowerStatus { float voltage = 1; float current = 2; int32 load = 3; }
        message TaskStatus { string text = 1; bool busy = 2; Mode mode = 3; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each message that kept its name, but fewer than a third of its fields.

        At least half of the old field numbers must have a new meaning.
        """
        return each_once(context.changes, _replaced_messages)


def _replaced_messages(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair in messages(change):
        parts = compare_parts(type_state(pair.old, change.before), type_state(pair.new, change.after))
        if parts.is_another_message:
            fields = f"{parts.replaced} of {counted(parts.before, 'field')} replaced, {parts.left} kept"
            yield MessageContentReplaced.at(
                pair.new.at("name"),
                f"{pair.new.full_name!r} is now another message: {fields}",
                "give the new message another name, and restore the old message",
                change.earlier(pair.old.at("name"), "the old message is here"),
                type=pair.new.full_name,
            )


class FieldMeaningReplaced(LintRule, id="WIR114"):
    """A field number is given to a field with another meaning.

    The new type can read the old bytes, so there is no error: the old value is read as the new quantity. The lint
    judges the meaning by the names. A name keeps the meaning if it only has another spelling style, plural, usual short
    form or word order, or a qualifier more or less: `motor_speed` for `speed`. A rename to another word, to an opposite
    (`left` and `right`), to another number or to the name of another field is reported here. If the new name is only a
    better one, keep the old name as the field's `json_name`.

    Bad::

        message Motor { float left_speed = 1; }     // before
        message Motor { float left_current = 1; }   // after

    Good::

        message Motor { reserved 1; reserved "left_speed"; float left_current = 2; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field whose new name or type shows another meaning."""
        return _judged_fields(cls, context, Meaning.OTHER)


class FieldUnitChanged(LintRule, id="WIR115", severity=Severity.WARNING):
    """A field was renamed, and its new name says another unit, scale or reference.

    Number and type are the same, so there is no error. The receiver reads millimetres of an old sender as metres,
    hundredths of a degree as degrees, or a difference as a position.

    Bad::

        message Arm { int32 reach_mm = 1; }   // before
        message Arm { int32 reach_m = 1; }    // after

    Good::

        message Arm { reserved 1; reserved "reach_mm"; int32 reach_m = 2; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field whose old and new name contain the same quantity in different units."""
        yield from _judged_fields(cls, context, Meaning.UNIT)
        yield from reused_fields(cls, context, {Meaning.UNIT})


class MeaningDoubtful(LintRule, id="WIR116", severity=Severity.WARNING):
    """A field or enum value was renamed, and the names do not show if the number has kept its meaning.

    The names are similar, but not so similar that they certainly mean the same:

    - Two words often mean the same, but not always: `speed` and `velocity`.
    - Two words nearly have the same letters: `lattitude` and `latitude`. This may be a correction.
    - Only one of the names has a word that may change the quantity, such as `max`, `left`, `target`, `limit` or a
      number.
    - One word of a long name is another one, but not the last: `range_test_plugin_enabled` and
      `range_test_module_enabled`.
    - A name such as `value` does not say what is meant.
    - The field's type is another message or enum, which may be the old one with another name.

    If the meaning is the same, keep the old name as the field's `json_name`, or lower this rule for the message.

    Bad::

        message Motor { float speed = 1; }      // before
        message Motor { float velocity = 1; }   // after

    Good::

        message Motor { reserved 1; reserved "speed"; float velocity = 2; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field and enum value whose new name may or may not have the old meaning."""
        yield from _judged_fields(cls, context, Meaning.DOUBTFUL)
        yield from _judged_values(cls, context, Meaning.DOUBTFUL)
        yield from reused_fields(cls, context, {Meaning.DOUBTFUL})
        yield from reused_values(cls, context, {Meaning.DOUBTFUL})


def _judged_fields(rule: type[Rule], context: Context, meaning: Meaning) -> Iterator[Diagnostic]:
    """Yield a diagnostic of the rule for each field with the given judgement."""

    def compare(change: SchemaChange) -> Iterator[Diagnostic]:
        numbers = NewNumbers(context, change)
        for pair, judged in judged_fields(change):
            if judged.meaning is meaning and not is_accepted(context, pair.owner, pair.old, pair.new):
                place = type_place if pair.old.name == pair.new.name else name_place
                yield changed_field(rule, numbers, pair, f"{_change_text(pair)}: {judged.reason}", place)

    return each_once(context.changes, compare)


def _change_text(pair: FieldPair) -> str:
    old, new = (repr(field.name) for field in (pair.old, pair.new))
    if pair.old.name == pair.new.name:
        old, new = f"{old} ({pair.old.wire_type})", f"{new} ({pair.new.wire_type})"
    return f"field number {pair.new.number} was {old} and is now {new}"


def _judged_values(rule: type[Rule], context: Context, meaning: Meaning) -> Iterator[Diagnostic]:
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
