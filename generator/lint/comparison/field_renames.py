"""Renames of fields that kept their number.

Encoded bytes contain no names. But a new name often shows that the number now has a new meaning. Then a new receiver
misreads bytes from an old sender.
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
    """Kind of a rename: it says how much the meaning of the field changed."""

    NONE = "the same meaning"
    UNIT = "the same quantity in another unit, scale or reference"
    MEANING = "another meaning"
    RETYPED = "another meaning, with an incompatible type"


def rename(pair: FieldPair) -> Rename:
    """Return the kind of the rename between a field's old and new name; `Rename.NONE` if the name is the same."""
    if pair.old.name == pair.new.name or pair.in_map_entry:
        return Rename.NONE
    if broken_by_type(pair):
        return Rename.RETYPED
    if names_another_field(pair) or not share_a_word(_names(pair.old), _names(pair.new)):
        return Rename.MEANING
    measurable = pair.new.type not in _WITHOUT_UNIT and disagree(*measures(pair))
    return Rename.UNIT if measurable else Rename.NONE


def measures(pair: FieldPair) -> tuple[Measure, Measure]:
    """Return the quantity, unit, scale and reference in the old name of a field, and those in the new name.

    The name ``speed_mm_per_s`` has the quantity ``speed`` and the unit ``mm`` per ``s``.
    """
    return measure(words(pair.old.name)), measure(words(pair.new.name))


def names_another_field(pair: FieldPair) -> bool:
    """Return True if another field had the new name before the change, for example because two names were swapped."""
    fields = pair.messages.old.fields if pair.messages else ()
    return any(field.name == pair.new.name and field.number != pair.new.number for field in fields)


def _names(field: ProtoField) -> tuple[str, ...]:
    return (field.name, field.json_name) if field.json_name else (field.name,)
