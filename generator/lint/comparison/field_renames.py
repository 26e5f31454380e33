"""Renames of fields whose number stayed.

Names are not sent. But a new name often shows that the number now has a new meaning, and then bytes of an old sender
are misread.
"""

from __future__ import annotations

from enum import Enum

from roverlink.generator.lint.comparison.field_type_changes import broken_by_type
from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.lint.names.name_units import Measure, disagree, measure
from roverlink.generator.lint.names.name_words import share_a_word, words
from roverlink.generator.protos.schema import ProtoField

_WITHOUT_UNIT = frozenset({"string", "bytes", "bool", "enum"})


class Rename(Enum):
    """The kind of a rename."""

    NONE = "the same meaning"
    UNIT = "the same quantity in another unit, scale or reference"
    MEANING = "another meaning"
    RETYPED = "another meaning, with an incompatible type"


def rename(pair: FieldPair) -> Rename:
    """Return the kind of a field's rename."""
    if pair.old.name == pair.new.name or pair.in_map_entry:
        return Rename.NONE
    if broken_by_type(pair):
        return Rename.RETYPED
    if names_another_field(pair) or not share_a_word(_names(pair.old), _names(pair.new)):
        return Rename.MEANING
    measurable = pair.new.type not in _WITHOUT_UNIT and disagree(*measures(pair))
    return Rename.UNIT if measurable else Rename.NONE


def measures(pair: FieldPair) -> tuple[Measure, Measure]:
    """Return unit, scale and reference in the old and the new name."""
    return measure(words(pair.old.name)), measure(words(pair.new.name))


def names_another_field(pair: FieldPair) -> bool:
    """Return True if the new name belonged to another number before, as after a swap."""
    fields = pair.messages.old.fields if pair.messages else ()
    return any(field.name == pair.new.name and field.number != pair.new.number for field in fields)


def _names(field: ProtoField) -> tuple[str, ...]:
    return (field.name, field.json_name) if field.json_name else (field.name,)
